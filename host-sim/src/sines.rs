//! Sines and cosines of the equations of motion: of several angles at once, and the same on every platform.
//!
//! An angle is reduced to a quarter turn around 0 by a multiple of π/2, whose parts have trailing zeros so that their products with the
//! number of quarter turns are exact (W. J. Cody, W. Waite, *Software Manual for the Elementary Functions*, 1980). The polynomials are those
//! of fdlibm's `k_sin.c` and `k_cos.c`. No angle takes a branch of its own, so the compiler computes several side by side.

use std::f64::consts::FRAC_2_PI;

/// Largest angle, rad, up to which the products of the reduction are exact: 2^20 quarter turns.
const MAX_RAD: f64 = 1.6e6;

/// 1.5 · 2^52. A sum with it is rounded to a whole number, which is in its low bits.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// π/2 in parts of 33 bits, and the rest.
const QUARTER: [f64; 4] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_711_166_5e-21,
    8.478_427_660_368_9e-32,
];

/// Coefficients of x³, x⁵, … in the sine.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// Coefficients of x⁴, x⁶, … in the cosine.
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sines and cosines of angles, rad. The error is below 1.3e-16 for angles up to 1.6e6 rad; the standard library computes those of larger
/// ones.
#[inline(always)] // so that its loops are unrolled and vectorised with those around them
pub fn sin_cos<const N: usize>(angles_rad: &[f64; N]) -> ([f64; N], [f64; N]) {
    let is_near = |angle: &f64| angle.abs() <= MAX_RAD;
    if !angles_rad.iter().all(is_near) {
        return of_library(angles_rad);
    }
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        (sines[i], cosines[i]) = near(angles_rad[i]);
    }
    (sines, cosines)
}

#[inline(always)]
fn near(angle_rad: f64) -> (f64, f64) {
    let shifted = angle_rad * FRAC_2_PI + WHOLE;
    let quarters = shifted - WHOLE;
    let x = angle_rad - quarters * QUARTER[0] - quarters * QUARTER[1];
    let x = x - quarters * QUARTER[2] - quarters * QUARTER[3];
    let z = x * x;
    let [s3, s5, s7, s9, s11, s13] = SINE;
    let sine = x + x * z * (s3 + z * (s5 + z * (s7 + z * (s9 + z * (s11 + z * s13)))));
    let [c4, c6, c8, c10, c12, c14] = COSINE;
    let above = z * z * (c4 + z * (c6 + z * (c8 + z * (c10 + z * (c12 + z * c14)))));
    let half = 0.5 * z;
    let whole = 1.0 - half;
    let cosine = whole + (((1.0 - whole) - half) + above);
    // Odd numbers of quarter turns exchange the two; half of all numbers change a sign.
    let turns = shifted.to_bits();
    let exchanges = 0_u64.wrapping_sub(turns & 1);
    let (sine, cosine) = (sine.to_bits(), cosine.to_bits());
    let exchanged = (sine ^ cosine) & exchanges;
    let sine_sign = (turns & 2) << 62;
    let cosine_sign = (turns.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(sine ^ exchanged ^ sine_sign),
        f64::from_bits(cosine ^ exchanged ^ cosine_sign),
    )
}

#[cold]
#[inline(never)]
fn of_library<const N: usize>(angles_rad: &[f64; N]) -> ([f64; N], [f64; N]) {
    (angles_rad.map(f64::sin), angles_rad.map(f64::cos))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, equations of motion have errors larger than rounding, or a wrong sign in a quarter of the turn.
    #[test]
    fn sines_and_cosines_are_those_of_the_library() {
        let mut max = 0.0_f64;
        for k in 0..200_000 {
            let angle = f64::from(k) * 0.012_345_67 - 1_200.0;
            let angles = [angle, -angle, angle * 1_300.0, angle * 1e-6];
            let (sines, cosines) = sin_cos(&angles);
            for ((angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
                max = max.max((sine - angle.sin()).abs());
                max = max.max((cosine - angle.cos()).abs());
            }
        }
        assert!(max < 2.3e-16, "{max}");
    }

    #[test]
    fn far_angles_are_those_of_the_library() {
        let angles = [1.0, 1e9];
        let (sines, cosines) = sin_cos(&angles);
        assert_eq!(sines, angles.map(f64::sin));
        assert_eq!(cosines, angles.map(f64::cos));
        assert!(sin_cos(&[f64::NAN]).0[0].is_nan());
    }
}
