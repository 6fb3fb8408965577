//! Exact division of 64 by 32 bits, without a division instruction.
//!
//! A divisor is shifted up until its top bit is set, and its exact reciprocal is computed once. Each half of a quotient
//! then costs one product and two corrections. The method is the 2-by-1 division of Möller and Granlund,
//! "Improved division by invariant integers", IEEE Transactions on Computers 60 (2011), algorithm 4.

use super::multiply::{multiply, multiply_high};
use super::normalise::normalised;
use super::reciprocal;

/// A divisor from 1 to 2³² − 1 with its precomputed reciprocal.
///
/// ```
/// use cophase_motion::functions::Divisor;
/// assert_eq!(Divisor::new(10).divide(1_000_000_000_007), (100_000_000_000, 7));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Divisor {
    /// The divisor, shifted up by `shift`.
    normalised: u32,
    shift: u32,
    /// ⌊(2⁶⁴ − 1) / normalised⌋ − 2³².
    inverse: u32,
}

impl Divisor {
    /// Precomputes the reciprocal of `divisor`, from 1 to 2³² − 1. A divisor of 0 is taken as 1.
    #[inline]
    pub const fn new(divisor: u32) -> Self {
        let divisor = if divisor == 0 { 1 } else { divisor };
        let (normalised, shift) = normalised((divisor as u64) << 32);
        // Approach from below: the reciprocal may be two units too high, and the goal has 33 bits.
        let near = reciprocal(normalised);
        let mut quotient = ((near as u64) << 1) - 4;
        let product = multiply(near - 2, normalised) << 1;
        let mut rest = u64::MAX - product; // below 2^41: 2^-26 of all, and some units
        let more = multiply_high((rest >> 9) as u32, near) >> 22;
        quotient += more as u64;
        rest -= multiply(more, normalised);
        while rest >= normalised as u64 {
            quotient += 1;
            rest -= normalised as u64;
        }
        Self {
            normalised,
            shift,
            inverse: quotient as u32,
        }
    }

    /// Quotient (rounded down) and remainder of `number / divisor`. Both are exact for every `number`.
    #[inline]
    pub const fn divide(&self, number: u64) -> (u64, u32) {
        let shift = self.shift;
        let (high, low) = ((number >> 32) as u32, number as u32);
        // The number is shifted up by as much, into three words. The first is below the divisor.
        let first = high >> 1 >> (31 - shift);
        let second = high << shift | low >> 1 >> (31 - shift);
        let (upper, rest) = self.step(first, second);
        let (lower, rest) = self.step(rest, low << shift);
        ((upper as u64) << 32 | lower as u64, rest >> shift)
    }

    /// Divides two words, for `high` below the normalised divisor: quotient and remainder.
    #[inline(always)]
    const fn step(&self, high: u32, low: u32) -> (u32, u32) {
        let guess = multiply(self.inverse, high).wrapping_add((high as u64) << 32 | low as u64);
        let mut quotient = ((guess >> 32) as u32).wrapping_add(1);
        let mut rest = low.wrapping_sub(quotient.wrapping_mul(self.normalised));
        if rest > guess as u32 {
            quotient = quotient.wrapping_sub(1);
            rest = rest.wrapping_add(self.normalised);
        }
        if rest >= self.normalised {
            quotient = quotient.wrapping_add(1);
            rest -= self.normalised;
        }
        (quotient, rest)
    }
}

/// Quotient `number / divisor`, rounded down, for a number below 2⁵⁰ and a divisor from 1 to 2²⁴ − 1. For one division it
/// takes half the time of a [`Divisor`].
pub const fn quotient(number: u64, divisor: u32) -> u64 {
    // Two digits by an approximate reciprocal, which is not above the exact one, and short of it by less than 2^-25. So the
    // first is short by a rest below 2^25, its own rounding, and that of the number's upper bits: a word holds it.
    let (normalised, shift) = normalised((divisor as u64) << 32); // 2^8 ≤ 2^shift
    let inverse = reciprocal(normalised) - 2;
    let first = multiply_high((number >> 18) as u32, inverse);
    let (high, low) = if shift >= 13 {
        // Two steps, as a word cannot be shifted by 32.
        (first >> 1 >> (44 - shift), first << (shift - 13))
    } else {
        (0, first >> (13 - shift))
    };
    let rest = (number as u32).wrapping_sub(low.wrapping_mul(divisor));
    let second = multiply_high(rest, inverse) >> (31 - shift);
    let is_short = rest - second * divisor >= divisor;
    ((high as u64) << 32 | low as u64) + (second + is_short as u32) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Numbers of all lengths, and the neighbours of powers of two.
    fn any_length() -> impl Strategy<Value = u64> {
        let near =
            (0_u32..64, -2_i64..=2).prop_map(|(bit, off)| (1_u64 << bit).wrapping_add_signed(off));
        prop_oneof![
            near,
            (any::<u64>(), 0_u32..64).prop_map(|(bits, shift)| bits >> shift)
        ]
    }

    proptest! {
        #[test]
        fn quotients_and_remainders_are_exact(number in any_length(), divisor in any_length()) {
            let divisor = (divisor as u32).max(1);
            let (quotient, rest) = Divisor::new(divisor).divide(number);
            prop_assert_eq!(quotient, number / u64::from(divisor));
            prop_assert_eq!(u64::from(rest), number % u64::from(divisor));
        }

        /// The same for the quotient alone, within its range.
        #[test]
        fn short_quotients_are_exact(number in any_length(), divisor in any_length()) {
            let number = number >> 14;
            let divisor = (divisor as u32 >> 8).max(1);
            prop_assert_eq!(quotient(number, divisor), number / u64::from(divisor));
            let multiple = number / u64::from(divisor) * u64::from(divisor);
            prop_assert_eq!(quotient(multiple, divisor), number / u64::from(divisor));
            if let Some(less) = multiple.checked_sub(1) {
                prop_assert_eq!(quotient(less, divisor), less / u64::from(divisor));
            }
        }

        /// A multiple and its lower neighbour, where a quotient is most easily off by one.
        #[test]
        fn division_is_exact_at_multiples_and_just_below(quotient in any_length(), divisor in any_length()) {
            let divisor = (divisor as u32).max(1);
            let Some(number) = quotient.checked_mul(u64::from(divisor)) else { return Ok(()) };
            let by = Divisor::new(divisor);
            prop_assert_eq!(by.divide(number), (quotient, 0));
            if let Some(less) = number.checked_sub(1) {
                prop_assert_eq!(by.divide(less), (less / u64::from(divisor), divisor - 1));
            }
        }
    }

    /// The short quotient for divisors of all sizes, at both ends of the range of numbers.
    #[test]
    fn short_quotients_are_exact_for_large_numbers() {
        for divisor in (1..1 << 12)
            .chain(((1 << 12)..1 << 24).step_by(997))
            .chain([(1 << 24) - 1])
        {
            for number in [
                (1 << 50) - 1,
                (1 << 49) + 12_345,
                (1 << 32) - 1,
                1 << 18,
                u64::from(divisor) - 1,
            ] {
                assert_eq!(
                    quotient(number, divisor),
                    number / u64::from(divisor),
                    "{number} / {divisor}"
                );
            }
        }
    }

    /// The reciprocal itself, for every divisor of up to 16 bits and for both ends of the 32-bit range.
    #[test]
    fn the_inverse_is_exact() {
        for divisor in (1..1 << 16)
            .chain(u32::MAX - 1000..=u32::MAX)
            .chain(1 << 31..(1 << 31) + 1000)
        {
            let by = Divisor::new(divisor);
            let expected = u64::MAX / u64::from(by.normalised) - (1 << 32);
            assert_eq!(u64::from(by.inverse), expected, "{divisor}");
        }
    }
}
