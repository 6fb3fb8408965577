//! The classic Runge-Kutta method of order 4 (Kutta 1901).
//!
//! Four evaluations per step. An undamped oscillation is stable up to hω = 2√2. Below that it loses (hω)⁶/72 of its energy
//! per step. It is the cheapest method for smooth machines whose fastest mode the step resolves.

use crate::rule::Rule;
use crate::{Equations, Facts, Needs, Refused, StepError};

/// Memory of RK4.
#[derive(Clone, Debug)]
pub(crate) struct Rk4 {
    slopes: [Vec<f64>; 4],
}

impl Rule for Rk4 {
    const FACTS: &'static Facts = &Facts {
        name: "RK4",
        order: 4,
        needs: Needs::Rates,
        keeps_energy: false,
        evaluations: 4,
    };

    fn new(equations: &dyn Equations, _: f64) -> Result<Self, Refused> {
        let zeros = || vec![0.0; equations.dimension()];
        Ok(Self {
            slopes: core::array::from_fn(|_| zeros()),
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
        let [k1, k2, k3, k4] = &mut self.slopes;
        equations.rates(t_s, y, k1);
        along(next, y, 0.5 * h, k1);
        equations.rates(t_s + 0.5 * h, next, k2);
        along(next, y, 0.5 * h, k2);
        equations.rates(t_s + 0.5 * h, next, k3);
        along(next, y, h, k3);
        equations.rates(t_s + h, next, k4);
        for (i, next) in next.iter_mut().enumerate() {
            *next = y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        Ok(())
    }
}

/// Computes `stage` = `y` + `h` `slope`.
fn along(stage: &mut [f64], y: &[f64], h: f64, slope: &[f64]) {
    for ((stage, y), slope) in stage.iter_mut().zip(y).zip(slope) {
        *stage = y + h * slope;
    }
}
