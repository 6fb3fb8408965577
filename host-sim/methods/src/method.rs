//! What every method is: facts that can be relied on, and a step.

use core::fmt;

use crate::{Equations, StepError};

/// A method, made for one machine and one length of step, that moves a state on by that step.
///
/// Stepping allocates nothing and depends on nothing but its arguments: same input, same bits.
pub trait Method: fmt::Debug {
    /// What is known of the method.
    fn facts(&self) -> &'static Facts;

    /// The step h, s.
    fn step_s(&self) -> f64;

    /// Replaces `y`, the state at `t_s`, by the state one step later.
    ///
    /// `equations` must be those the method was made for; panics if their dimension differs, or that of `y`.
    /// On an error `y` is as it was.
    fn step(&mut self, equations: &dyn Equations, t_s: f64, y: &mut [f64])
    -> Result<(), StepError>;
}

/// What is known of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// Name, as in a sentence.
    pub name: &'static str,
    /// Order p: over a fixed time, on smooth equations, the error goes as h^p. Where rates jump (a contact, a kink in a
    /// law) it falls to 1 for whatever method, unless a step ends at the jump.
    pub order: u32,
    /// What the equations must offer.
    pub needs: Needs,
    /// Whether it keeps the energy of an undamped machine for ever, up to a ripple, without gaining or losing.
    pub keeps_energy: bool,
    /// Evaluations of the rates a step; for an implicit method, as many as its iterations need on a linear machine.
    pub evaluations: u32,
}

/// What a method needs of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing but rates.
    Rates,
    /// Positions and velocities as the two halves of the state ([`Equations::is_second_order`]).
    SecondOrder,
    /// A constant matrix ([`Equations::linear`]).
    Linear,
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rates => "rates",
            Self::SecondOrder => "positions and velocities as the two halves of the state",
            Self::Linear => "a linear system with a constant matrix",
        })
    }
}

/// Makes `steps` steps from `t0_s` on. The time of each is t0 + i h, not a sum that gathers rounding.
pub fn advance(
    method: &mut dyn Method,
    equations: &dyn Equations,
    t0_s: f64,
    steps: u32,
    y: &mut [f64],
) -> Result<(), StepError> {
    for i in 0..steps {
        method.step(equations, t0_s + f64::from(i) * method.step_s(), y)?;
    }
    Ok(())
}

/// Takes `new` over into `y` if all of it is finite.
pub(crate) fn commit(t_s: f64, new: &[f64], y: &mut [f64]) -> Result<(), StepError> {
    if let Some(component) = new.iter().position(|value| !value.is_finite()) {
        return Err(StepError::NotFinite { t_s, component });
    }
    y.copy_from_slice(new);
    Ok(())
}
