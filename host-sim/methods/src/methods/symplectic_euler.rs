//! Symplectic (semi-implicit) Euler: v₁ = v + h a(t, q, v), then q₁ = q + h v₁.
//!
//! Order 1, one evaluation per step. Without damping, it conserves an energy that differs from the true one by a ripple of the
//! order of hω/2, and is stable up to hω = 2. Damping uses the velocity before the step, which reduces the
//! stability: the limit is hω = 2 (√(1 + ζ²) − ζ), from 1 − trace + det = 0 at the eigenvalue −1 of
//! [[1 − x², x (1 − 2ζx)], [−x, 1 − 2ζx]], x = hω. At ζ = 0.34 that is 1.43.

use crate::rule::Rule;
use crate::{Equations, Facts, Needs, Refused, StepError};

/// Memory of symplectic Euler.
#[derive(Clone, Debug)]
pub(crate) struct SymplecticEuler;

impl Rule for SymplecticEuler {
    const FACTS: &'static Facts = &Facts {
        name: "symplectic Euler",
        order: 1,
        needs: Needs::SecondOrder,
        keeps_energy: true,
        evaluations: 1,
    };

    fn new(_: &dyn Equations, _: f64) -> Result<Self, Refused> {
        Ok(Self)
    }

    fn step(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        h: f64,
        y: &[f64],
        next: &mut [f64],
    ) -> Result<(), StepError> {
        equations.rates(t_s, y, next);
        let half = y.len() / 2;
        let (q, v) = y.split_at(half);
        let (next_q, next_v) = next.split_at_mut(half);
        for i in 0..half {
            next_v[i] = v[i] + h * next_v[i];
            next_q[i] = q[i] + h * next_v[i];
        }
        Ok(())
    }
}
