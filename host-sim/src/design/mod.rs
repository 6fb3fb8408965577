//! Design methods: from a requirement to the size of a machine.
//!
//! Each machine has its own method. If a method has no solution, its error names the responsible
//! parameter.

pub mod coupling;
pub mod crank_rocker;
mod digits;
pub mod five_bar;
pub mod flywheel;
mod page;
pub mod platform;
mod range;
mod scene;
pub mod screen;

pub(crate) use digits::plain;
pub use range::{OutOfRange, Range};
pub use scene::NotRunnable;

/// Standard gravity, m/s².
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;
