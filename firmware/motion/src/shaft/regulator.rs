//! The time-optimal way to a speed, in whole ticks: which acceleration to take next.
//!
//! Taking acceleration a for one tick and then letting it go gains the speed g(a) (see [`super::gain`]). The fastest
//! way to a speed that is e away, arriving without acceleration, is therefore to
//! take, in each tick, the largest a with g(a) ≤ e that the limits allow. Near the end a is less than a jerk, g(a) is
//! a itself, and the speed is met exactly: nothing is rounded, and nothing hunts.
//!
//! A speed that moves at a constant rate is a speed at rest in a frame that moves along: the same
//! law for the acceleration relative to that rate. A floor and a ceiling are kept by the same law,
//! too: as g(a) ≤ ceiling − speed held a tick ago, letting go now still meets it.
//!
//! Whatever is wanted, the jerk leaves a range for the next acceleration. All is looked for within that range only,
//! and most often its end is the answer.

use super::limits::RampLimits;

/// A speed to reach; where it moves, the step that it makes over the coming tick is its rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub now: i64,
    pub next: i64,
}

impl Aim {
    pub const fn steady(speed: i64) -> Self {
        Self {
            now: speed,
            next: speed,
        }
    }
}

/// The accelerations that the jerk allows.
#[derive(Clone, Copy)]
struct Range {
    least: i64,
    most: i64,
}

impl Range {
    fn clamp(self, acceleration: i64) -> i64 {
        acceleration.max(self.least).min(self.most)
    }

    /// The same, as seen from a frame that accelerates by `rate`.
    const fn relative_to(self, rate: i64) -> Self {
        Self {
            least: self.least - rate,
            most: self.most - rate,
        }
    }

    /// The same for the other sense.
    const fn mirrored(self) -> Self {
        Self {
            least: -self.most,
            most: -self.least,
        }
    }
}

/// What gains `way` (not negative) and no more, up to `limit`; clamped to the range.
fn settling(way: i64, limit: i64, range: Range, limits: &RampLimits) -> i64 {
    let most = range.most.min(limit);
    if most <= 0 || most <= range.least {
        return range.clamp(most);
    }
    // No more than the limit of acceleration is ever wanted of a way that is enough for that.
    if limit == limits.acceleration && way.unsigned_abs() >= limits.gain_from_limit {
        return most;
    }
    let least = range.least.max(0);
    let gain = &limits.gain;
    gain.inverse(
        way.unsigned_abs(),
        least.unsigned_abs(),
        most.unsigned_abs(),
    ) as i64
}

/// The same for a way of either sign.
fn towards(way: i64, limit: i64, range: Range, limits: &RampLimits) -> i64 {
    if way < 0 {
        -settling(-way, limit, range.mirrored(), limits)
    } else {
        settling(way, limit, range, limits)
    }
}

/// What to take, within the range, to meet an aim that moves at `rate` and is `way` ahead.
fn pursuing(way: i64, rate: i64, range: Range, limits: &RampLimits) -> i64 {
    if way == 0 {
        return range.clamp(rate);
    }
    // Where the aim runs away, the limit is soon reached. Where it comes to meet the shaft, the two
    // close in on each other faster than the shaft alone could, and have that much more to let go.
    let coming = (rate < 0) != (way < 0) && rate != 0;
    let limit = if coming {
        i64::MAX
    } else {
        limits.acceleration
    };
    rate + towards(way, limit, range.relative_to(rate), limits)
}

/// `wanted`, or what of it still meets a ceiling that is `way` above; below the ceiling's, the fastest way back to it.
fn bounded(wanted: i64, way: i64, range: Range, limits: &RampLimits) -> i64 {
    if way >= 0 && wanted <= 0 {
        return wanted;
    }
    let most = if way < 0 { range.most } else { wanted };
    let range = Range { most, ..range };
    towards(way, limits.acceleration, range, limits).min(wanted)
}

/// The acceleration of the coming tick.
///
/// Within the limits of acceleration and jerk always; between `floor` and `ceiling` for as long as
/// they do not move towards the speed faster than the limits allow.
pub(super) fn acceleration(
    limits: &RampLimits,
    speed: i64,
    acceleration: i64,
    aim: Aim,
    floor: i64,
    ceiling: i64,
) -> i64 {
    let range = Range {
        least: acceleration - limits.jerk,
        most: acceleration + limits.jerk,
    };
    let wanted = pursuing(aim.now - speed, aim.next - aim.now, range, limits);
    // Outside the two, these are the fastest way back between them.
    let below = bounded(wanted, ceiling - speed, range, limits);
    -bounded(-below, speed - floor, range.mirrored(), limits)
}

/// The acceleration of the coming tick on the fastest way to a stand, whatever else there is to keep to.
pub(super) fn brake(limits: &RampLimits, speed: i64, acceleration: i64) -> i64 {
    let range = Range {
        least: acceleration - limits.jerk,
        most: acceleration + limits.jerk,
    };
    -settling(speed, limits.acceleration, range.mirrored(), limits)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An aim that falls at 0.3 A a tick comes to meet a shaft at rest: relative to it the shaft may go up
    /// to 1.3 A. Ramps from 0.3 A to 1.3 A and from there to 0, with h ticks between, close a gap of
    /// (0.3 + 1.3)/2 · A²/J + 1.3 A h + 1.3²/2 · A²/J.
    #[test]
    fn an_aim_that_comes_to_meet_the_shaft_is_met_in_the_least_time() {
        let settings = crate::settings::LimitSettings {
            speed_hz: 100.0,
            acceleration_hz_per_s: 50.0,
            jerk_hz_per_s2: 500.0,
            stop_acceleration_hz_per_s: 50.0,
            stop_jerk_hz_per_s2: 500.0,
            creep_hz: 1.0,
            bands: heapless::Vec::new(),
        };
        let limits = crate::shaft::ShaftLimits::of(&settings, 2000);
        let (top, limits) = (limits.speed, limits.usual);
        let fall = limits.acceleration * 3 / 10;
        let start = top / 2;
        let (mut speed, mut a, mut ticks) = (0, 0, 0_i64);
        loop {
            let aim = Aim {
                now: start - fall * ticks,
                next: start - fall * (ticks + 1),
            };
            a = acceleration(&limits, speed, a, aim, 0, top);
            speed += a;
            ticks += 1;
            if speed == aim.next && a == -fall {
                break;
            }
        }
        let (most, jerk) = (limits.acceleration as f64, limits.jerk as f64);
        let ramps = (0.8 + 1.69 / 2.0) * most * most / jerk;
        let between = (start as f64 - ramps) / (1.3 * most);
        let least = 2.3 * most / jerk + between;
        assert!(between > 0.0);
        assert!(
            ticks as f64 <= least + 3.0,
            "{ticks} ticks, where {least} would do"
        );
    }
}
