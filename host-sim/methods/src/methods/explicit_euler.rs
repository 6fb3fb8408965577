//! Explicit (forward) Euler: y₁ = y + h f(t, y).
//!
//! Order 1. It adds energy to every oscillation: an undamped one grows by √(1 + (hω)²) per step at any step length. A damped
//! one is stable up to hω = 2ζ (for ζ ≤ 1; above, up to 2 / (ζ + √(ζ² − 1))). It is here for comparison, as controllers
//! often use it.

use crate::rule::Rule;
use crate::{Equations, Facts, Needs, Refused, StepError};

/// Memory of explicit Euler.
#[derive(Clone, Debug)]
pub(crate) struct ExplicitEuler;

impl Rule for ExplicitEuler {
    const FACTS: &'static Facts = &Facts {
        name: "explicit Euler",
        order: 1,
        needs: Needs::Rates,
        keeps_energy: false,
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
        for (next, y) in next.iter_mut().zip(y) {
            *next = y + h * *next;
        }
        Ok(())
    }
}
