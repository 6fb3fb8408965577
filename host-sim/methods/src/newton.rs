//! The implicit equation of a stage, z = hγ f(t, base + z), solved by Newton's method.
//!
//! Each iteration solves (I − hγJ) Δ = hγ f(t, base + z) − z and moves z by Δ. The Jacobian J is taken once at the start of
//! the step, and I − hγJ factored once, for all stages and iterations: on smooth equations that converges in a few. If it
//! has not after [`CHORD_LIMIT`] iterations, it starts over with a Jacobian of its own at each, up to
//! [`NEWTON_LIMIT`].
//!
//! **Damping.** Where a rate levels off, as dry friction does beside standstill, whole corrections jump from one level side to
//! the other without end. So in these later iterations a correction is halved, up to [`HALVINGS`] times, until the next one,
//! by the same Jacobian, would be shorter: the natural monotonicity test of P. Deuflhard, *Newton Methods for Nonlinear
//! Problems*, 2004, section 3.3.
//!
//! **Tolerance.** The iteration ends when no component is moved by more than [`TOLERANCE`] of its own size (|y| + |z|)
//! plus what rounding alone can move it: [`ROUNDINGS`] ε of hγ Σ |J_ij| |y_j|, the sum that its rate is computed from. (And what has decayed to below 2e-308, where `f64` loses its digits, may move by that.) The
//! correction is still made, so what is left is smaller by the factor at which the iteration converges. If the iteration
//! limit is reached instead, that is an error.

use nalgebra::{DMatrix, DVector};

use crate::equations::Differences;
use crate::factors::Factors;
use crate::{Equations, StepError};

/// Correction, relative to the component, at which an iteration ends.
pub const TOLERANCE: f64 = 1e-12;

/// Rounding errors of one rate that are granted to it, as multiples of ε and of the terms that it is a sum of.
pub const ROUNDINGS: f64 = 16.0;

/// Most iterations with the Jacobian from the start of the step.
pub const CHORD_LIMIT: u32 = 10;

/// Most iterations, after those, with a Jacobian of their own.
pub const NEWTON_LIMIT: u32 = 50;

/// Most halvings of one correction.
pub const HALVINGS: u32 = 12;

/// Solves the stages of one method, at one hγ.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    h_gamma_s: f64,
    /// Start of the step, for errors.
    from_s: f64,
    differences: Differences,
    jacobian: DMatrix<f64>,
    factors: Factors,
    at: Vec<f64>,
    rates: Vec<f64>,
    guess: Vec<f64>,
    correction: DVector<f64>,
    /// Where a damped correction starts, and the whole of it.
    start: Vec<f64>,
    whole: DVector<f64>,
    /// Tolerance of each component's correction.
    allowed: Vec<f64>,
    /// What rounding can move each component by.
    rounding: Vec<f64>,
}

impl Stage {
    pub fn new(dimension: usize, h_gamma_s: f64) -> Self {
        let zeros = || vec![0.0; dimension];
        Self {
            h_gamma_s,
            from_s: 0.0,
            differences: Differences::new(dimension),
            jacobian: DMatrix::zeros(dimension, dimension),
            factors: Factors::new(dimension),
            at: zeros(),
            rates: zeros(),
            guess: zeros(),
            correction: DVector::zeros(dimension),
            start: zeros(),
            whole: DVector::zeros(dimension),
            allowed: zeros(),
            rounding: zeros(),
        }
    }

    /// Opens a step from (t, y): takes the Jacobian there, and factors.
    pub fn begin(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        y: &[f64],
    ) -> Result<(), StepError> {
        self.from_s = t_s;
        self.at.copy_from_slice(y);
        self.linearise(equations, t_s)
    }

    /// Solves z = hγ f(t, base + z), from the guess in `z` on.
    pub fn solve(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        base: &[f64],
        z: &mut [f64],
    ) -> Result<(), StepError> {
        self.guess.copy_from_slice(z);
        for _ in 0..CHORD_LIMIT {
            let excess = self.correct(equations, t_s, base, z);
            if excess <= 1.0 {
                return Ok(());
            }
            if !excess.is_finite() {
                break;
            }
        }
        z.copy_from_slice(&self.guess);
        let mut excess = f64::INFINITY;
        for _ in 0..NEWTON_LIMIT {
            self.place(base, z);
            self.linearise(equations, t_s)?;
            excess = self.correct_damped(equations, t_s, base, z);
            if excess <= 1.0 {
                return Ok(());
            }
            if let Some(component) = z.iter().position(|z| !z.is_finite()) {
                return Err(StepError::NotFinite {
                    t_s: self.from_s,
                    component,
                });
            }
        }
        Err(StepError::NotConverged {
            t_s: self.from_s,
            iterations: CHORD_LIMIT + NEWTON_LIMIT,
            excess,
        })
    }

    /// One iteration. Returns the correction as a multiple of the tolerance, NaN if it is not a number.
    fn correct(&mut self, equations: &dyn Equations, t_s: f64, base: &[f64], z: &mut [f64]) -> f64 {
        self.place(base, z);
        self.find_correction(equations, t_s, z);
        for (z, correction) in z.iter_mut().zip(&self.correction) {
            *z += correction;
        }
        self.allow(z);
        self.excess()
    }

    /// One iteration with the Jacobian at `z`, damped. Returns as [`Self::correct`] does; a damped correction is never within
    /// the tolerance.
    fn correct_damped(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        base: &[f64],
        z: &mut [f64],
    ) -> f64 {
        self.start.copy_from_slice(z);
        self.place(base, z);
        self.find_correction(equations, t_s, z);
        self.whole.copy_from(&self.correction);
        let mut damping = 1.0;
        let mut excess = f64::INFINITY;
        for _ in 0..=HALVINGS {
            for ((z, start), correction) in z.iter_mut().zip(&self.start).zip(&self.whole) {
                *z = start + damping * correction;
            }
            if damping == 1.0 {
                self.allow(z);
                excess = self.excess();
                if excess <= 1.0 || !excess.is_finite() {
                    return excess;
                }
            }
            self.place(base, z);
            self.find_correction(equations, t_s, z);
            let next = self.excess();
            // What is not a number is reported by the next iteration, and not avoided.
            if next.is_nan() || next <= (1.0 - 0.5 * damping) * excess {
                break;
            }
            damping *= 0.5;
        }
        excess.max(2.0)
    }

    /// Solves for the correction of `z`, where the state of the stage is `self.at`.
    fn find_correction(&mut self, equations: &dyn Equations, t_s: f64, z: &[f64]) {
        equations.rates(t_s, &self.at, &mut self.rates);
        for (i, correction) in self.correction.iter_mut().enumerate() {
            *correction = self.h_gamma_s * self.rates[i] - z[i];
        }
        self.factors.solve(&mut self.correction);
    }

    /// Sets the tolerance of each component for a stage whose state is `self.at` and that moves to `z`.
    fn allow(&mut self, z: &[f64]) {
        for (i, allowed) in self.allowed.iter_mut().enumerate() {
            let size = self.at[i].abs() + z[i].abs();
            *allowed = TOLERANCE * size + self.rounding[i] + f64::MIN_POSITIVE;
        }
    }

    /// The correction as a multiple of the tolerance, NaN if it is not a number.
    fn excess(&self) -> f64 {
        let mut excess = 0.0;
        for (correction, allowed) in self.correction.iter().zip(&self.allowed) {
            // Not f64::max, which passes over NaN.
            let this = correction.abs() / allowed;
            if this > excess || this.is_nan() {
                excess = this;
            }
        }
        excess
    }

    fn place(&mut self, base: &[f64], z: &[f64]) {
        for (at, (base, z)) in self.at.iter_mut().zip(base.iter().zip(z)) {
            *at = base + z;
        }
    }

    /// Takes the Jacobian at `self.at` and factors I − hγJ.
    fn linearise(&mut self, equations: &dyn Equations, t_s: f64) -> Result<(), StepError> {
        let h_gamma = self.h_gamma_s;
        equations.jacobian(t_s, &self.at, &mut self.differences, &mut self.jacobian);
        if let Some(entry) = self.jacobian.iter().position(|entry| !entry.is_finite()) {
            return Err(StepError::NotFinite {
                t_s: self.from_s,
                component: entry % self.jacobian.nrows(),
            });
        }
        for (row, rounding) in self.rounding.iter_mut().enumerate() {
            let entries = self.jacobian.row(row);
            let terms: f64 = (entries.iter().zip(&self.at))
                .map(|(entry, y)| (entry * y).abs())
                .sum();
            *rounding = ROUNDINGS * f64::EPSILON * h_gamma * terms;
        }
        let jacobian = &self.jacobian;
        let regular = self.factors.factor(|matrix| {
            matrix.zip_apply(jacobian, |entry, partial| *entry = -h_gamma * partial);
            for i in 0..matrix.nrows() {
                matrix[(i, i)] += 1.0;
            }
        });
        if regular {
            Ok(())
        } else {
            Err(StepError::Singular { t_s: self.from_s })
        }
    }
}
