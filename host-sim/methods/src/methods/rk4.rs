//! The classic Runge-Kutta method of order 4 (Kutta 1901).
//!
//! Four evaluations a step. An undamped oscillation is stable up to hω = 2√2, and loses (hω)⁶/72 of its energy a step
//! below that. The best value for smooth machines whose fastest mode the step resolves.

use crate::method::commit;
use crate::{Equations, Facts, Method, Needs, Refused, StepError, checked_step};

/// What is known of RK4.
pub const FACTS: Facts = Facts {
    name: "RK4",
    order: 4,
    needs: Needs::Rates,
    keeps_energy: false,
    evaluations: 4,
};

/// RK4, made for a machine and a step.
#[derive(Clone, Debug)]
pub struct Rk4 {
    step_s: f64,
    slopes: [Vec<f64>; 4],
    stage: Vec<f64>,
}

impl Rk4 {
    /// Refuses a step that is not finite and above 0.
    pub fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused> {
        let zeros = || vec![0.0; equations.dimension()];
        Ok(Self {
            step_s: checked_step(&FACTS, equations, step_s)?,
            slopes: core::array::from_fn(|_| zeros()),
            stage: zeros(),
        })
    }
}

impl Method for Rk4 {
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
        let [k1, k2, k3, k4] = &mut self.slopes;
        equations.rates(t_s, y, k1);
        along(&mut self.stage, y, 0.5 * h, k1);
        equations.rates(t_s + 0.5 * h, &self.stage, k2);
        along(&mut self.stage, y, 0.5 * h, k2);
        equations.rates(t_s + 0.5 * h, &self.stage, k3);
        along(&mut self.stage, y, h, k3);
        equations.rates(t_s + h, &self.stage, k4);
        for (i, next) in self.stage.iter_mut().enumerate() {
            *next = y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        commit(t_s, &self.stage, y)
    }
}

/// `stage` = `y` + `h` `slope`.
fn along(stage: &mut [f64], y: &[f64], h: f64, slope: &[f64]) {
    for ((stage, y), slope) in stage.iter_mut().zip(y).zip(slope) {
        *stage = y + h * slope;
    }
}
