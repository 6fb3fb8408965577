//! Explicit (forward) Euler: y₁ = y + h f(t, y).
//!
//! Order 1. It gives energy to every oscillation: an undamped one grows by √(1 + (hω)²) a step whatever the step,
//! a damped one is stable up to hω = 2ζ (for ζ ≤ 1; above, up to 2 / (ζ + √(ζ² − 1))). Here as the one to beat, and
//! because controllers are full of it.

use crate::method::commit;
use crate::{Equations, Facts, Method, Needs, Refused, StepError, checked_step};

/// What is known of explicit Euler.
pub const FACTS: Facts = Facts {
    name: "explicit Euler",
    order: 1,
    needs: Needs::Rates,
    keeps_energy: false,
    evaluations: 1,
};

/// Explicit Euler, made for a machine and a step.
#[derive(Clone, Debug)]
pub struct ExplicitEuler {
    step_s: f64,
    next: Vec<f64>,
}

impl ExplicitEuler {
    /// Refuses a step that is not finite and above 0.
    pub fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused> {
        Ok(Self {
            step_s: checked_step(&FACTS, equations, step_s)?,
            next: vec![0.0; equations.dimension()],
        })
    }
}

impl Method for ExplicitEuler {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn step_s(&self) -> f64 {
        self.step_s
    }

    fn step(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        y: &mut [f64],
    ) -> Result<(), StepError> {
        equations.rates(t_s, y, &mut self.next);
        for (next, y) in self.next.iter_mut().zip(&*y) {
            *next = y + self.step_s * *next;
        }
        commit(t_s, &self.next, y)
    }
}
