//! Normal numbers from uniform ones, many at once: √(−2 ln r) cos a, by Box and Muller.
//!
//! The results are those of the `libm` crate, bit for bit. Its functions branch on their argument, and a processor cannot predict a
//! branch on a random number. Here both ways are computed and one is taken, so that a compiler can also make two numbers of one
//! instruction. The formulas are those of FreeBSD's msun: `e_log.c`, `k_cos.c`, `k_sin.c` and `e_rem_pio2.c`.

/// Fills `normals` from numbers above 0 up to 1, and from angles from 0 to 2π, rad.
pub fn fill<const N: usize>(radius: &[f64; N], angle: &[f64; N], normals: &mut [f64; N]) {
    for (normal, (radius, angle)) in normals.iter_mut().zip(radius.iter().zip(angle)) {
        *normal = (-2.0 * log(*radius)).sqrt() * cos(*angle);
    }
    for (normal, (radius, angle)) in normals.iter_mut().zip(radius.iter().zip(angle)) {
        if is_near_quarter(*angle) {
            *normal = (-2.0 * log(*radius)).sqrt() * libm::cos(*angle);
        }
    }
}

/// Natural logarithm of a normal number above 0.
#[inline(always)]
fn log(x: f64) -> f64 {
    const LN2_HI: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
    const LN2_LO: f64 = f64::from_bits(0x3dea_39ef_3579_3c76);
    const LG: [f64; 7] = [
        6.666666666666735130e-01,
        3.999999999940941908e-01,
        2.857142874366239149e-01,
        2.222219843214978396e-01,
        1.818357216161805012e-01,
        1.531383769920937332e-01,
        1.479819860511658591e-01,
    ];
    /// High word of √2/2: x is 2ᵏ (1 + f), with 1 + f from there to √2.
    const ROOT: u32 = 0x3fe6_a09e;
    let bits = x.to_bits();
    let high = ((bits >> 32) as u32).wrapping_add(0x3ff0_0000 - ROOT);
    let k = f64::from((high >> 20) as i32 - 0x3ff);
    let high = (high & 0x000f_ffff) + ROOT;
    let f = f64::from_bits(u64::from(high) << 32 | bits & 0xffff_ffff) - 1.0;
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let t1 = w * (LG[1] + w * (LG[3] + w * LG[5]));
    let t2 = z * (LG[0] + w * (LG[2] + w * (LG[4] + w * LG[6])));
    let r = t2 + t1;
    s * (half_square + r) + k * LN2_LO - half_square + f + k * LN2_HI
}

/// High words of the angles at which the nearest multiple of π/2 changes: π/4 and so on.
const CHANGES: [u32; 4] = [0x3fe9_21fb, 0x4002_d97c, 0x400f_6a7a, 0x4015_fdbc];

/// High words of π/2, π, 3π/2 and 2π.
const QUARTERS: [u32; 4] = [0x3ff9_21fb, 0x4009_21fb, 0x4012_d97c, 0x4019_21fb];

fn high_word(x: f64) -> u32 {
    (x.to_bits() >> 32) as u32
}

/// True for angles so near to π/2, π, 3π/2 or 2π that [`cos`] would lose digits.
#[inline(always)]
fn is_near_quarter(x: f64) -> bool {
    let high = high_word(x);
    QUARTERS.iter().any(|quarter| *quarter == high)
}

/// Cosine of an angle from 0 to 2π that is not [near a quarter](is_near_quarter), rad.
#[inline(always)]
fn cos(x: f64) -> f64 {
    /// π/2 to 33 bits, and the rest of it.
    const HALF_PI: f64 = f64::from_bits(0x3ff9_21fb_5440_0000);
    const HALF_PI_REST: f64 = f64::from_bits(0x3dd0_b461_1a62_6331);
    let high = high_word(x);
    let quarters: i32 = CHANGES.iter().map(|change| i32::from(high > *change)).sum();
    let n = f64::from(quarters);
    let z = x - n * HALF_PI;
    let y = z - n * HALF_PI_REST;
    let rest = (z - y) - n * HALF_PI_REST;
    let is_odd = quarters & 1 == 1;
    let of_rest = if is_odd {
        kernel_sin(y, rest)
    } else {
        kernel_cos(y, rest)
    };
    // The cosine of the second and third quarter is negative.
    let is_negative = (quarters + 1) & 2 == 2;
    if is_negative { -of_rest } else { of_rest }
}

/// Cosine of x + y from −π/4 to π/4, y being what is left of x.
#[inline(always)]
fn kernel_cos(x: f64, y: f64) -> f64 {
    const C: [f64; 6] = [
        4.16666666666666019037e-02,
        -1.38888888888741095749e-03,
        2.48015872894767294178e-05,
        -2.75573143513906633035e-07,
        2.08757232129817482790e-09,
        -1.13596475577881948265e-11,
    ];
    let z = x * x;
    let w = z * z;
    let r = z * (C[0] + z * (C[1] + z * C[2])) + w * w * (C[3] + z * (C[4] + z * C[5]));
    let half = 0.5 * z;
    let w = 1.0 - half;
    w + (((1.0 - w) - half) + (z * r - x * y))
}

/// Sine of the same.
#[inline(always)]
fn kernel_sin(x: f64, y: f64) -> f64 {
    const S: [f64; 6] = [
        -1.66666666666666324348e-01,
        8.33333333332248946124e-03,
        -1.98412698298579493134e-04,
        2.75573137070700676789e-06,
        -2.50507602534068634195e-08,
        1.58969099521155010221e-10,
    ];
    let z = x * x;
    let w = z * z;
    let r = S[1] + z * (S[2] + z * S[3]) + z * w * (S[4] + z * S[5]);
    let v = z * x;
    x - ((z * (0.5 * y - v * r) - y) - v * S[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_4, TAU};

    /// If a bit differed, a campaign would not give the rows that it gave before, nor the same on every host.
    #[test]
    fn normal_numbers_are_those_of_libm() {
        const COUNT: u32 = 1 << 16;
        let check = |radius: f64, angle: f64| {
            let mut normals = [0.0];
            fill(&[radius], &[angle], &mut normals);
            let expected = (-2.0 * libm::log(radius)).sqrt() * libm::cos(angle);
            assert_eq!(
                normals[0].to_bits(),
                expected.to_bits(),
                "{radius:e} {angle:e}"
            );
        };
        for i in 0..COUNT {
            // Two irrational rotations are spread evenly.
            let part = |step: f64| (f64::from(i) * step).fract();
            check(
                1.0 - part(0.618_033_988_749_894_8),
                part(0.414_213_562_373_095_1) * TAU,
            );
        }
        let unit = 2_f64.powi(-53);
        let radii = [
            unit,
            2.0 * unit,
            0.5,
            std::f64::consts::FRAC_1_SQRT_2,
            1.0 - unit,
            1.0,
        ];
        for radius in radii {
            for eighth in 0..=8 {
                let angle = f64::from(eighth) * FRAC_PI_4;
                let around = [
                    angle,
                    angle.next_down(),
                    angle.next_up(),
                    angle - 1e-7,
                    angle + 1e-7,
                ];
                for angle in around
                    .into_iter()
                    .filter(|angle| (0.0..=TAU).contains(angle))
                {
                    check(radius, angle);
                }
            }
        }
    }
}
