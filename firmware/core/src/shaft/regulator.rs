//! The time-optimal way to a speed, in whole ticks: which acceleration to take next.
//!
//! Let the acceleration be a now, and let it go towards zero by the jerk J a tick. While it goes,
//! the speed still gains
//!
//! D(a) = (a − J) + (a − 2J) + …  (as long as the terms are positive).
//!
//! Taking acceleration a for one tick and then letting it go gains g(a) = a + D(a) in all. With
//! n = ⌊a/J⌋ that is (n + 1) a − J n (n + 1)/2: it grows with a, and its inverse needs one integer
//! root. The fastest way to a speed that is e away, arriving without acceleration, is therefore to
//! take, in each tick, the largest a with g(a) ≤ e that the limits allow. Near the end n is 0, a is
//! e itself, and the speed is met exactly: nothing is rounded, and nothing hunts.
//!
//! A speed that moves at a constant rate is a speed at rest in a frame that moves along: the same
//! law for the acceleration relative to that rate. A floor and a ceiling are kept by the same law,
//! too: as g(a) ≤ ceiling − speed held a tick ago, letting go now still meets it.

use super::ShaftLimits;

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

/// What the speed gains in the ticks after this one while `acceleration` is let go: D(a).
pub(super) const fn gained_letting_go(acceleration: u64, jerk: i64) -> u64 {
    gained_settling(acceleration, jerk) - acceleration
}

/// What the speed gains by `acceleration` in this tick and by letting it go: g(a).
pub(super) const fn gained_settling(acceleration: u64, jerk: i64) -> u64 {
    let jerk = jerk as u64;
    let n = acceleration / jerk;
    (n + 1) * acceleration - jerk * (n * (n + 1) / 2)
}

/// The largest a with g(a) ≤ `gain`.
const fn settling(gain: u64, jerk: i64) -> u64 {
    let jerk = jerk as u64;
    // J n (n + 1)/2 ≤ gain  ⇔  n (n + 1)/2 ≤ ⌊gain / J⌋, all being whole numbers.
    let n = ((8 * (gain / jerk) + 1).isqrt() - 1) / 2;
    (gain + jerk * (n * (n + 1) / 2)) / (n + 1)
}

/// The same with the sign of `way`, and no further than the limit: all that can be taken of it.
fn towards(way: i64, limits: &ShaftLimits) -> i64 {
    let gain = way.unsigned_abs();
    let a = if gain >= limits.gain_from_limit {
        limits.acceleration
    } else {
        (settling(gain, limits.jerk) as i64).min(limits.acceleration)
    };
    a * way.signum()
}

/// What to take to meet an aim that moves at `rate` and is `way` ahead.
fn pursuing(way: i64, rate: i64, limits: &ShaftLimits) -> i64 {
    if way == 0 {
        return rate;
    }
    // Where the aim runs away, the limit is soon reached. Where it comes to meet the shaft, the two
    // close in on each other faster than the shaft alone could, and have that much more to let go.
    let coming = rate.signum() == -way.signum();
    let relative = if coming {
        settling(way.unsigned_abs(), limits.jerk) as i64 * way.signum()
    } else {
        towards(way, limits)
    };
    rate + relative
}

/// The acceleration of the coming tick.
///
/// Within the limits of acceleration and jerk always; between `floor` and `ceiling` for as long as
/// they do not move towards the speed faster than the limits allow.
pub(super) fn acceleration(
    limits: &ShaftLimits,
    speed: i64,
    acceleration: i64,
    aim: Aim,
    floor: i64,
    ceiling: i64,
) -> i64 {
    let rate = aim.next - aim.now;
    let wanted = pursuing(aim.now - speed, rate, limits);
    // Outside the two, these are the fastest way back between them.
    let most = towards(ceiling - speed, limits);
    let least = towards(floor - speed, limits);
    // The jerk's range comes last: it holds whatever happened to floor and ceiling.
    wanted
        .min(most)
        .max(least)
        .clamp(acceleration - limits.jerk, acceleration + limits.jerk)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The inverse is exact: the next larger acceleration would overshoot.
        #[test]
        fn settling_is_the_largest_that_does_not_overshoot(gain in 0_u64..1 << 47, jerk in 1_i64..1 << 40) {
            // Keep n where the limits keep it: below 2^21 ticks of letting go.
            let gain = gain.min((jerk as u64).saturating_mul(1 << 40));
            let a = settling(gain, jerk);
            prop_assert!(gained_settling(a, jerk) <= gain);
            prop_assert!(gained_settling(a + 1, jerk) > gain);
        }

        /// The closed form of D against its sum.
        #[test]
        fn letting_go_gains_the_sum(acceleration in 0_u64..100_000, jerk in 1_i64..5_000) {
            let mut sum = 0;
            let mut a = acceleration;
            while a > jerk as u64 {
                a -= jerk as u64;
                sum += a;
            }
            prop_assert_eq!(gained_letting_go(acceleration, jerk), sum);
        }
    }

    /// An aim that falls at 0.3 A a tick comes to meet a shaft at rest: relative to it the shaft may go up
    /// to 1.3 A. Ramps from 0.3 A to 1.3 A and from there to 0, with h ticks between, close a gap of
    /// (0.3 + 1.3)/2 · A²/J + 1.3 A h + 1.3²/2 · A²/J.
    #[test]
    fn an_aim_that_comes_to_meet_the_shaft_is_met_in_the_least_time() {
        let settings = crate::settings::LimitSettings {
            speed_hz: 100.0,
            acceleration_hz_per_s: 50.0,
            jerk_hz_per_s2: 500.0,
            creep_hz: 1.0,
            bands: heapless::Vec::new(),
        };
        let limits = ShaftLimits::new(&settings, 2000);
        let fall = limits.acceleration * 3 / 10;
        let start = limits.speed / 2;
        let (mut speed, mut a, mut ticks) = (0, 0, 0_i64);
        loop {
            let aim = Aim {
                now: start - fall * ticks,
                next: start - fall * (ticks + 1),
            };
            a = acceleration(&limits, speed, a, aim, 0, limits.speed);
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
