//! Implicit midpoint: y₁ = y + h f(t + h/2, (y + y₁)/2), the Gauss method of one stage.
//!
//! Order 2, stable at any step (A-stable), and symplectic. It conserves quadratic invariants, such as the energy of a linear
//! machine, to rounding. It does not damp modes that the step does not resolve: at hω ≫ 1 a mode keeps its amplitude, with
//! alternating sign. Where that matters, use SDIRK4.
//!
//! The implicit equation is solved by [`newton`](crate::newton), with the tolerance stated there.

use crate::newton::Stage;
use crate::rule::Rule;
use crate::{Equations, Facts, Needs, Refused, StepError};

/// Memory of the implicit midpoint method.
#[derive(Clone, Debug)]
pub(crate) struct ImplicitMidpoint {
    stage: Stage,
    half_move: Vec<f64>,
}

impl Rule for ImplicitMidpoint {
    const FACTS: &'static Facts = &Facts {
        name: "implicit midpoint",
        order: 2,
        needs: Needs::Rates,
        keeps_energy: true,
        evaluations: 2,
    };

    fn new(equations: &dyn Equations, _: f64) -> Result<Self, Refused> {
        let dimension = equations.dimension();
        Ok(Self {
            stage: Stage::new(dimension),
            half_move: vec![0.0; dimension],
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
        self.stage.begin(equations, t_s, 0.5 * h, y)?;
        self.half_move.fill(0.0);
        let middle_s = t_s + 0.5 * h;
        self.stage
            .solve(equations, middle_s, y, &mut self.half_move)?;
        for (i, next) in next.iter_mut().enumerate() {
            *next = y[i] + 2.0 * self.half_move[i];
        }
        Ok(())
    }
}
