//! Helpers that several tests share.

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
