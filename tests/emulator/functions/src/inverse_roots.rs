//! 1 / sqrt(1 − x), for x from 0 to 0.36, and the product of two numbers with 30 fraction bits that it uses.

use cophase_core::functions;

#[unsafe(no_mangle)]
extern "C" fn inverse_root_cophase(x: i32) -> i32 {
    functions::inverse_root_of_one_minus(x)
}

/// The binomial series and two Newton steps, its products in 64 bits.
#[unsafe(no_mangle)]
extern "C" fn inverse_root_newton_i64(x: i32) -> i32 {
    const ONE: i32 = functions::ONE_Q30;
    let cubic = product_i64(x, ONE / 16 * 5);
    let square = product_i64(x, ONE / 8 * 3 + cubic);
    let mut y = ONE + product_i64(x, ONE / 2 + square);
    for _ in 0..2 {
        let residue = product_i64(ONE - x, product_i64(y, y));
        y = product_i64(y, ONE + (ONE - residue) / 2);
    }
    y
}

#[unsafe(no_mangle)]
extern "C" fn inverse_root_micromath_f32(x: u32) -> u32 {
    micromath::F32(1.0 - f32::from_bits(x))
        .invsqrt()
        .0
        .to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn inverse_root_libm_f32(x: u32) -> u32 {
    (1.0 / libm::sqrtf(1.0 - f32::from_bits(x))).to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn product_cophase(a: i32, b: i32) -> i32 {
    functions::multiply_q30(a, b)
}

#[unsafe(no_mangle)]
extern "C" fn product_i64(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 30) as i32
}
