//! 1 / sqrt(1 − x) for the rod's obliquity, x = λ² sin²α, without division or root.
//!
//! Linear interpolation between 65 table entries is within 4e-5. One Newton step squares the relative error
//! (times 3/2) and costs two full products. The table takes 130 bytes of flash.

use super::{ONE_Q30, multiply_q30};

const STEPS: usize = 64; // to x = 1/2
const STEP_BITS: u32 = 29 - STEPS.trailing_zeros();

/// Inverse root 1 / sqrt(1 − x) with 30 fraction bits, for `x` from 0 to 0.5 (exclusive) with 30 fraction bits.
///
/// The absolute error is at most 4e-9, and at most 2.6e-9 for x up to 0.36, the square of the greatest λ (tested: mean,
/// rms and maximum). Outside the range the result has no meaning.
///
/// Formula: y ← y (3 − (1 − x) y²) / 2, Newton's iteration for the inverse root.
pub fn inverse_root_of_one_minus(x: i32) -> i32 {
    let index = (x >> STEP_BITS) as usize % STEPS;
    let (from, to) = (i32::from(FRACTION[index]), i32::from(FRACTION[index + 1]));
    let within = (x >> (STEP_BITS - 16)) & 0xffff;
    let y = ONE_Q30 + (((from << 16) + (to - from) * within) >> 2);
    // y (3 − (1 − x) y²) / 2 = y + y · half, and |half| < 4e-5 fits in 15 bits.
    let half = (ONE_Q30 - multiply_q30(multiply_q30(ONE_Q30 - x, y), y)) >> 1;
    y + (((y >> 15) * half) >> 15)
}

/// Table of 2¹⁶ (1 / sqrt(1 − x) − 1), rounded, at x = i/128.
static FRACTION: [u16; STEPS + 1] = fractions();

const fn fractions() -> [u16; STEPS + 1] {
    let mut table = [0; STEPS + 1];
    let mut i = 0;
    while i <= STEPS {
        let twice = (((2 * STEPS as u64) << 34) / (2 * STEPS - i) as u64).isqrt();
        table[i] = (twice.div_ceil(2) - (1 << 16)) as u16;
        i += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sources of error at one x, with y the result, u = 2⁻³⁰, h = 1/128 and t the place between two entries:
    ///
    /// - The interpolation, before the step, is off by e = ½ h² · ¾ y⁵ · t (1 − t) and by the rounding of its two
    ///   entries. The step leaves −3/2 · e²/y of it.
    /// - Five truncations are each uniform from 0 to their unit. The two products' u are negated and halved by the
    ///   step (+½ y² and +½ y). The halving adds −y (of ½ u at most) and the last shift −1. The truncation of y is
    ///   2⁻¹⁵, times `half` = −e/y.
    ///
    /// Over t, t(1 − t) has the mean 1/6, its square 1/30, its fourth power 1/630.
    #[test]
    fn error_statistics_match_their_derivation() {
        let unit = (-30.0_f64).exp2();
        let entries = (-32.0_f64).exp2() / 12.0 * 2.0 / 3.0;
        let (mut sum, mut squares, mut worst) = (0.0, 0.0_f64, 0.0_f64);
        let (mut sum_derived, mut squares_derived) = (0.0, 0.0_f64);
        let samples = 1_000_003; // prime, so samples fall everywhere between the entries
        for i in 0..samples {
            let x = (0.36 * f64::from(ONE_Q30) * f64::from(i) / f64::from(samples)) as i32;
            let y = (1.0 - f64::from(x) * unit).sqrt().recip();
            let error = f64::from(inverse_root_of_one_minus(x)) * unit - y;
            sum += error;
            squares += error * error;
            worst = worst.max(error.abs());

            let curve = 0.5 * 0.75 * y.powi(5) / 128.0 / 128.0;
            let step = -1.5 / y * (curve * curve / 30.0 + entries);
            let cuts = unit * (y * y / 4.0 + y / 4.0 - y / 4.0 - 0.5);
            let last = (-16.0_f64).exp2() * curve / 6.0 / y;
            let mean = step + cuts + last;
            let variance = (1.5 / y).powi(2) * curve.powi(4) * (1.0 / 630.0 - 1.0 / 900.0)
                + unit * unit * (y.powi(4) / 48.0 + y * y / 48.0 + y * y / 16.0 + 1.0 / 12.0)
                + (-30.0_f64).exp2() / 3.0 * curve * curve / 30.0 / y / y
                - last * last;
            sum_derived += mean;
            squares_derived += mean * mean + variance;
        }
        let count = f64::from(samples);
        let (mean, mean_derived) = (sum / count, sum_derived / count);
        let (rms, rms_derived) = ((squares / count).sqrt(), (squares_derived / count).sqrt());
        assert!(
            (mean - mean_derived).abs() < 0.03 * rms,
            "mean {mean:e}, {mean_derived:e}"
        );
        assert!(
            (rms / rms_derived - 1.0).abs() < 0.03,
            "rms {rms:e}, {rms_derived:e}"
        );
        assert!(worst < 2.6e-9, "max {worst:e}");
    }

    /// The sum of all parts at their worst, over the whole range. There is no jump at an entry or at the range's ends.
    #[test]
    fn error_is_bounded_over_the_whole_range() {
        for x in (0..ONE_Q30 / 2).step_by(997).chain([1, ONE_Q30 / 2 - 1]) {
            let exact = (1.0 - f64::from(x) / f64::from(ONE_Q30)).sqrt().recip();
            let error = f64::from(inverse_root_of_one_minus(x)) / f64::from(ONE_Q30) - exact;
            assert!(error.abs() < 4e-9, "at {x}: {error:e}");
        }
        assert_eq!(inverse_root_of_one_minus(0), ONE_Q30);
    }
}
