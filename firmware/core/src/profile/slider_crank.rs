//! The in-line slider-crank: amax = R ω² (1 + λ), reached at crank phase 0.
//!
//! R is the crank radius, λ crank radius over rod length. The formula is the patent's (two terms of
//! the kinematics), and exact at phase 0, where the greatest acceleration is. Its inverse, ω =
//! sqrt(amax / (R (1 + λ))), has an infinite slope at rest: the master shaft's limits, not this
//! root, decide how a machine starts.

use crate::functions::{Root, multiply, root};
use crate::units::{Amax, Turns};

/// The coefficients of one slider-crank at one tick rate.
#[derive(Clone, Copy, Debug)]
pub struct SliderCrank {
    /// Turns a tick at 1 m/s² are `mantissa / 2^shift`; the mantissa has its top bit set.
    mantissa: u32,
    shift: u32,
}

impl SliderCrank {
    /// Coefficients for where there is no machine yet.
    pub const STANDSTILL: Self = Self {
        mantissa: 1 << 31,
        shift: 48,
    };

    /// For crank radius R (metres, 0.1 mm to 0.5 m), ratio λ (0.1 to 0.6) and a tick rate of 500 to
    /// 10,000 Hz. [`crate::settings`] checks the ranges.
    #[cold]
    pub fn new(crank_radius_m: f64, lambda: f64, tick_hz: u32) -> Self {
        let speed_at_one = 1.0
            / (core::f64::consts::TAU
                * f64::from(tick_hz)
                * libm::sqrt(crank_radius_m * (1.0 + lambda)));
        // 0.5 ≤ fraction < 1, speed_at_one = fraction · 2^exponent
        let (fraction, exponent) = libm::frexp(speed_at_one);
        let mantissa = libm::round(fraction * 4294967296.0) as u64;
        let (mantissa, exponent) = match u32::try_from(mantissa) {
            Ok(mantissa) => (mantissa, exponent),
            Err(_) => (1 << 31, exponent + 1), // rounded up to a whole power of two
        };
        // Over the ranges the speed is from 2e-5 to 0.04 turns a tick: the shift is 36 to 48.
        Self {
            mantissa,
            shift: (32 - exponent).unsigned_abs(),
        }
    }

    /// Turns a tick for an amplitude; relative error below 2⁻³⁰ and 2⁻⁴⁸ turns a tick.
    ///
    /// Saturates beyond 2 turns a tick, four times what a shaft may do.
    #[inline(never)]
    pub fn speed(&self, amax: Amax) -> Turns {
        let Root { mantissa, shift } = root(amax.to_bits());
        let product = multiply(mantissa, self.mantissa);
        // root(bits) is sqrt(amax) · 2²⁴; 48 fraction bits are wanted.
        let down = (shift + self.shift + 24).saturating_sub(Turns::FRAC_NBITS);
        let bits = product.checked_shr(down).unwrap_or(0);
        Turns::from_bits(bits.min(2 << Turns::FRAC_NBITS) as i64)
    }

    /// The amplitude at a speed of either sign; relative error below 2⁻²⁸ and 2⁻⁴⁸ m/s².
    pub fn amax(&self, speed: Turns) -> Amax {
        let bits = speed.to_bits().unsigned_abs();
        if bits == 0 {
            return Amax::ZERO;
        }
        // Both normalised to 32 bits: speed = s · 2^(16 − zeros), with 48 fraction bits.
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

    /// Both directions against f64 over the documented ranges of R, λ and tick rate.
    #[test]
    fn errors_are_within_their_bounds() {
        let mut worst = (0.0_f64, 0.0_f64);
        for radius_m in [1e-4, 0.0011514, 0.0046055, 0.025, 0.0779, 0.5] {
            for lambda in [0.1, 0.25, 0.3, 0.6] {
                for tick_hz in [500, 2000, 10_000] {
                    let crank = SliderCrank::new(radius_m, lambda, tick_hz);
                    let mut amax_mps2 = 0.01;
                    while amax_mps2 < 2000.0 {
                        let omega = (amax_mps2 / (radius_m * (1.0 + lambda))).sqrt();
                        let want = omega / core::f64::consts::TAU / f64::from(tick_hz);
                        if want < 0.5 {
                            let speed = crank.speed(Amax::from_num(amax_mps2));
                            let got: f64 = speed.to_num();
                            let rounding = (-48.0_f64).exp2() / want;
                            worst.0 = worst.0.max((got / want - 1.0).abs() - rounding);
                            let back: f64 = crank.amax(speed).to_num();
                            let fair = amax_mps2 * (got / want) * (got / want);
                            let rounding = (-48.0_f64).exp2() / fair;
                            worst.1 = worst.1.max((back / fair - 1.0).abs() - rounding);
                        }
                        amax_mps2 *= 1.0173;
                    }
                }
            }
        }
        assert!(worst.0 < (-30.0_f64).exp2(), "speed: {:e}", worst.0);
        assert!(worst.1 < (-28.0_f64).exp2(), "amax: {:e}", worst.1);
    }

    #[test]
    fn rest_is_rest() {
        let crank = SliderCrank::new(0.025, 0.3, 2000);
        assert_eq!(crank.speed(Amax::ZERO), Turns::ZERO);
        assert_eq!(crank.amax(Turns::ZERO), Amax::ZERO);
        assert_eq!(
            crank.amax(Turns::from_num(-0.01)),
            crank.amax(Turns::from_num(0.01))
        );
    }
}
