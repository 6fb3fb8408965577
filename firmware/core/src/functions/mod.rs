//! The elementary functions that the tick needs, one a file.
//!
//! Each states its range and its error against f64, and its test measures that error. Everything
//! here is integer arithmetic: the same bits on every machine.

mod inverse_root;
mod root;
mod sine;

pub use inverse_root::inverse_root_of_one_minus;
pub use root::{Root, root};
pub use sine::{SineCosine, sine_cosine};

/// 1.0 in the format of sines, cosines and inverse roots: signed, 30 fraction bits.
pub const ONE_Q30: i32 = 1 << 30;

/// Product of two numbers with 30 fraction bits, rounded down.
///
/// The result must lie within ±2: the callers' operands are sines, cosines, and factors from 0.8
/// to 1.25.
pub const fn multiply_q30(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 30) as i32
}
