//! Sine and cosine together. Angles in turns are `u32`, 2³² to the turn; others are in radians.

use crate::{pair, tables};
use cophase_core::functions;
use fixed::types::I4F28;

#[unsafe(no_mangle)]
extern "C" fn sine_cophase(angle: u32) -> u64 {
    let turn = functions::sine_cosine(angle);
    pair(turn.sine as u32, turn.cosine as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_table_nearest(angle: u32) -> u64 {
    let (sine, cosine) = tables::sine_cosine_nearest(angle);
    pair(sine as u32, cosine as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_table_linear(angle: u32) -> u64 {
    let (sine, cosine) = tables::sine_cosine_linear(angle);
    pair(sine as u32, cosine as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_table_linear_i64(angle: u32) -> u64 {
    let (sine, cosine) = tables::sine_cosine_linear_i64(angle);
    pair(sine as u32, cosine as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_idsp_table(angle: u32) -> u64 {
    let (cosine, sine) = idsp::cossin(angle as i32);
    pair(sine as u32, cosine as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_idsp_cordic(angle: u32) -> u64 {
    // A start vector of 1/gain makes the result a unit vector. It is slightly shorter, because ±1
    // must not overflow.
    const START: i32 = (2147483000.0 / idsp::CORDIC_CIRCULAR_GAIN) as i32;
    let (cosine, sine) = idsp::cos_sin(START, 0, angle as i32);
    pair(sine as u32, cosine as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_cordic_i4f28(radians: i32) -> u64 {
    let (sine, cosine) = cordic::sin_cos(I4F28::from_bits(radians));
    pair(sine.to_bits() as u32, cosine.to_bits() as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_fixed_analytics_i4f28(radians: i32) -> u64 {
    let (sine, cosine) = fixed_analytics::sin_cos(I4F28::from_bits(radians));
    pair(sine.to_bits() as u32, cosine.to_bits() as u32)
}

#[unsafe(no_mangle)]
extern "C" fn sine_micromath_f32(radians: u32) -> u64 {
    let (sine, cosine) = micromath::F32::from_bits(radians).sin_cos();
    pair(sine.0.to_bits(), cosine.0.to_bits())
}

#[unsafe(no_mangle)]
extern "C" fn sine_libm_f32(radians: u32) -> u64 {
    let (sine, cosine) = libm::sincosf(f32::from_bits(radians));
    pair(sine.to_bits(), cosine.to_bits())
}
