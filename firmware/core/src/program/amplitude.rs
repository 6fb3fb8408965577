//! Override of the amplitude: the operator's factor on every level of the program.

use crate::functions::multiply;
use crate::units::Amax;

/// Change of the factor, per second.
pub const OVERRIDE_RATE_PER_S: u32 = 1;

/// Greatest factor, in thousandths.
pub const MAX_OVERRIDE_PERMILLE: u16 = 1200;

/// Fraction bits of the factor.
const FRACTION_BITS: u32 = 30;
const ONE: u32 = 1 << FRACTION_BITS;

/// Factor on the levels of a program, which goes to its target in a ramp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AmplitudeOverride {
    now: u32,
    target: u32,
    /// Change in a tick.
    step: u32,
    permille: u16,
}

impl AmplitudeOverride {
    /// Factor 1, for a tick rate in Hz.
    pub const fn new(tick_hz: u32) -> Self {
        Self {
            now: ONE,
            target: ONE,
            step: ONE / tick_hz * OVERRIDE_RATE_PER_S,
            permille: 1000,
        }
    }

    /// Change in a tick, which never changes itself.
    pub(crate) const fn step(&self) -> u32 {
        let Self {
            now: _,
            target: _,
            step,
            permille: _,
        } = self;
        *step
    }

    /// Sets the target in thousandths; one above [`MAX_OVERRIDE_PERMILLE`] counts as that.
    #[cold]
    pub fn set(&mut self, permille: u16) {
        self.permille = permille.min(MAX_OVERRIDE_PERMILLE);
        let scaled = u64::from(ONE) * u64::from(self.permille) / 1000;
        self.target = scaled as u32;
    }

    /// Target, in thousandths.
    pub const fn permille(&self) -> u16 {
        self.permille
    }

    /// True if levels stay as they are.
    pub const fn is_one(&self) -> bool {
        self.now == ONE && self.target == ONE
    }

    /// Moves the factor by one tick, and scales a level and the level at the end of its segment.
    ///
    /// The factor has 30 fraction bits, and a scaled level is rounded down by at most 2⁻⁴⁷ m/s².
    #[inline(never)] // Most programs are played as they are.
    pub fn advance(&mut self, level: Amax, end_level: Amax) -> (Amax, Amax) {
        self.now = if self.now < self.target {
            self.target.min(self.now + self.step)
        } else {
            self.target.max(self.now.saturating_sub(self.step))
        };
        (scale(level, self.now), scale(end_level, self.target))
    }
}

/// Product of a level up to 2¹⁵ m/s² and a factor below 2.
const fn scale(level: Amax, factor: u32) -> Amax {
    let bits = level.to_bits();
    // Upper and lower half are multiplied separately, as the whole product has 95 bits.
    let high = multiply((bits >> 32) as u32, factor) << (32 - FRACTION_BITS);
    let low = multiply(bits as u32, factor) >> FRACTION_BITS;
    Amax::from_bits(high + low)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a factor of 1 changes a level, and runs with and without a link differ.
    #[test]
    fn a_factor_of_one_changes_nothing() {
        for bits in [1, 0x1234_5678_9ABC, u64::from(u32::MAX), 10_000 << 48] {
            let level = Amax::from_bits(bits);
            assert_eq!(scale(level, ONE), level);
        }
    }

    /// The factor reaches its target in a straight ramp, and the levels with it.
    #[test]
    fn the_factor_ramps_to_its_target_and_no_further() {
        let mut factor = AmplitudeOverride::new(1000);
        factor.set(2000);
        assert_eq!(factor.permille(), 1200);
        let level = Amax::from_num(1000);
        let levels: std::vec::Vec<f64> = (0..400)
            .map(|_| factor.advance(level, level).0.to_num())
            .collect();
        assert!((levels[99] - 1100.0).abs() < 0.01, "{}", levels[99]);
        assert!((levels[399] - 1200.0).abs() < 1e-5, "{}", levels[399]);
        factor.set(0);
        for _ in 0..1300 {
            factor.advance(level, level);
        }
        assert_eq!(factor.advance(level, level), (Amax::ZERO, Amax::ZERO));
    }
}
