//! Velocity Verlet, with a predictor for forces that depend on velocity:
//!
//! ```text
//! a₀ = a(t, q, v)
//! q₁ = q + h v + h²/2 a₀
//! v* = v + h a₀
//! v₁ = v + h/2 (a₀ + a(t + h, q₁, v*))
//! ```
//!
//! Order 2, kept with damping: v* is off by O(h²), which enters v₁ through h/2, as O(h³) a step. (With the half-step
//! velocity in place of v*, as it is often written, damping lowers the order to 1.) Without damping v* is not used, it is
//! plain Verlet, symplectic, stable up to hω = 2. With damping both accelerations are new in each step: two evaluations.

use crate::method::commit;
use crate::{Equations, Facts, Method, Needs, Refused, StepError, checked_step};

/// What is known of velocity Verlet.
pub const FACTS: Facts = Facts {
    name: "velocity Verlet",
    order: 2,
    needs: Needs::SecondOrder,
    keeps_energy: true,
    evaluations: 2,
};

/// Velocity Verlet, made for a machine and a step.
#[derive(Clone, Debug)]
pub struct VelocityVerlet {
    step_s: f64,
    before: Vec<f64>,
    after: Vec<f64>,
    next: Vec<f64>,
}

impl VelocityVerlet {
    /// Refuses equations that are not of second order, and a step that is not finite and above 0.
    pub fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused> {
        let zeros = vec![0.0; equations.dimension()];
        Ok(Self {
            step_s: checked_step(&FACTS, equations, step_s)?,
            before: zeros.clone(),
            after: zeros.clone(),
            next: zeros,
        })
    }
}

impl Method for VelocityVerlet {
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
        let half = y.len() / 2;
        equations.rates(t_s, y, &mut self.before);
        for i in 0..half {
            let (v, a) = (y[half + i], self.before[half + i]);
            self.next[i] = y[i] + h * (v + 0.5 * h * a);
            self.next[half + i] = v + h * a;
        }
        equations.rates(t_s + h, &self.next, &mut self.after);
        for i in 0..half {
            let i = half + i;
            self.next[i] = y[i] + 0.5 * h * (self.before[i] + self.after[i]);
        }
        commit(t_s, &self.next, y)
    }
}
