//! Symplectic (semi-implicit) Euler: v₁ = v + h a(t, q, v), then q₁ = q + h v₁.
//!
//! Order 1, one evaluation a step. Without damping it keeps an energy that differs from the true one by a ripple of the
//! order of hω/2, for ever, and is stable up to hω = 2. Damping enters with the velocity before the step; that costs
//! stability: the limit is hω = 2 (√(1 + ζ²) − ζ), from 1 − trace + det = 0 at the eigenvalue −1 of
//! [[1 − x², x (1 − 2ζx)], [−x, 1 − 2ζx]], x = hω. At ζ = 0.34 that is 1.43.

use crate::method::commit;
use crate::{Equations, Facts, Method, Needs, Refused, StepError, checked_step};

/// What is known of symplectic Euler.
pub const FACTS: Facts = Facts {
    name: "symplectic Euler",
    order: 1,
    needs: Needs::SecondOrder,
    keeps_energy: true,
    evaluations: 1,
};

/// Symplectic Euler, made for a machine and a step.
#[derive(Clone, Debug)]
pub struct SymplecticEuler {
    step_s: f64,
    next: Vec<f64>,
}

impl SymplecticEuler {
    /// Refuses equations that are not of second order, and a step that is not finite and above 0.
    pub fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused> {
        Ok(Self {
            step_s: checked_step(&FACTS, equations, step_s)?,
            next: vec![0.0; equations.dimension()],
        })
    }
}

impl Method for SymplecticEuler {
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
        let h = self.step_s;
        equations.rates(t_s, y, &mut self.next);
        let half = y.len() / 2;
        let (q, v) = y.split_at(half);
        let (next_q, next_v) = self.next.split_at_mut(half);
        for i in 0..half {
            next_v[i] = v[i] + h * next_v[i];
            next_q[i] = q[i] + h * next_v[i];
        }
        commit(t_s, &self.next, y)
    }
}
