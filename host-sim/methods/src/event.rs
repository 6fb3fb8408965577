//! Events: a step that ends where something happens, such as a contact closing.
//!
//! A method's order holds where the rates are smooth. Where they jump, a step should end. [`step_to_crossing`] makes one step
//! and, if a quantity falls below 0 in it, ends it there instead. It finds the moment by bisection, with shorter steps from the
//! same start. So the state at the event is the method's own, not an interpolation between steps.
//!
//! The search prepares methods, which allocates memory; events are rare. A quantity that falls below 0 and rises again
//! within one step is not detected.

use crate::{Equations, NotMeasured, Scheme};

/// Number of halvings of the step: down to 2⁻⁵² of it, the resolution of `f64`.
const HALVINGS: u32 = 52;

/// Makes one step of `step_s`, or a shorter one up to the moment at which `quantity(y)` falls below 0. The quantity is not negative at
/// the start.
///
/// Returns the length of the step if it was shortened, `None` if the whole step was made. It ends at the last moment at which the
/// quantity is not negative, to within 2⁻⁵² of the step.
pub fn step_to_crossing(
    scheme: Scheme,
    equations: &dyn Equations,
    t_s: f64,
    step_s: f64,
    y: &mut [f64],
    quantity: impl Fn(&[f64]) -> f64,
) -> Result<Option<f64>, NotMeasured> {
    let start = y.to_vec();
    let after = |length_s: f64| -> Result<Vec<f64>, NotMeasured> {
        let mut end = start.clone();
        scheme
            .prepare(equations, length_s)?
            .step(equations, t_s, &mut end)?;
        Ok(end)
    };
    let end = after(step_s)?;
    if quantity(&end) >= 0.0 {
        y.copy_from_slice(&end);
        return Ok(None);
    }
    let (mut before_s, mut beyond_s) = (0.0, step_s);
    for _ in 0..HALVINGS {
        let middle_s = 0.5 * (before_s + beyond_s);
        let end = after(middle_s)?;
        if quantity(&end) < 0.0 {
            beyond_s = middle_s;
        } else {
            before_s = middle_s;
            y.copy_from_slice(&end);
        }
    }
    Ok(Some(before_s))
}
