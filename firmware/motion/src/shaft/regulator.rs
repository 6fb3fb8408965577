//! Time-optimal speed regulator in whole ticks: it chooses the next acceleration.
//!
//! Taking acceleration a for one tick and then releasing it gains the speed g(a) (see [`super::gain`]). To reach a speed
//! at the difference e as fast as possible, and without acceleration, the shaft takes the largest a with g(a) ≤ e that
//! the limits allow in each tick. Near the end a is less than a jerk, g(a) is a itself, and the speed is met exactly.
//! Nothing is rounded, and the speed does not hunt.
//!
//! A speed that moves at a constant rate is at rest in a frame that moves along. There the same law holds for the
//! acceleration relative to that rate. The same law keeps a floor and a ceiling: g(a) ≤ ceiling − speed held a tick
//! ago, so a release that starts now still meets the ceiling.
//!
//! The jerk leaves a range for the next acceleration. The search is limited to that range, and most often the result is
//! one of its ends.

use super::gain::Step;
use super::limits::RampLimits;

/// Steps of the gain at which the searches of the tick before ended, to begin the next ones there. For one set of limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Relative to the rate of the aim.
    pursuit: Step,
    /// Towards a bound.
    bound: Step,
}

impl Near {
    /// Steps of a shaft without acceleration, for all limits.
    pub const ZERO: Self = Self {
        pursuit: Step::ZERO,
        bound: Step::ZERO,
    };
}

/// Speed to reach. If it moves, its rate is the change over the coming tick.
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

/// Range of accelerations that the jerk allows.
#[derive(Clone, Copy)]
struct Range {
    min: i64,
    max: i64,
}

impl Range {
    fn clamp(self, acceleration: i64) -> i64 {
        acceleration.max(self.min).min(self.max)
    }

    /// Range relative to a frame that accelerates by `rate`.
    const fn relative_to(self, rate: i64) -> Self {
        Self {
            min: self.min - rate,
            max: self.max - rate,
        }
    }

    /// Range for the opposite direction.
    const fn mirrored(self) -> Self {
        Self {
            min: -self.max,
            max: -self.min,
        }
    }
}

/// Greatest acceleration, up to `limit`, that gains at most `change` (not negative); clamped to the range.
fn settling(change: i64, limit: i64, range: Range, limits: &RampLimits, near: &mut Step) -> i64 {
    let max = range.max.min(limit);
    if max <= 0 || max <= range.min {
        return range.clamp(max);
    }
    // With this much left to gain, the acceleration limit itself is the result.
    if limit == limits.acceleration && change.unsigned_abs() >= limits.gain_from_limit {
        return max;
    }
    let min = range.min.max(0);
    let gain = &limits.gain;
    gain.inverse(
        change.unsigned_abs(),
        min.unsigned_abs(),
        max.unsigned_abs(),
        near,
    ) as i64
}

/// Acceleration that gains at most `change`, of either sign.
fn towards(change: i64, limit: i64, range: Range, limits: &RampLimits, near: &mut Step) -> i64 {
    if change < 0 {
        -settling(-change, limit, range.mirrored(), limits, near)
    } else {
        settling(change, limit, range, limits, near)
    }
}

/// Acceleration, within the range, that meets an aim which moves at `rate` and is `change` ahead.
fn pursuing(change: i64, rate: i64, range: Range, limits: &RampLimits, near: &mut Step) -> i64 {
    if change == 0 {
        return range.clamp(rate);
    }
    // If the aim moves away, the limit is soon reached. If it approaches, the two close in faster than the shaft alone
    // could, and the relative acceleration to release is greater by that.
    let coming = (rate < 0) != (change < 0) && rate != 0;
    let limit = if coming {
        i64::MAX
    } else {
        limits.acceleration
    };
    rate + towards(change, limit, range.relative_to(rate), limits, near)
}

/// Limits `desired` so that it still meets a ceiling that is `change` above. Beyond the ceiling it is the fastest return.
fn bounded(desired: i64, change: i64, range: Range, limits: &RampLimits, near: &mut Step) -> i64 {
    if change >= 0 && desired <= 0 {
        return desired;
    }
    let max = if change < 0 { range.max } else { desired };
    let range = Range { max, ..range };
    towards(change, limits.acceleration, range, limits, near).min(desired)
}

/// Acceleration of the coming tick.
///
/// It is always within the limits of acceleration and jerk. The speed stays between `floor` and `ceiling` as long as
/// these do not move towards it faster than the limits allow.
pub(super) fn acceleration(
    limits: &RampLimits,
    speed: i64,
    acceleration: i64,
    aim: Aim,
    floor: i64,
    ceiling: i64,
    near: &mut Near,
) -> i64 {
    let range = Range {
        min: acceleration - limits.jerk,
        max: acceleration + limits.jerk,
    };
    let desired = pursuing(
        aim.now - speed,
        aim.next - aim.now,
        range,
        limits,
        &mut near.pursuit,
    );
    // Outside floor and ceiling these are the fastest return.
    let below = bounded(desired, ceiling - speed, range, limits, &mut near.bound);
    -bounded(
        -below,
        speed - floor,
        range.mirrored(),
        limits,
        &mut near.bound,
    )
}

/// Acceleration of the coming tick in the fastest stop, regardless of other bounds.
pub(super) fn brake(limits: &RampLimits, speed: i64, acceleration: i64, near: &mut Step) -> i64 {
    let range = Range {
        min: acceleration - limits.jerk,
        max: acceleration + limits.jerk,
    };
    -settling(speed, limits.acceleration, range.mirrored(), limits, near)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An aim that falls at 0.3 A a tick approaches a shaft at rest. Relative to the aim the shaft may accelerate at up
    /// to 1.3 A. Ramps from 0.3 A to 1.3 A and from there to 0, with h ticks between, close a gap of
    /// (0.3 + 1.3)/2 · A²/J + 1.3 A h + 1.3²/2 · A²/J.
    #[test]
    fn an_approaching_aim_is_reached_in_the_least_time() {
        let settings = crate::settings::LimitSettings {
            speed_hz: 100.0,
            acceleration_hz_per_s: 50.0,
            jerk_hz_per_s2: 500.0,
            stop_acceleration_hz_per_s: 50.0,
            stop_jerk_hz_per_s2: 500.0,
            homing_speed_hz: 1.0,
            bands: heapless::Vec::new(),
        };
        let limits = crate::shaft::ShaftLimits::from_settings(&settings, 2000);
        let (top, limits) = (limits.speed, limits.usual);
        let fall = limits.acceleration * 3 / 10;
        let start = top / 2;
        let (mut speed, mut a, mut ticks) = (0, 0, 0_i64);
        let mut near = Near::ZERO;
        loop {
            let aim = Aim {
                now: start - fall * ticks,
                next: start - fall * (ticks + 1),
            };
            a = acceleration(&limits, speed, a, aim, 0, top, &mut near);
            speed += a;
            ticks += 1;
            if speed == aim.next && a == -fall {
                break;
            }
        }
        let (max, jerk) = (limits.acceleration as f64, limits.jerk as f64);
        let ramps = (0.8 + 1.69 / 2.0) * max * max / jerk;
        let between = (start as f64 - ramps) / (1.3 * max);
        let min = 2.3 * max / jerk + between;
        assert!(between > 0.0);
        assert!(
            ticks as f64 <= min + 3.0,
            "{ticks} ticks, where {min} would do"
        );
    }
}
