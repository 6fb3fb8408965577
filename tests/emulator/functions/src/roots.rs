//! Square roots. The normalised ones give 32 significant bits for any size of the argument.

use crate::{pair, tables};
use cophase_core::functions;
use fixed::types::{I16F16, U32F32};
use fixed_sqrt::FastSqrt;

#[unsafe(no_mangle)]
extern "C" fn root_cophase(x: u64) -> u64 {
    let root = functions::root(x);
    pair(root.mantissa, root.shift)
}

#[unsafe(no_mangle)]
extern "C" fn root_cophase_isqrt(x: u64) -> u32 {
    functions::isqrt(x)
}

/// Variant of `cophase_core::functions::root` with core's root behind it.
#[unsafe(no_mangle)]
extern "C" fn root_core_normalised(x: u64) -> u64 {
    if x == 0 {
        return 0;
    }
    let shift = x.leading_zeros() / 2;
    pair((x << (2 * shift)).isqrt() as u32, shift)
}

#[unsafe(no_mangle)]
extern "C" fn root_core_u64(x: u64) -> u32 {
    x.isqrt() as u32
}

#[unsafe(no_mangle)]
extern "C" fn root_core_u32(x: u32) -> u32 {
    x.isqrt()
}

#[unsafe(no_mangle)]
extern "C" fn root_table(x: u32) -> u32 {
    tables::root(x)
}

#[unsafe(no_mangle)]
extern "C" fn root_fixed_i16f16(x: i32) -> i32 {
    I16F16::from_bits(x).sqrt().to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn root_fixed_u32f32(x: u64) -> u64 {
    U32F32::from_bits(x).sqrt().to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn root_fixed_sqrt_i16f16(x: i32) -> i32 {
    I16F16::from_bits(x).fast_sqrt().to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn root_fixed_analytics_i16f16(x: i32) -> i32 {
    fixed_analytics::sqrt(I16F16::from_bits(x))
        .unwrap_or(I16F16::ZERO)
        .to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn root_cordic_i16f16(x: i32) -> i32 {
    cordic::sqrt(I16F16::from_bits(x)).to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn root_micromath_f32(x: u32) -> u32 {
    micromath::F32::from_bits(x).sqrt().0.to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn root_libm_f32(x: u32) -> u32 {
    libm::sqrtf(f32::from_bits(x)).to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn root_libm_f64(x: u64) -> u64 {
    libm::sqrt(f64::from_bits(x)).to_bits()
}
