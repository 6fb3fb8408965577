//! Duration of a call on the host, for candidates that run there.

use std::hint::black_box;
use std::time::Instant;

use cophase_core::functions;
use fixed::types::{I4F28, I16F16, U32F32};

use crate::chart::yardstick::Yardstick;

/// Tables of the emulator's candidates.
#[path = "../../../../../tests/emulator/functions/src/tables.rs"]
mod tables;

/// Candidate: a function from 64 random bits to its result.
type Call = fn(u64) -> u64;

/// Converts bits to a number from 1 to 2, where the duration does not depend on the value.
fn f32_of(bits: u64) -> f32 {
    f32::from_bits(0x3f80_0000 | (bits as u32 >> 9))
}

/// Converts bits to a number from −π to π.
fn radians(bits: u64) -> f32 {
    (f32_of(bits) - 1.5) * std::f32::consts::TAU
}

/// Converts bits to the two coordinates of a vector, −2 to 2 in I4F28.
fn vector(bits: u64) -> (i32, i32) {
    (bits as i32 >> 2, (bits >> 32) as i32 >> 2)
}

fn vector_f32(bits: u64) -> (f32, f32) {
    (f32_of(bits) - 1.5, f32_of(bits >> 32) - 1.5)
}

fn call(name: &str, format: &str) -> Option<Call> {
    Some(match (name, format) {
        ("cophase `root`", _) => |x| u64::from(functions::root(x).mantissa),
        ("cophase `isqrt`", _) => |x| u64::from(functions::isqrt(x | 1 << 63)),
        ("core `u64::isqrt`, normalised", _) => |x| (x << (x.leading_zeros() & !1)).isqrt(),
        ("core `u64::isqrt`", _) => u64::isqrt,
        ("core `u32::isqrt`", _) => |x| u64::from((x as u32).isqrt()),
        ("table of 193, straight lines", _) => |x| u64::from(tables::root(x as u32 | 1 << 30)),
        ("fixed `sqrt`", "I16F16") => {
            |x| I16F16::from_bits((x as u32 >> 1) as i32).sqrt().to_bits() as u64
        }
        ("fixed `sqrt`", "U32F32") => |x| U32F32::from_bits(x).sqrt().to_bits(),
        ("micromath `sqrt`", _) => |x| u64::from(micromath::F32(f32_of(x)).sqrt().0.to_bits()),
        ("libm `sqrtf`", _) => |x| u64::from(libm::sqrtf(f32_of(x)).to_bits()),
        ("libm `sqrt`", _) => |x| libm::sqrt(f64::from(f32_of(x))).to_bits(),
        ("cophase `sine_cosine`", _) => |x| functions::sine_cosine(x as u32).sine as u64,
        ("table of 1,025, nearest", _) => |x| tables::sine_cosine_nearest(x as u32).0 as u64,
        ("table of 1,025, straight lines", _) => |x| tables::sine_cosine_linear(x as u32).0 as u64,
        ("the same, products in 64 bits", _) if format.starts_with("turns") => {
            |x| tables::sine_cosine_linear_i64(x as u32).0 as u64
        }
        ("idsp `cossin`", _) => |x| idsp::cossin(x as i32).0 as u64,
        ("idsp `cos_sin` (CORDIC)", _) => |x| idsp::cos_sin(1 << 30, 0, x as i32).0 as u64,
        ("cordic `sin_cos`", _) => |x| {
            let (sine, cosine) = cordic::sin_cos(I4F28::from_num(radians(x)));
            (sine.to_bits() ^ cosine.to_bits()) as u64
        },
        ("micromath `sin_cos`", _) => |x| {
            let (sine, cosine) = micromath::F32(radians(x)).sin_cos();
            u64::from(sine.0.to_bits() ^ cosine.0.to_bits())
        },
        ("libm `sincosf`", _) => |x| {
            let (sine, cosine) = libm::sincosf(radians(x));
            u64::from(sine.to_bits() ^ cosine.to_bits())
        },
        ("table of 257, straight lines", _) => |bits| {
            let (y, x) = vector(bits);
            u64::from(tables::arctangent(y, x))
        },
        ("idsp `atan2`", _) => |bits| {
            let (y, x) = vector(bits);
            idsp::atan2(y, x) as u64
        },
        // The function of cordic overflows on steep vectors, and panics in builds that check for overflow.
        ("micromath `atan2`", _) => |bits| {
            let (y, x) = vector_f32(bits);
            u64::from(micromath::F32(y).atan2(micromath::F32(x)).0.to_bits())
        },
        ("libm `atan2f`", _) => |bits| {
            let (y, x) = vector_f32(bits);
            u64::from(libm::atan2f(y, x).to_bits())
        },
        _ => return None,
    })
}

const CALLS: u32 = 4096;
/// Number of repetitions, of which the shortest counts.
const TRIES: u32 = 5;

/// Returns the duration of a call, in sines; `None` for a candidate that does not run here.
pub fn sines_a_call(name: &str, format: &str, yardstick: Yardstick) -> Option<f64> {
    let call = call(name, format)?;
    let time = || {
        let began = Instant::now();
        let (mut bits, mut sum) = (1_u64, 0_u64);
        for _ in 0..CALLS {
            // Any bits are suitable. The multiplier is that of Knuth's MMIX.
            bits = bits
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum = sum.wrapping_add(call(black_box(bits)));
        }
        black_box(sum);
        yardstick.sines(began.elapsed()) / f64::from(CALLS)
    };
    Some((0..TRIES).map(|_| time()).fold(f64::INFINITY, f64::min))
}
