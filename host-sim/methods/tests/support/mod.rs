//! Helpers that several tests share.
#![allow(dead_code, reason = "each test takes what it needs")]

use cophase_methods::{Equations, Scheme, StepError, advance};

/// State at `end_s`, from `start` at 0, in `steps` equal steps.
pub fn play<const N: usize>(
    scheme: Scheme,
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    steps: u32,
) -> Result<[f64; N], StepError> {
    let mut method = scheme
        .prepare(equations, end_s / f64::from(steps))
        .expect("the test's own choice of method");
    let mut y = start;
    advance(method.as_mut(), equations, 0.0, steps, &mut y)?;
    Ok(y)
}

/// Largest difference of two states, component by component.
pub fn difference<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
