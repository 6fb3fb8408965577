//! Electronic gear with an exact ratio.

use crate::functions::{Divisor, multiply_long};
use crate::units::Turns;

/// Gear ratio, turns of the axis per turn of the master, as a ratio of two integers. No fraction is lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gear {
    numerator: u32,
    denominator: u32,
    divisor: Divisor,
    /// Remainder of the division, 0 ≤ rest < denominator.
    rest: u32,
}

impl Gear {
    /// Gear with the ratio `numerator / denominator`, each 1 to 1000.
    pub const fn new(numerator: u32, denominator: u32) -> Self {
        Self {
            numerator,
            denominator,
            divisor: Divisor::new(denominator),
            rest: 0,
        }
    }

    /// Whether the axis makes the master's own turns.
    pub const fn is_direct(&self) -> bool {
        self.numerator == self.denominator
    }

    /// Turns of the axis for turns of the master, which must be within ±1 turn.
    #[inline]
    pub fn advance(&mut self, master: Turns) -> Turns {
        if self.is_direct() {
            return master; // The usual case needs no division.
        }
        let all = multiply_long(master.to_bits().unsigned_abs(), self.numerator);
        if master >= 0 {
            let (turns, rest) = self.divisor.divide(all + u64::from(self.rest));
            self.rest = rest;
            return Turns::from_bits(turns as i64);
        }
        // In reverse the remainder is missing from the next unit.
        let missing = self.denominator - 1 - self.rest;
        let (turns, missing) = self.divisor.divide(all + u64::from(missing));
        self.rest = self.denominator - 1 - missing;
        Turns::from_bits(-(turns as i64))
    }

    /// Acceleration of the axis for one of the master, below 1 turn a tick², rounded towards zero; the remainder is
    /// dropped.
    pub fn share(&self, acceleration: Turns) -> Turns {
        if self.is_direct() {
            return acceleration;
        }
        let all = multiply_long(acceleration.to_bits().unsigned_abs(), self.numerator);
        let share = self.divisor.divide(all).0 as i64;
        Turns::from_bits(if acceleration < 0 { -share } else { share })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::ONE_TURN;
    use proptest::prelude::*;

    proptest! {
        /// After any number of ticks the axis is at the exact ratio, to less than one unit.
        #[test]
        fn nothing_is_lost(
            numerator in 1_u32..=1000,
            denominator in 1_u32..=1000,
            master in prop::collection::vec(-ONE_TURN..ONE_TURN, 0..200),
        ) {
            let mut gear = Gear::new(numerator, denominator);
            let (mut sum, mut axis) = (0_i128, 0_i128);
            for turns in master {
                sum += i128::from(turns);
                axis += i128::from(gear.advance(Turns::from_bits(turns)).to_bits());
                let exact = sum * i128::from(numerator);
                prop_assert_eq!(axis, exact.div_euclid(i128::from(denominator)));
                let share = i128::from(turns) * i128::from(numerator) / i128::from(denominator);
                prop_assert_eq!(i128::from(gear.share(Turns::from_bits(turns)).to_bits()), share);
            }
        }
    }
}
