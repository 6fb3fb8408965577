//! Interface of what differs between methods: the computation of a step.

use core::fmt;

use crate::{Equations, Facts, Refused, StepError};

/// Computation of a step, of any length.
pub(crate) trait Rule: Clone + fmt::Debug + Sized + 'static {
    /// Properties of the method.
    const FACTS: &'static Facts;

    /// Allocates the memory for equations that have the required structure, and for a step that is finite and above 0.
    fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused>;

    /// Prepares coefficients that depend on the equations and the length of the step. The default has none.
    fn fit(&mut self, _: &dyn Equations, _t_s: f64, _h: f64) -> Result<(), StepError> {
        Ok(())
    }

    /// Writes the state at `t_s` + `h` into `next`, from the state `y` at `t_s`. The caller checks whether it is
    /// finite.
    fn step(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        h: f64,
        y: &[f64],
        next: &mut [f64],
    ) -> Result<(), StepError>;
}
