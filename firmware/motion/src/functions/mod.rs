//! The elementary functions that the tick needs, one a file.
//!
//! Each states its range and its error against f64, and its test measures that error. Everything
//! here is integer arithmetic: the same bits on every machine. The board multiplies 32 by 32 bits to
//! 32 in a cycle; wider products and all divisions are calls, which these functions do without. What
//! each costs there, beside others' ways, is measured in `docs/functions.md`.

mod divide;
mod inverse_root;
mod multiply;
mod normalise;
mod reciprocal;
mod root;
mod sine;

pub use divide::Divisor;
pub use inverse_root::inverse_root_of_one_minus;
pub use multiply::{multiply, multiply_high, multiply_long, multiply_q30};
pub use normalise::{normalised, upper_word};
pub use reciprocal::reciprocal;
pub use root::{Root, isqrt, root};
pub use sine::{SineCosine, sine_cosine};

/// 1.0 in the format of sines, cosines and inverse roots: signed, 30 fraction bits.
pub const ONE_Q30: i32 = 1 << 30;
