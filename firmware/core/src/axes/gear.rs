//! An electronic gear with an exact ratio.

use crate::units::Turns;

/// Turns of the axis per turn of the master, as a ratio of two whole numbers; nothing is lost.
#[derive(Clone, Debug)]
pub struct Gear {
    numerator: i64,
    denominator: i64,
    /// What division has left over, 0 ≤ rest < denominator.
    rest: i64,
}

impl Gear {
    /// `numerator / denominator`, each 1 to 1000.
    pub const fn new(numerator: u32, denominator: u32) -> Self {
        Self {
            numerator: numerator as i64,
            denominator: denominator as i64,
            rest: 0,
        }
    }

    /// The ratio: numerator and denominator.
    pub const fn ratio(&self) -> (i64, i64) {
        (self.numerator, self.denominator)
    }

    /// The axis's share of the master's turns, which must be within ±1 turn.
    pub fn advance(&mut self, master: Turns) -> Turns {
        if self.numerator == self.denominator {
            return master; // the usual case, and no division
        }
        let all = master.to_bits() * self.numerator + self.rest;
        self.rest = all.rem_euclid(self.denominator);
        Turns::from_bits(all.div_euclid(self.denominator))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::ONE_TURN;
    use proptest::prelude::*;

    proptest! {
        /// After any number of ticks the axis is where the ratio says, to less than one unit.
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
            }
        }
    }
}
