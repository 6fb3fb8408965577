//! The implicit equation of a stage, z = hγ f(t, base + z), solved by Newton's method.
//!
//! Each iteration solves (I − hγJ) Δ = hγ f(t, base + z) − z and moves z by Δ. The Jacobian J is taken once at the start of the
//! step, and I − hγJ is factored once, for all stages and iterations. On smooth equations, a few iterations converge. If
//! [`CHORD_LIMIT`] iterations do not converge, the solution starts again with a new Jacobian at each iteration, up to
//! [`NEWTON_LIMIT`].
//!
//! **Damping.** Where a rate saturates, as that of a torque limit does, full corrections can jump between the two saturated
//! sides forever. So these later iterations halve a correction, up to [`HALVINGS`] times, until the next one by the same Jacobian
//! is shorter. This is the natural monotonicity test of P. Deuflhard, *Newton Methods for Nonlinear Problems*, 2004, section 3.3.
//!
//! **Tolerance.** The iteration ends when it moves no component by more than its tolerance. The tolerance is [`TOLERANCE`] of the
//! component's own size (|y| + |z|), plus the change by rounding alone. Rounding is [`ROUNDINGS`] ε of hγ times the largest rate of any
//! component, or sum Σ |J_ij| |y_j| from which one is computed. The largest, because a component may be at rest between large forces
//! that cancel, of which neither its rate nor its Jacobian has a trace: the tilt of a heavy platform on equal rods. (A component below
//! 2e-308, where `f64` loses its digits, may move by that.) This last correction is still made, so the remaining error is smaller by the
//! factor at which the iteration converges. If the iteration limit is reached instead, the step returns an error.

use nalgebra::{DMatrix, DVector};

use crate::equations::Differences;
use crate::factors::Factors;
use crate::{Equations, StepError};

/// Correction, relative to the component, at which an iteration ends.
pub const TOLERANCE: f64 = 1e-12;

/// Permitted rounding error of a rate, as a multiple of ε and of the sum of its terms.
pub const ROUNDINGS: f64 = 16.0;

/// Limit of iterations with the Jacobian from the start of the step.
pub const CHORD_LIMIT: u32 = 10;

/// Limit of further iterations, each with a Jacobian of its own.
pub const NEWTON_LIMIT: u32 = 50;

/// Limit of halvings of one correction.
pub const HALVINGS: u32 = 12;

/// Solves the stages of one method. All stages of a step have the same hγ.
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
    /// Start of a damped correction, and the undamped correction.
    start: Vec<f64>,
    whole: DVector<f64>,
    /// Tolerance of each component's correction.
    allowed: Vec<f64>,
    /// Largest sum of the terms of a rate.
    terms: f64,
}

impl Stage {
    pub fn new(dimension: usize) -> Self {
        let zeros = || vec![0.0; dimension];
        Self {
            h_gamma_s: 0.0,
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
            terms: 0.0,
        }
    }

    /// Begins a step at (t, y) with this hγ: computes the Jacobian there, and factors the matrix.
    pub fn begin(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        h_gamma_s: f64,
        y: &[f64],
    ) -> Result<(), StepError> {
        self.h_gamma_s = h_gamma_s;
        self.from_s = t_s;
        self.at.copy_from_slice(y);
        self.linearise(equations, t_s)
    }

    /// Solves z = hγ f(t, base + z), starting at the guess in `z`.
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

    /// Makes one iteration. Returns the correction as a multiple of the tolerance, NaN if it is not a number.
    fn correct(&mut self, equations: &dyn Equations, t_s: f64, base: &[f64], z: &mut [f64]) -> f64 {
        self.place(base, z);
        self.find_correction(equations, t_s, z);
        for (z, correction) in z.iter_mut().zip(&self.correction) {
            *z += correction;
        }
        self.allow(z);
        self.excess()
    }

    /// Makes one damped iteration with the Jacobian at `z`. Returns as [`Self::correct`] does; a damped correction is never
    /// within the tolerance.
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
            // The next iteration reports a value that is not a number.
            if next.is_nan() || next <= (1.0 - 0.5 * damping) * excess {
                break;
            }
            damping *= 0.5;
        }
        excess.max(2.0)
    }

    /// Computes the correction of `z`, at the state `self.at` of the stage.
    fn find_correction(&mut self, equations: &dyn Equations, t_s: f64, z: &[f64]) {
        equations.rates(t_s, &self.at, &mut self.rates);
        for (i, correction) in self.correction.iter_mut().enumerate() {
            *correction = self.h_gamma_s * self.rates[i] - z[i];
        }
        self.factors.solve(&mut self.correction);
    }

    /// Sets the tolerance of each component for a stage whose state is `self.at` and that moves to `z`.
    fn allow(&mut self, z: &[f64]) {
        let rates = self.rates.iter().map(|rate| rate.abs());
        let rounding = ROUNDINGS * f64::EPSILON * self.h_gamma_s * rates.fold(self.terms, f64::max);
        for (i, allowed) in self.allowed.iter_mut().enumerate() {
            let size = self.at[i].abs() + z[i].abs();
            *allowed = TOLERANCE * size + rounding + f64::MIN_POSITIVE;
        }
    }

    /// Returns the correction as a multiple of the tolerance, NaN if it is not a number.
    fn excess(&self) -> f64 {
        let mut excess = 0.0;
        for (correction, allowed) in self.correction.iter().zip(&self.allowed) {
            // f64::max would skip NaN.
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

    /// Computes the Jacobian at `self.at` and factors I − hγJ.
    fn linearise(&mut self, equations: &dyn Equations, t_s: f64) -> Result<(), StepError> {
        let h_gamma = self.h_gamma_s;
        equations.jacobian(t_s, &self.at, &mut self.differences, &mut self.jacobian);
        if let Some(entry) = self.jacobian.iter().position(|entry| !entry.is_finite()) {
            return Err(StepError::NotFinite {
                t_s: self.from_s,
                component: entry % self.jacobian.nrows(),
            });
        }
        let sums = self.jacobian.row_iter().map(|entries| {
            let terms = entries.iter().zip(&self.at);
            terms.map(|(entry, y)| (entry * y).abs()).sum()
        });
        self.terms = sums.fold(0.0, f64::max);
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
