//! Design methods: from a requirement to the size of a machine.
//!
//! Each machine has its own method. If a method has no solution, its error names the responsible
//! parameter.

pub mod crank_rocker;
pub mod five_bar;
pub mod flywheel;
mod page;
pub mod platform;
mod range;
mod scene;
pub mod screen;

pub use range::{OutOfRange, Range};
pub use scene::NotRunnable;
