//! SDIRK4: a singly diagonally implicit Runge-Kutta method of five stages and order 4, L-stable and stiffly accurate.
//!
//! It is for machines with modes far faster than the step, and for equations with very different time constants. Modes that the
//! step does not resolve decay at once (L-stable). The last stage is the end of the step, so algebraic conditions hold exactly
//! there (stiffly accurate). It damps a resolved oscillation a little, too: the loss of energy is proportional to (hω)⁶.
//!
//! Coefficients: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., 1996, section IV.6,
//! formula (6.16), γ = 1/4. All five stages share the matrix I − hγJ, factored once a step.
//!
//! The implicit equations are solved by [`newton`](crate::newton), with the tolerance stated there.

use crate::newton::Stage;
use crate::rule::Rule;
use crate::{Equations, Facts, Needs, Refused, StepError};

const STAGES: usize = 5;

/// Diagonal of A.
const GAMMA: f64 = 0.25;

/// Time of each stage, as a part of the step.
const C: [f64; STAGES] = [0.25, 0.75, 11.0 / 20.0, 0.5, 1.0];

/// Entries of A below its diagonal. The last row also has the weights.
const A: [[f64; STAGES - 1]; STAGES] = [
    [0.0, 0.0, 0.0, 0.0],
    [0.5, 0.0, 0.0, 0.0],
    [17.0 / 50.0, -1.0 / 25.0, 0.0, 0.0],
    [371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0, 0.0],
    [25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0],
];

/// Memory of SDIRK4.
#[derive(Clone, Debug)]
pub(crate) struct Sdirk4 {
    stage: Stage,
    /// hγ k of each stage.
    moves: [Vec<f64>; STAGES],
}

impl Rule for Sdirk4 {
    const FACTS: &'static Facts = &Facts {
        name: "SDIRK4",
        order: 4,
        needs: Needs::Rates,
        keeps_energy: false,
        evaluations: 10,
    };

    fn new(equations: &dyn Equations, _: f64) -> Result<Self, Refused> {
        let dimension = equations.dimension();
        Ok(Self {
            stage: Stage::new(dimension),
            moves: core::array::from_fn(|_| vec![0.0; dimension]),
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
        self.stage.begin(equations, t_s, GAMMA * h, y)?;
        for i in 0..STAGES {
            let (earlier, rest) = self.moves.split_at_mut(i);
            let this = &mut rest[0];
            // `next` holds the start of the stage, until the last stage is the next state.
            next.copy_from_slice(y);
            for (a, earlier) in A[i].iter().zip(&*earlier) {
                for (base, earlier) in next.iter_mut().zip(earlier) {
                    *base += a / GAMMA * earlier;
                }
            }
            // First guess: the rates of the stage before.
            match earlier.last() {
                Some(before) => this.copy_from_slice(before),
                None => this.fill(0.0),
            }
            self.stage.solve(equations, t_s + C[i] * h, next, this)?;
        }
        for (next, last) in next.iter_mut().zip(&self.moves[STAGES - 1]) {
            *next += last;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns A with its diagonal.
    fn a(i: usize, j: usize) -> f64 {
        if i == j {
            GAMMA
        } else {
            A[i].get(j).copied().unwrap_or(0.0)
        }
    }

    /// If this fails, a coefficient is wrong: one of the eight conditions for order 4 does not hold (Hairer, Nørsett, Wanner,
    /// *Solving ODEs I*, table II.2.1), or the sum of a row is not the time of its stage. The bound is that of rounding: 1e-13,
    /// for sums of terms up to 10.
    #[test]
    fn coefficients_fulfil_the_order_conditions() {
        let b = |i| a(STAGES - 1, i);
        let sum = |term: &dyn Fn(usize) -> f64| (0..STAGES).map(term).sum::<f64>();
        for (i, c) in C.into_iter().enumerate() {
            assert!((sum(&|j| a(i, j)) - c).abs() < 1e-13, "row {i}");
        }
        let through = |i: usize, f: &dyn Fn(usize) -> f64| sum(&|j| a(i, j) * f(j));
        let conditions = [
            (sum(&b), 1.0),
            (sum(&|i| b(i) * C[i]), 1.0 / 2.0),
            (sum(&|i| b(i) * C[i].powi(2)), 1.0 / 3.0),
            (sum(&|i| b(i) * through(i, &|j| C[j])), 1.0 / 6.0),
            (sum(&|i| b(i) * C[i].powi(3)), 1.0 / 4.0),
            (sum(&|i| b(i) * C[i] * through(i, &|j| C[j])), 1.0 / 8.0),
            (sum(&|i| b(i) * through(i, &|j| C[j].powi(2))), 1.0 / 12.0),
            (
                sum(&|i| b(i) * through(i, &|j| through(j, &|k| C[k]))),
                1.0 / 24.0,
            ),
        ];
        for (number, (is, must)) in conditions.into_iter().enumerate() {
            assert!(
                (is - must).abs() < 1e-13,
                "condition {number}: {is} for {must}"
            );
        }
    }
}
