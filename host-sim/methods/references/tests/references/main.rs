//! Tests of the methods on problems with reference solutions from library solvers.
//!
//!     cargo test -p cophase-references -- --nocapture

mod chain;
mod exponential;
mod order;
mod published;
#[path = "../../../tests/support/mod.rs"]
mod support;

/// Largest difference of two states, component by component.
fn difference<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
