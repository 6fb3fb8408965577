//! What the speed gains while an acceleration is let go, and which acceleration gains a given speed.
//!
//! Let the acceleration be a now, and let it go towards zero by the jerk J a tick. While it goes,
//! the speed still gains
//!
//! D(a) = (a − J) + (a − 2J) + …  (as long as the terms are positive).
//!
//! Taking acceleration a for one tick and then letting it go gains g(a) = a + D(a) in all. With
//! n = ⌊a/J⌋ and b = n J that is b (n + 1)/2 + (n + 1) (a − b): straight between multiples of J, and growing. The
//! inverse needs a root, to find n. But what is wanted in a tick is at most a jerk away from what was, so that n is
//! known but for one or two, and is tried from above.

use crate::functions::{Divisor, multiply_high, multiply_long, reciprocal};

/// g and its inverse, for one limit of jerk.
#[derive(Clone, Debug)]
pub(super) struct Gain {
    jerk: u64,
    /// Accelerations up to here are asked about.
    most: u64,
    /// ⌊a/J⌋ is about `(a >> scale) · inverse / 2^(32 + down)`.
    scale: u32,
    inverse: u32,
    down: u32,
}

/// The multiple of the jerk below an acceleration.
pub(super) struct Step {
    /// n, below 2²³: settings bound the length of a ramp.
    pub number: u32,
    /// b = n J.
    pub base: u64,
    /// g(b) = b (n + 1)/2.
    gain: u64,
}

impl Gain {
    /// For `jerk` (59 or more: 64 less what planning leaves, and a rounding), accelerations up to `most` and gains up
    /// to `speed`, none of which must take over 2²³ ticks to let go.
    pub const fn new(jerk: u64, most: u64, speed: u64) -> Self {
        let fastest = settling(speed, jerk);
        let most = if most > fastest { most } else { fastest };
        let zeros = jerk.leading_zeros();
        let scale = 32_u32.saturating_sub((most | jerk).leading_zeros());
        Self {
            jerk,
            most,
            scale,
            inverse: reciprocal(((jerk << zeros) >> 32) as u32),
            down: (63 - zeros).saturating_sub(scale),
        }
    }

    /// g(`acceleration`).
    pub const fn of(&self, acceleration: u64) -> u64 {
        self.above(&self.step(acceleration), acceleration)
    }

    /// g(a) of an acceleration from a step up to, and including, the next.
    pub const fn above(&self, step: &Step, acceleration: u64) -> u64 {
        step.gain + multiply_long(acceleration - step.base, step.number + 1)
    }

    /// The multiple below `acceleration`.
    pub const fn step(&self, acceleration: u64) -> Step {
        // The scaled acceleration and the inverse are right to 2^-26, so that the quotient is at most one too small.
        let scaled = (acceleration >> self.scale) as u32;
        let mut number = multiply_high(scaled, self.inverse) >> self.down;
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

    /// The largest acceleration a from `least` to `most` with g(a) ≤ `gain`; `least`, if there is none.
    ///
    /// Costs a step for each jerk that `most` is above the result.
    pub fn inverse(&self, gain: u64, least: u64, most: u64) -> u64 {
        let most = most.min(self.most);
        if most <= least {
            return least;
        }
        let mut step = self.step(most);
        if self.above(&step, most) <= gain {
            return most;
        }
        while step.gain > gain && step.base > least {
            step.gain -= step.base;
            step.base -= self.jerk;
            step.number -= 1;
        }
        match gain.checked_sub(step.gain) {
            Some(more) => {
                let (above, _) = Divisor::new(step.number + 1).divide(more);
                (step.base + above).max(least).min(most)
            }
            None => least,
        }
    }
}

/// The largest a with g(a) ≤ `gain`, whatever it is: by a root.
const fn settling(gain: u64, jerk: u64) -> u64 {
    // J n (n + 1)/2 ≤ gain  ⇔  n (n + 1)/2 ≤ ⌊gain / J⌋, all being whole numbers.
    let n = ((8 * (gain / jerk) + 1).isqrt() - 1) / 2;
    (gain + jerk * (n * (n + 1) / 2)) / (n + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Limits as settings may have them: letting go takes up to 2²² ticks.
    fn any_gain() -> impl Strategy<Value = (Gain, u64)> {
        let limits = (5_u32..40, 0_u32..22, any::<(u64, u64)>());
        limits.prop_map(|(jerk_bits, ticks_bits, (a, b))| {
            let jerk = (1 << jerk_bits) + a % (1 << jerk_bits);
            // Of the speed, 2^47 at most, 8 V/J < ticks².
            let speed = u128::from(jerk) << (2 * ticks_bits) >> 4;
            let speed = u64::try_from(speed).unwrap_or(u64::MAX).clamp(2, 1 << 47);
            let reached = (8.0 * jerk as f64 * speed as f64).sqrt() as u64;
            let most = 1 + b % reached.max(1);
            (Gain::new(jerk, most, speed), speed)
        })
    }

    proptest! {
        /// The inverse is exact: the next larger acceleration would overshoot.
        #[test]
        fn settling_is_the_largest_that_does_not_overshoot((gain, speed) in any_gain(), part in any::<u64>()) {
            let wanted = part % speed;
            let a = settling(wanted, gain.jerk);
            prop_assert!(gain.of(a) <= wanted);
            prop_assert!(a == gain.most || gain.of(a + 1) > wanted);
        }

        /// Without a root it is the same, wherever one may look for it.
        #[test]
        fn the_inverse_is_the_root(
            (gain, speed) in any_gain(),
            part in any::<u64>(),
            below in 0_u64..3 << 40,
            above in 0_u64..3 << 40,
        ) {
            let wanted = part % speed;
            let a = settling(wanted, gain.jerk);
            let within = |x: u64| x % (3 * gain.jerk);
            let (least, most) = (a.saturating_sub(within(below)), (a + within(above)).min(gain.most));
            prop_assert_eq!(gain.inverse(wanted, least, most), a.clamp(least, most));
            let (least, most) = (a + 1, a + 1 + within(above));
            prop_assert_eq!(gain.inverse(wanted, least, most), least, "all is above");
        }

        /// The closed form of g against its sum.
        #[test]
        fn letting_go_gains_the_sum(acceleration in 0_u64..100_000, jerk in 64_u64..5_000) {
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
