//! Speed gained while an acceleration is released, and the acceleration that gains a given speed.
//!
//! An acceleration a is *released* when it goes to zero by the jerk J a tick. Meanwhile the speed still gains
//!
//! D(a) = (a − J) + (a − 2J) + …  (as long as the terms are positive).
//!
//! Taking acceleration a for one tick and then releasing it gains g(a) = a + D(a) in total. With n = ⌊a/J⌋ and b = n J
//! that is b (n + 1)/2 + (n + 1) (a − b), which is linear between multiples of J and increases. The inverse needs a root
//! to find n. But the acceleration of a tick differs by at most a jerk from the one before. So n is known within one or
//! two and is searched from that of the tick before.

use core::hash::{Hash, Hasher};

use super::brake::Inverse;
use crate::functions::{multiply_high, multiply_long, quotient};

/// The function g and its inverse, for one jerk limit.
#[derive(Clone, Debug)]
pub(super) struct Gain {
    jerk: u64,
    /// Greatest acceleration that the gain and its inverse take.
    max: u64,
    /// Reciprocal of the jerk. ⌊a/J⌋ is about `(a >> scale) · inverse / 2^(32 + down)`.
    pub per_jerk: Inverse,
    scale: u32,
    down: u32,
}

/// Multiple of the jerk at or below an acceleration.
#[derive(Clone, Copy, Debug, Hash)]
pub(super) struct Step {
    /// n, below 2²³: settings bound the length of a ramp.
    pub number: u32,
    /// b = n J.
    pub base: u64,
    /// g(b) = b (n + 1)/2.
    gain: u64,
}

impl Step {
    /// No acceleration, for every jerk.
    pub const ZERO: Self = Self {
        number: 0,
        base: 0,
        gain: 0,
    };

    /// Moves on to the multiple below.
    const fn lower(&mut self, jerk: u64) {
        self.gain -= self.base;
        self.base -= jerk;
        self.number -= 1;
    }
}

impl Gain {
    /// Hashes one half.
    #[inline(always)]
    pub fn hash_half(&self, second: bool, hasher: &mut impl Hasher) {
        let Self {
            jerk,
            max,
            per_jerk,
            scale,
            down,
        } = self;
        if second {
            (per_jerk, scale, down).hash(hasher);
        } else {
            (jerk, max).hash(hasher);
        }
    }

    /// Gain for `jerk`, for accelerations up to `max` and gains up to `speed`.
    ///
    /// The jerk must be at least 59: 64 minus the units that planning subtracts, and a rounding. The release must take
    /// at most 2²³ ticks for each of them.
    pub const fn new(jerk: u64, max: u64, speed: u64) -> Self {
        let fastest = settling(speed, jerk);
        let max = if max > fastest { max } else { fastest };
        let per_jerk = Inverse::new(jerk as i64);
        let scale = 32_u32.saturating_sub((max | jerk).leading_zeros());
        Self {
            jerk,
            max,
            scale,
            down: (63 - per_jerk.up).saturating_sub(scale),
            per_jerk,
        }
    }

    /// Gain g(`acceleration`).
    pub const fn of(&self, acceleration: u64) -> u64 {
        self.above(&self.step(acceleration), acceleration)
    }

    /// Gain g(a) of an acceleration from a step up to, and including, the next.
    pub const fn above(&self, step: &Step, acceleration: u64) -> u64 {
        step.gain + multiply_long(acceleration - step.base, step.number + 1)
    }

    /// Multiple of the jerk at or below `acceleration`.
    pub const fn step(&self, acceleration: u64) -> Step {
        // The scaled acceleration and the inverse are exact to 2^-26, so that the quotient is at most one too small.
        let scaled = (acceleration >> self.scale) as u32;
        let mut number = multiply_high(scaled, self.per_jerk.inverse) >> self.down;
        let mut base = multiply_long(self.jerk, number);
        if base > acceleration {
            number -= 1;
            base -= self.jerk;
        } else if acceleration - base >= self.jerk {
            number += 1;
            base += self.jerk;
        }
        Step {
            number,
            base,
            gain: multiply_long(base, number + 1) / 2,
        }
    }

    /// Largest acceleration a from `min` to `max` with g(a) ≤ `gain`, or `min` if there is none.
    ///
    /// The search begins at `near`, a step of this gain, and leaves it at the step where it ended. It costs a step for each
    /// jerk between the two. If `near` is not within some jerks of `max`, the search begins there.
    #[inline(never)]
    pub fn inverse(&self, gain: u64, min: u64, max: u64, near: &mut Step) -> u64 {
        let max = max.min(self.max);
        if max <= min {
            return min;
        }
        let jerk = self.jerk;
        let mut step = *near;
        if (max.wrapping_sub(step.base) as i64).unsigned_abs() >> 2 > jerk {
            step = self.step(max);
        }
        while step.gain > gain || step.base > max {
            if step.base <= min {
                *near = step;
                return min;
            }
            step.lower(jerk);
        }
        let mut next = step.base + jerk;
        while next <= max && step.gain + next <= gain {
            step = Step {
                number: step.number + 1,
                base: next,
                gain: step.gain + next,
            };
            next += jerk;
        }
        *near = step;
        if next > max && self.above(&step, max) <= gain {
            return max;
        }
        (step.base + quotient(gain - step.gain, step.number + 1)).max(min)
    }
}

/// Largest a with g(a) ≤ `gain`, without bounds, by a root.
const fn settling(gain: u64, jerk: u64) -> u64 {
    // J n (n + 1)/2 ≤ gain  ⇔  n (n + 1)/2 ≤ ⌊gain / J⌋, as all are integers.
    let n = ((8 * (gain / jerk) + 1).isqrt() - 1) / 2;
    (gain + jerk * (n * (n + 1) / 2)) / (n + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Limits within the range of settings: the release takes up to 2²² ticks.
    fn any_gain() -> impl Strategy<Value = (Gain, u64)> {
        let limits = (5_u32..40, 0_u32..22, any::<(u64, u64)>());
        limits.prop_map(|(jerk_bits, ticks_bits, (a, b))| {
            let jerk = (1 << jerk_bits) + a % (1 << jerk_bits);
            // The speed V is at most 2^47, with 8 V/J < ticks².
            let speed = u128::from(jerk) << (2 * ticks_bits) >> 4;
            let speed = u64::try_from(speed).unwrap_or(u64::MAX).clamp(2, 1 << 47);
            let reached = (8.0 * jerk as f64 * speed as f64).sqrt() as u64;
            let max = 1 + b % reached.max(1);
            (Gain::new(jerk, max, speed), speed)
        })
    }

    proptest! {
        /// The inverse is exact: the next larger acceleration would overshoot.
        #[test]
        fn settling_is_the_largest_acceleration_without_overshoot((gain, speed) in any_gain(), part in any::<u64>()) {
            let desired = part % speed;
            let a = settling(desired, gain.jerk);
            prop_assert!(gain.of(a) <= desired);
            prop_assert!(a == gain.max || gain.of(a + 1) > desired);
        }

        /// The inverse without a root gives the same for all bounds of the search.
        #[test]
        fn the_inverse_matches_the_root_for_any_bounds(
            (gain, speed) in any_gain(),
            part in any::<u64>(),
            below in 0_u64..3 << 40,
            above in 0_u64..3 << 40,
            near in -9_i64..9,
        ) {
            let desired = part % speed;
            let a = settling(desired, gain.jerk);
            let within = |x: u64| x % (3 * gain.jerk);
            let (min, max) = (a.saturating_sub(within(below)), (a + within(above)).min(gain.max));
            let near = a.saturating_add_signed(near * gain.jerk as i64).min(gain.max);
            let mut near = gain.step(near);
            prop_assert_eq!(gain.inverse(desired, min, max, &mut near), a.clamp(min, max));
            let ended = gain.step(near.base);
            prop_assert_eq!((near.number, near.base, near.gain), (ended.number, ended.base, ended.gain));
            let (min, max) = (a + 1, a + 1 + within(above));
            prop_assert_eq!(gain.inverse(desired, min, max, &mut near), min, "all is above");
        }

        /// The closed form of g equals its sum.
        #[test]
        fn the_closed_form_of_the_gain_equals_its_sum(acceleration in 0_u64..100_000, jerk in 64_u64..5_000) {
            let mut sum = 0;
            let mut a = acceleration;
            while a > 0 {
                sum += a;
                a = a.saturating_sub(jerk);
            }
            prop_assert_eq!(Gain::new(jerk, 100_000, 100_000).of(acceleration), sum);
        }
    }
}
