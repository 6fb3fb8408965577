//! Arctangent of two arguments, y first. Vectors are integers of any length, I4F28 or floats; angles come out in turns, 2³²
//! to the turn, or in radians.

use crate::tables;
use fixed::types::I4F28;

#[unsafe(no_mangle)]
extern "C" fn arctangent_table(y: i32, x: i32) -> u32 {
    tables::arctangent(y, x)
}

#[unsafe(no_mangle)]
extern "C" fn arctangent_idsp(y: i32, x: i32) -> i32 {
    idsp::atan2(y, x)
}

#[unsafe(no_mangle)]
extern "C" fn arctangent_cordic_i4f28(y: i32, x: i32) -> i32 {
    cordic::atan2(I4F28::from_bits(y), I4F28::from_bits(x)).to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn arctangent_fixed_analytics_i4f28(y: i32, x: i32) -> i32 {
    fixed_analytics::atan2(I4F28::from_bits(y), I4F28::from_bits(x)).to_bits()
}

/// The function that the controller's telemetry uses for the direction of a tilt.
#[unsafe(no_mangle)]
extern "C" fn arctangent_micromath_f32(y: u32, x: u32) -> u32 {
    let y = micromath::F32::from_bits(y);
    y.atan2(micromath::F32::from_bits(x)).0.to_bits()
}

#[unsafe(no_mangle)]
extern "C" fn arctangent_libm_f32(y: u32, x: u32) -> u32 {
    libm::atan2f(f32::from_bits(y), f32::from_bits(x)).to_bits()
}
