//! Square law amax = L ω²: the amplitude of every mechanism whose platform follows the crank angle alone.
//!
//! L is a length in metres: the crank radius times the greatest curvature of the mechanism. The inverse,
//! ω = sqrt(amax / L), has an infinite slope at rest. The limits of the master shaft, not this root, decide how a machine
//! starts.

use crate::functions::{Root, multiply, root};
use crate::units::{Amax, Turns};

/// Coefficients of one length at one tick rate.
#[derive(Clone, Copy, Debug, Hash)]
pub struct SquareLaw {
    /// Mantissa of the speed at 1 m/s², `mantissa / 2^shift` turns a tick; its top bit is set.
    mantissa: u32,
    shift: u32,
}

impl SquareLaw {
    /// Placeholder for a machine that is not set up yet.
    pub const STANDSTILL: Self = Self {
        mantissa: 1 << 31,
        shift: 48,
    };

    /// Coefficients for a length of 0.01 mm to 1 m and a tick rate of 500 to 10,000 Hz.
    #[cold]
    pub fn new(length_m: f64, tick_hz: u32) -> Self {
        let speed_at_one =
            1.0 / (core::f64::consts::TAU * f64::from(tick_hz) * libm::sqrt(length_m));
        // 0.5 ≤ fraction < 1, speed_at_one = fraction · 2^exponent
        let (fraction, exponent) = libm::frexp(speed_at_one);
        let mantissa = libm::round(fraction * 4294967296.0) as u64;
        let (mantissa, exponent) = match u32::try_from(mantissa) {
            Ok(mantissa) => (mantissa, exponent),
            Err(_) => (1 << 31, exponent + 1), // It was rounded up to a whole power of two.
        };
        // Over these ranges the speed is from 1e-5 to 0.11 turns a tick, so the shift is 35 to 48.
        Self {
            mantissa,
            shift: (32 - exponent).unsigned_abs(),
        }
    }

    /// Speed for an amplitude, in turns a tick.
    ///
    /// The error is below 2⁻³⁰ of the result plus 2⁻⁴⁸ turns a tick. The result saturates beyond 2 turns a tick, four
    /// times the greatest speed of a shaft.
    #[inline(never)]
    pub fn speed(&self, amax: Amax) -> Turns {
        let Root { mantissa, shift } = root(amax.to_bits());
        let product = multiply(mantissa, self.mantissa);
        // root(bits) is sqrt(amax) · 2²⁴; the result has 48 fraction bits.
        let down = (shift + self.shift + 24).saturating_sub(Turns::FRAC_NBITS);
        let bits = product.checked_shr(down).unwrap_or(0);
        Turns::from_bits(bits.min(2 << Turns::FRAC_NBITS) as i64)
    }

    /// Amplitude at a speed of either sign, in m/s². The error is below 2⁻²⁸ of the result plus 2⁻⁴⁸ m/s².
    pub fn amax(&self, speed: Turns) -> Amax {
        let bits = speed.to_bits().unsigned_abs();
        if bits == 0 {
            return Amax::ZERO;
        }
        // Both are normalised to 32 bits: speed = s · 2^(16 − zeros), with 48 fraction bits.
        let zeros = bits.leading_zeros();
        let s = (bits << zeros) >> 32;
        // speed / speed_at_one = s/mantissa · 2^(32 − zeros − 48 + shift); the quotient is 0.5 to 2.
        let quotient = ((s << 31) / u64::from(self.mantissa)).min(u64::from(u32::MAX));
        let square = quotient * quotient; // 62 fraction bits
        let exponent = 2 * (i64::from(self.shift) - 16 - i64::from(zeros));
        let up = exponent + i64::from(Amax::FRAC_NBITS) - 62;
        let bits = if up >= 0 {
            if i64::from(square.leading_zeros()) > up {
                square << up
            } else {
                u64::MAX
            }
        } else {
            square.checked_shr(up.unsigned_abs() as u32).unwrap_or(0)
        };
        Amax::from_bits(bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of both directions against f64, over the documented ranges of length and tick rate.
    #[test]
    fn errors_are_within_their_bounds() {
        let mut worst = (0.0_f64, 0.0_f64);
        for length_m in [1e-5, 1e-4, 0.0011514, 0.0059, 0.025, 0.0779, 0.5, 1.0] {
            for tick_hz in [500, 2000, 10_000] {
                let law = SquareLaw::new(length_m, tick_hz);
                let mut amax_mps2 = 0.01;
                while amax_mps2 < 2000.0 {
                    let omega = (amax_mps2 / length_m).sqrt();
                    let expected = omega / core::f64::consts::TAU / f64::from(tick_hz);
                    if expected < 0.5 {
                        let speed = law.speed(Amax::from_num(amax_mps2));
                        let actual: f64 = speed.to_num();
                        let rounding = (-48.0_f64).exp2() / expected;
                        worst.0 = worst.0.max((actual / expected - 1.0).abs() - rounding);
                        let back: f64 = law.amax(speed).to_num();
                        let fair = amax_mps2 * (actual / expected) * (actual / expected);
                        let rounding = (-48.0_f64).exp2() / fair;
                        worst.1 = worst.1.max((back / fair - 1.0).abs() - rounding);
                    }
                    amax_mps2 *= 1.0173;
                }
            }
        }
        assert!(worst.0 < (-30.0_f64).exp2(), "speed: {:e}", worst.0);
        assert!(worst.1 < (-28.0_f64).exp2(), "amax: {:e}", worst.1);
    }

    #[test]
    fn zero_amplitude_corresponds_to_zero_speed() {
        let law = SquareLaw::new(0.0325, 2000);
        assert_eq!(law.speed(Amax::ZERO), Turns::ZERO);
        assert_eq!(law.amax(Turns::ZERO), Amax::ZERO);
        assert_eq!(
            law.amax(Turns::from_num(-0.01)),
            law.amax(Turns::from_num(0.01))
        );
    }
}
