//! The earliest possible stop at a phase, in closed form, as a reference for the shaft's.
//!
//! The reference moves in continuous time (see [`super::shortest`]). For a time k it goes towards the coasting speed, and
//! coasts once it is met; then it brakes in the least time. Most often the coasting speed is the one after releasing the
//! acceleration. The distance of that stop grows with k. So one k belongs to each passage through the phase, from the
//! first that the fastest brake, k = 0, does not exceed.
//!
//! No stop that does not speed up is earlier there: until it brakes its speed is the greatest possible, and then it falls
//! as fast as possible. There are two other coasting speeds. One is the homing speed, if the remaining speed would be
//! below it. The other is the lower edge of a band in which the shaft would coast, to which it goes as fast as possible.
//!
//! The distance that whole ticks cover is v − a/6 less than that of as many units of continuous time. In the last two of
//! them the shaft is already at rest, so it moves for at least two ticks less than the reference.

use super::*;

/// Speed, acceleration, distance and time at one point of a motion.
#[derive(Clone, Copy)]
struct Point {
    speed: f64,
    acceleration: f64,
    distance: f64,
    ticks: f64,
}

impl Point {
    fn after(self, ticks: f64, jerk: f64) -> Self {
        let Self {
            speed: v,
            acceleration: a,
            ..
        } = self;
        Self {
            speed: v + ticks * (a + ticks * jerk / 2.0),
            acceleration: a + ticks * jerk,
            distance: self.distance + ticks * (v + ticks * (a / 2.0 + ticks * jerk / 6.0)),
            ticks: self.ticks + ticks,
        }
    }
}

/// Earliest standstill.
pub(super) struct Stand {
    pub ticks: f64,
    /// Ticks without acceleration.
    pub coasted: f64,
}

/// Speed at which a stop coasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Coasting {
    /// The speed after releasing the acceleration.
    LetGo,
    /// The homing speed, as the remaining speed is below it.
    Slow,
    /// The lower edge of a band, as the remaining speed lies inside.
    BelowBand,
}

pub(super) struct Earliest {
    from: Point,
    jerk: f64,
    max: f64,
    /// The coasting speed.
    pub coasting: f64,
    pub kind: Coasting,
    /// Times and jerks of the ramp to the coasting speed.
    easing: [(f64, f64); 3],
}

impl Earliest {
    /// Earliest stop of a shaft. There is none where a jerk decides the coasting speed, as whole ticks may end on the
    /// other side of that decision.
    pub fn of(watch: &Watch) -> Option<Self> {
        let limits = watch.shaft.limits();
        let free = Self::letting_go(watch);
        let (left, jerk) = (free.coasting, limits.usual.jerk as f64);
        let homing_speed = limits.homing_speed as f64;
        let edges = || {
            limits
                .bands
                .iter()
                .map(|band| (band.from as f64, band.to as f64))
        };
        let mut steps = edges()
            .flat_map(|(from, to)| [from, to])
            .chain([homing_speed]);
        if watch.acceleration != 0 && steps.any(|step| (left - step).abs() <= jerk) {
            return None;
        }
        let band = edges().find(|&(from, to)| from < left && left < to);
        Some(match band {
            _ if left < homing_speed => free.coasting_at(homing_speed, Coasting::Slow),
            Some((from, _)) => free.coasting_at(from, Coasting::BelowBand),
            None => free,
        })
    }

    /// Earliest stop of a shaft that coasts at the speed after releasing its acceleration.
    pub fn letting_go(watch: &Watch) -> Self {
        let ramp = &watch.shaft.limits().usual;
        let (v, a) = (watch.speed as f64, watch.acceleration as f64);
        let (jerk, max) = (ramp.jerk as f64, ramp.acceleration as f64);
        let new = Self {
            from: Point {
                speed: v - a / 2.0,
                acceleration: a,
                distance: a / 6.0 - v,
                ticks: 0.0,
            },
            jerk,
            max,
            coasting: 0.0,
            kind: Coasting::LetGo,
            easing: [(0.0, 0.0); 3],
        };
        let left = v - a / 2.0 + a * a.abs() / (2.0 * jerk);
        new.coasting_at(left, Coasting::LetGo)
    }

    fn coasting_at(self, coasting: f64, kind: Coasting) -> Self {
        let Point {
            speed: v,
            acceleration: a,
            ..
        } = self.from;
        let jerk = self.jerk;
        let let_go = v + a * a.abs() / (2.0 * jerk);
        let sense = if coasting < let_go { -1.0 } else { 1.0 };
        Self {
            coasting,
            kind,
            easing: self.ramp(sense * (coasting - v), sense * a, sense * jerk),
            ..self
        }
    }

    /// Fastest ramp that gains `speed` from an acceleration and ends without it, as times and jerks.
    fn ramp(&self, speed: f64, a: f64, jerk: f64) -> [(f64, f64); 3] {
        // From a up to a peak and down to zero gains (2 peak² − a²)/2J.
        let peak = (self.jerk * speed + a * a / 2.0).max(0.0).sqrt();
        let peak = peak.min(self.max).max(a);
        let held = speed - (peak * peak - a * a / 2.0) / self.jerk;
        [
            ((peak - a) / self.jerk, jerk),
            ((held / peak.max(1e-9)).max(0.0), 0.0),
            (peak / self.jerk, -jerk),
        ]
    }

    fn eased(&self, ticks: f64) -> Point {
        let mut left = ticks;
        let mut point = self.from;
        for (ticks, jerk) in self.easing {
            point = point.after(ticks.min(left), jerk);
            left -= ticks.min(left);
        }
        point.after(left, 0.0)
    }

    fn braked(&self, from: Point) -> Point {
        let ramp = self.ramp(from.speed, -from.acceleration, -self.jerk);
        ramp.iter()
            .fold(from, |point, &(ticks, jerk)| point.after(ticks, jerk))
    }

    /// Ticks until the stop coasts.
    pub fn easing_ticks(&self) -> f64 {
        self.easing.iter().map(|&(ticks, _)| ticks).sum()
    }

    /// Ticks of the fastest brake.
    pub fn min_ticks(&self) -> f64 {
        self.braked(self.from).ticks
    }

    /// Earliest standstill at the distance `distance`; none where no stop reaches it or ends there.
    pub fn stand(&self, distance: f64) -> Option<Stand> {
        let stop = |ticks: f64| self.braked(self.eased(ticks));
        if distance < stop(0.0).distance {
            return None;
        }
        let easing = self.easing_ticks();
        let coasted = (distance - stop(easing).distance) / self.coasting;
        if coasted >= 0.0 {
            return (self.coasting > 0.0).then(|| Stand {
                ticks: stop(easing).ticks + coasted,
                coasted,
            });
        }
        let (mut min, mut max) = (0.0, easing);
        for _ in 0..100 {
            let middle = f64::midpoint(min, max);
            if stop(middle).distance < distance {
                min = middle;
            } else {
                max = middle;
            }
        }
        Some(Stand {
            ticks: stop(max).ticks,
            coasted: 0.0,
        })
    }
}
