//! Velocity Verlet, with a predictor for forces that depend on velocity:
//!
//! ```text
//! a₀ = a(t, q, v)
//! q₁ = q + h v + h²/2 a₀
//! v* = v + h a₀
//! v₁ = v + h/2 (a₀ + a(t + h, q₁, v*))
//! ```
//!
//! Order 2, also with damping: the error of v* is O(h²), and the factor h/2 makes it O(h³) per step in v₁. (With the half-step
//! velocity in place of v*, as in many texts, damping lowers the order to 1.) Without damping, v* is not used. The method is then
//! plain Verlet: symplectic, and stable up to hω = 2. With damping, each step evaluates both accelerations.

use crate::rule::Rule;
use crate::{Equations, Facts, Needs, Refused, StepError};

/// Memory of velocity Verlet.
#[derive(Clone, Debug)]
pub(crate) struct VelocityVerlet {
    before: Vec<f64>,
    after: Vec<f64>,
}

impl Rule for VelocityVerlet {
    const FACTS: &'static Facts = &Facts {
        name: "velocity Verlet",
        order: 2,
        needs: Needs::SecondOrder,
        keeps_energy: true,
        evaluations: 2,
    };

    fn new(equations: &dyn Equations, _: f64) -> Result<Self, Refused> {
        let zeros = vec![0.0; equations.dimension()];
        Ok(Self {
            before: zeros.clone(),
            after: zeros,
        })
    }

    fn step(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        h: f64,
        y: &[f64],
        next: &mut [f64],
    ) -> Result<(), StepError> {
        let half = y.len() / 2;
        equations.rates(t_s, y, &mut self.before);
        for i in 0..half {
            let (v, a) = (y[half + i], self.before[half + i]);
            next[i] = y[i] + h * (v + 0.5 * h * a);
            next[half + i] = v + h * a;
        }
        equations.rates(t_s + h, next, &mut self.after);
        for i in half..y.len() {
            next[i] = y[i] + 0.5 * h * (self.before[i] + self.after[i]);
        }
        Ok(())
    }
}
