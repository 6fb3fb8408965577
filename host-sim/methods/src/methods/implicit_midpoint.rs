//! Implicit midpoint: y₁ = y + h f(t + h/2, (y + y₁)/2), the Gauss method of one stage.
//!
//! Order 2, stable at any step (A-stable), symplectic, and keeps quadratic invariants such as the energy of a linear
//! machine to rounding. It does not damp what the step does not resolve: at hω ≫ 1 a mode keeps ringing, with alternating
//! sign, at whatever amplitude it was given; where that matters take SDIRK4.
//!
//! The implicit equation is solved by [`newton`](crate::newton), with the tolerance stated there.

use crate::method::commit;
use crate::newton::Stage;
use crate::{Equations, Facts, Method, Needs, Refused, StepError, checked_step};

/// What is known of implicit midpoint.
pub const FACTS: Facts = Facts {
    name: "implicit midpoint",
    order: 2,
    needs: Needs::Rates,
    keeps_energy: true,
    evaluations: 2,
};

/// Implicit midpoint, made for a machine and a step.
#[derive(Clone, Debug)]
pub struct ImplicitMidpoint {
    step_s: f64,
    stage: Stage,
    half_move: Vec<f64>,
    next: Vec<f64>,
}

impl ImplicitMidpoint {
    /// Refuses a step that is not finite and above 0.
    pub fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused> {
        let step_s = checked_step(&FACTS, equations, step_s)?;
        let dimension = equations.dimension();
        Ok(Self {
            step_s,
            stage: Stage::new(dimension, 0.5 * step_s),
            half_move: vec![0.0; dimension],
            next: vec![0.0; dimension],
        })
    }
}

impl Method for ImplicitMidpoint {
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
        self.stage.begin(equations, t_s, y)?;
        self.half_move.fill(0.0);
        let middle_s = t_s + 0.5 * self.step_s;
        self.stage
            .solve(equations, middle_s, y, &mut self.half_move)?;
        for (i, next) in self.next.iter_mut().enumerate() {
            *next = y[i] + 2.0 * self.half_move[i];
        }
        commit(t_s, &self.next, y)
    }
}
