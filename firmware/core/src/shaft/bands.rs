//! Forbidden bands: speeds that the shaft crosses and never dwells at.
//!
//! Where the speed asked for lies inside a band, the nearer edge is kept instead. As long as that is
//! the edge on this side, it bounds the speed like a limit. Once it is the edge on the far side (or
//! the speed asked for lies beyond it), the shaft crosses; and once inside, it goes through to the
//! side to which it set out, whatever is asked meanwhile. Only a stop turns it round.

use super::ShaftLimits;

/// Speeds strictly between the two edges are forbidden; turns a tick in 2⁻⁴⁸ turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Band {
    pub(crate) from: i64,
    pub(crate) to: i64,
}

impl Band {
    /// Whether the far (upper) edge is the nearer one to `speed`, or `speed` is above the band.
    const fn sends_up(self, speed: i64) -> bool {
        speed - self.from >= self.to - speed
    }
}

/// The band that a speed lies in, and its number. Bands are in order and apart from each other.
#[inline(always)]
fn find(bands: &[Band], speed: i64) -> Option<(usize, &Band)> {
    for (number, band) in bands.iter().enumerate() {
        if speed < band.to {
            return (band.from < speed).then_some((number, band));
        }
    }
    None
}

/// `speed`, or the nearer edge of the band that it lies in, which is another speed.
#[inline(never)] // up to three times a tick, with all that it needs in registers
pub(super) fn outside(bands: &[Band], speed: i64) -> i64 {
    match find(bands, speed) {
        Some((_, band)) if band.sends_up(speed) => band.to,
        Some((_, band)) => band.from,
        None => speed,
    }
}

/// `speed`, or the lower edge of the band that it lies in.
pub(super) fn below_band(bands: &[Band], speed: i64) -> i64 {
    match find(bands, speed) {
        Some((_, band)) => band.from,
        None => speed,
    }
}

/// Which band the shaft is passing through, and which way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// The band, by its number.
    inside: Option<(usize, Way)>,
    last_speed: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
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

    /// The same, of a speed that lies in no band.
    pub const fn observe_outside(&mut self, speed: i64) {
        self.inside = None;
        self.last_speed = speed;
    }

    /// Takes note of the shaft's speed in the tick that was just played.
    pub fn observe(&mut self, bands: &[Band], speed: i64) {
        self.inside = match (find(bands, speed), self.inside) {
            (Some((number, _)), Some((before, way))) if before == number => Some((number, way)),
            (Some((number, band)), _) => {
                let way = if self.last_speed <= band.from {
                    Way::Up
                } else {
                    Way::Down
                };
                Some((number, way))
            }
            (None, _) => None,
        };
        self.last_speed = speed;
    }

    pub const fn is_inside(&self) -> bool {
        self.inside.is_some()
    }
}

/// The speeds between which the shaft may move now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corridor {
    pub floor: i64,
    pub ceiling: i64,
}

impl Corridor {
    /// Around the shaft's `speed`, when `asked` is asked of it.
    pub fn new(limits: &ShaftLimits, speed: i64, passage: Passage, asked: i64) -> Self {
        let mut corridor = Self {
            floor: 0,
            ceiling: limits.speed,
        };
        for (number, band) in limits.bands.iter().enumerate() {
            let through = passage.inside.filter(|&(inside, _)| inside == number);
            let up = match through {
                Some((_, way)) => way == Way::Up,
                None => band.sends_up(asked),
            };
            // A band is a floor to be kept, or come to, from above; else a ceiling.
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

    /// Of no speed at all.
    pub const NONE: Self = Self {
        floor: 1,
        ceiling: 0,
    };

    /// The speeds around `speed` that lie in no band, both edges included; none if it lies in one.
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
    pub const fn holds(&self, speed: i64) -> bool {
        self.floor <= speed && speed <= self.ceiling
    }

    /// The speed to aim at for a speed, which must lie outside the bands.
    #[inline(always)]
    pub fn clamp(&self, speed: i64) -> i64 {
        speed.min(self.ceiling).max(self.floor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{BandSettings, sample};

    /// The gap is a short way to what bands make of speeds; both must agree at every edge.
    #[test]
    fn in_a_gap_nothing_but_its_edges_bounds_a_speed() {
        let mut settings = sample::settings(2).limits;
        settings.bands = [(3.0, 4.0), (9.0, 12.0), (15.0, 16.0)]
            .map(|(from_hz, to_hz)| BandSettings { from_hz, to_hz })
            .into_iter()
            .collect();
        let limits = ShaftLimits::new(&settings, 2000);
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
            assert_eq!(gap.holds(speed), is_outside, "{speed}");
            for &asked in places.iter().filter(|&&asked| gap.holds(asked)) {
                let corridor = Corridor::new(&limits, speed, Passage::new(), asked);
                assert_eq!(corridor, gap, "{speed}, {asked}");
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
