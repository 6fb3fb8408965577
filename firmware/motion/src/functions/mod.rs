//! Elementary functions of the tick, one a file.
//!
//! Each states its range and its error against f64, and its test measures that error. Everything here is integer
//! arithmetic, with the same bits on every machine. A Cortex-M0+ multiplies 32 by 32 bits into 32 in one cycle. Wider
//! products and all divisions are library calls there, which these functions avoid. `docs/functions.md` compares
//! their cost with that of other implementations.

mod divide;
mod inverse_root;
mod multiply;
mod normalise;
mod ratio;
mod reciprocal;
mod root;
mod sine;

pub use divide::{Divisor, quotient};
pub use inverse_root::inverse_root_of_one_minus;
pub use multiply::{multiply, multiply_high, multiply_long, multiply_q30};
pub use normalise::{normalised, upper_word};
pub use ratio::Ratio;
pub use reciprocal::reciprocal;
pub use root::{Root, isqrt, root};
pub use sine::{SineCosine, sine_cosine};

/// The number 1.0 in the format of sines, cosines and inverse roots: signed, 30 fraction bits.
pub const ONE_Q30: i32 = 1 << 30;
