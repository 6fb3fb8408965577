//! Forbidden bands: speeds that the shaft crosses without dwelling.
//!
//! Where the requested speed lies inside a band, the nearer edge replaces it. As long as that is the near edge, it
//! bounds the speed like a limit. Once it is the far edge (or the requested speed lies beyond it), the shaft crosses.
//! Once inside, the shaft continues to the far side, whatever speed is requested meanwhile. Only a stop turns it back.

use super::ShaftLimits;

/// Forbidden band: speeds strictly between its two edges, in units of 2⁻⁴⁸ turn a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Band {
    pub(crate) from: i64,
    pub(crate) to: i64,
}

impl Band {
    /// True if the upper edge is the nearer one to `speed`, or if `speed` is above the band.
    const fn sends_up(self, speed: i64) -> bool {
        speed - self.from >= self.to - speed
    }
}

/// Finds the band that contains a speed, and its number. Bands are sorted and do not touch.
#[inline(always)]
fn find(bands: &[Band], speed: i64) -> Option<(usize, &Band)> {
    for (number, band) in bands.iter().enumerate() {
        if speed < band.to {
            return (band.from < speed).then_some((number, band));
        }
    }
    None
}

/// Returns `speed` outside all bands, and otherwise the nearer edge of its band.
#[inline(never)] // It runs up to three times a tick, with all its inputs in registers.
pub(super) fn outside(bands: &[Band], speed: i64) -> i64 {
    match find(bands, speed) {
        Some((_, band)) if band.sends_up(speed) => band.to,
        Some((_, band)) => band.from,
        None => speed,
    }
}

/// Returns `speed` outside all bands, and otherwise the lower edge of its band.
pub(super) fn below_band(bands: &[Band], speed: i64) -> i64 {
    match find(bands, speed) {
        Some((_, band)) => band.from,
        None => speed,
    }
}

/// Band that the shaft is crossing, and the direction of the crossing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// Number of the band, and the direction.
    inside: Option<(usize, Direction)>,
    last_speed: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Up,
    Down,
}

impl Passage {
    pub const fn new() -> Self {
        Self {
            inside: None,
            last_speed: 0,
        }
    }

    /// Updates from a speed outside all bands.
    pub const fn observe_outside(&mut self, speed: i64) {
        self.inside = None;
        self.last_speed = speed;
    }

    /// Updates from the shaft's speed in the last tick.
    pub fn observe(&mut self, bands: &[Band], speed: i64) {
        self.inside = match (find(bands, speed), self.inside) {
            (Some((number, _)), Some((before, direction))) if before == number => {
                Some((number, direction))
            }
            (Some((number, band)), _) => {
                let direction = if self.last_speed <= band.from {
                    Direction::Up
                } else {
                    Direction::Down
                };
                Some((number, direction))
            }
            (None, _) => None,
        };
        self.last_speed = speed;
    }

    pub const fn is_inside(&self) -> bool {
        self.inside.is_some()
    }
}

/// Lowest and highest speed that the shaft may have now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corridor {
    pub floor: i64,
    pub ceiling: i64,
}

impl Corridor {
    /// Corridor around the shaft's `speed`, for a requested speed.
    pub fn new(limits: &ShaftLimits, speed: i64, passage: Passage, requested: i64) -> Self {
        let mut corridor = Self {
            floor: 0,
            ceiling: limits.speed,
        };
        for (number, band) in limits.bands.iter().enumerate() {
            let through = passage.inside.filter(|&(inside, _)| inside == number);
            let up = match through {
                Some((_, direction)) => direction == Direction::Up,
                None => band.sends_up(requested),
            };
            // For a shaft above it, or on its way up through it, a band is a floor; otherwise it is a ceiling.
            if up {
                if speed >= band.to || through.is_some() {
                    corridor.floor = corridor.floor.max(band.to);
                }
            } else if speed <= band.from || through.is_some() {
                corridor.ceiling = corridor.ceiling.min(band.from);
            }
        }
        corridor
    }

    /// Contains no speed.
    pub const NONE: Self = Self {
        floor: 1,
        ceiling: 0,
    };

    /// Returns the speeds around `speed` that lie outside all bands, both edges included, or none if it lies in a band.
    pub fn gap(limits: &ShaftLimits, speed: i64) -> Self {
        let mut gap = Self {
            floor: 0,
            ceiling: limits.speed,
        };
        for band in &limits.bands {
            if speed >= band.to {
                gap.floor = band.to;
            } else if speed > band.from {
                return Self::NONE;
            } else {
                gap.ceiling = gap.ceiling.min(band.from);
            }
        }
        gap
    }

    #[inline(always)]
    pub const fn contains(&self, speed: i64) -> bool {
        self.floor <= speed && speed <= self.ceiling
    }

    /// Limits a speed to the corridor; it must lie outside the bands.
    #[inline(always)]
    pub fn clamp(&self, speed: i64) -> i64 {
        speed.min(self.ceiling).max(self.floor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{BandSettings, LimitSettings};

    /// The gap is a shortcut for the bands' effect on speeds. Both must agree at every edge.
    #[test]
    fn within_a_gap_only_its_edges_bound_the_speed() {
        let settings = LimitSettings {
            speed_hz: 20.0,
            acceleration_hz_per_s: 20.0,
            jerk_hz_per_s2: 200.0,
            stop_acceleration_hz_per_s: 20.0,
            stop_jerk_hz_per_s2: 200.0,
            homing_speed_hz: 1.0,
            bands: [(3.0, 4.0), (9.0, 12.0), (15.0, 16.0)]
                .map(|(from_hz, to_hz)| BandSettings { from_hz, to_hz })
                .into_iter()
                .collect(),
        };
        let limits = ShaftLimits::from_settings(&settings, 2000);
        let edges = limits.bands.iter().flat_map(|band| [band.from, band.to]);
        let places: std::vec::Vec<i64> = edges
            .chain([0, limits.speed])
            .flat_map(|edge| [edge - 1000, edge - 1, edge, edge + 1, edge + 1000])
            .filter(|speed| (0..=limits.speed).contains(speed))
            .collect();
        let mut held = 0;
        for &speed in &places {
            let gap = Corridor::gap(&limits, speed);
            let is_outside = outside(&limits.bands, speed) == speed;
            assert_eq!(gap.contains(speed), is_outside, "{speed}");
            for &requested in places.iter().filter(|&&requested| gap.contains(requested)) {
                let corridor = Corridor::new(&limits, speed, Passage::new(), requested);
                assert_eq!(corridor, gap, "{speed}, {requested}");
                held += 1;
                for &other in &places {
                    let by_bands = gap.clamp(outside(&limits.bands, other));
                    assert_eq!(gap.clamp(other), by_bands, "{other} from {speed}");
                }
            }
        }
        assert!(held > 100);
    }
}
