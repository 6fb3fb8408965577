//! Longest stable step of a method, and a check before the first step.
//!
//! Terms:
//! - **hω**: step × frequency, dimensionless: 2π over the number of steps per period;
//! - **damping ratio** ζ of the oscillator q″ + 2ζω q′ + ω² q = 0;
//! - **amplification**: the matrix by which a method multiplies (ω q, v) in one step. The method is stable if no
//!   eigenvalue has a magnitude above 1.
//!
//! The matrix is measured, not taken from a table: the method itself steps the two unit vectors. So the limit is that of the
//! code, and the tests compare it with theory.
//!
//! A stable step need not be accurate. An implicit method at hω = 10 is stable, but gives a wrong result for that mode.

use core::cell::RefCell;
use core::fmt;
use std::collections::VecDeque;

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, Matrix2};

use crate::problems::Oscillator;
use crate::{Equations, NotMeasured, Refused, Scheme};

/// Largest hω that is examined. A method that is stable up to here counts as having no limit.
pub const MAX_H_OMEGA: f64 = 1e6;

/// Relative error of a limit, from bisection.
pub const LIMIT_TOLERANCE: f64 = 1e-9;

/// Growth per step that counts as rounding, per radian of the step: 16 ε (1 + hω). (The exponential of a matrix loses one ε per
/// radian.) A method that is unstable at any step, but grows by less than this in a step of
/// [`MIN_H_OMEGA`], would count as stable; explicit Euler grows by 100 times as much.
pub const GROWTH: f64 = 16.0 * f64::EPSILON;

/// Smallest hω that is examined. A method that is unstable here counts as unstable at any step.
pub const MIN_H_OMEGA: f64 = 1e-6;

/// Growth per step that counts as rounding for the state of a machine. Its units spread the entries of the step matrix over
/// many powers of ten.
const MACHINE_GROWTH: f64 = 1e-9;

/// Number of limits that a thread stores: more than a machine with six different rotors on a frame needs.
const LIMITS_KEPT: usize = 16;

/// Ratio between successive step lengths of the search. An unstable range between two stable ones is not found.
const SCAN_RATIO: f64 = 1.05;

/// Reason why a step must not be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unstable {
    /// Step, frequency or damping ratio is out of range: finite, the step and the frequency above 0, the ratio 0 or more.
    Input {
        /// Step, s.
        step_s: f64,
        /// Frequency, rad/s.
        omega_rad_s: f64,
        /// Damping ratio.
        zeta: f64,
    },
    /// The step is longer than the limit.
    Step {
        /// Method.
        scheme: Scheme,
        /// Requested step, s.
        step_s: f64,
        /// Longest stable step, s; 0 if there is none.
        limit_s: f64,
        /// Frequency, rad/s.
        omega_rad_s: f64,
        /// Damping ratio.
        zeta: f64,
    },
}

impl fmt::Display for Unstable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const WITHOUT: &str = "a method without a limit: implicit midpoint, SDIRK4 or, if the machine is linear, exact discretisation";
        match *self {
            Self::Input {
                step_s,
                omega_rad_s,
                zeta,
            } => write!(
                f,
                "step {step_s} s, frequency {omega_rad_s} rad/s, damping ratio {zeta}: must be finite, the first two above 0, the ratio 0 or more"
            ),
            Self::Step {
                scheme,
                limit_s: 0.0,
                omega_rad_s,
                zeta,
                ..
            } => write!(
                f,
                "{scheme} is unstable at any step with a mode of {omega_rad_s:.6} rad/s at damping ratio {zeta:.3}: take RK4, or {WITHOUT}"
            ),
            Self::Step {
                scheme,
                step_s,
                limit_s,
                omega_rad_s,
                zeta,
            } => write!(
                f,
                "step {:.4} us is beyond the stability limit of {scheme}, {:.4} us, with a mode of {omega_rad_s:.6} rad/s at damping ratio {zeta:.3}: take at most {:.4} us, or {WITHOUT}",
                step_s * 1e6,
                limit_s * 1e6,
                limit_s * 1e6,
            ),
        }
    }
}

impl core::error::Error for Unstable {}

impl Scheme {
    /// Returns the matrix by which the method multiplies (ω q, v) of q″ + 2ζω q′ + ω² q = 0 in a step of hω = `h_omega`, for
    /// finite hω and ζ ≥ 0.
    ///
    /// It is measured by steps from (1, 0) and (0, 1) at ω = 1. It is infinite where the method overflows.
    pub fn amplification(self, h_omega: f64, zeta: f64) -> Matrix2<f64> {
        if h_omega == 0.0 {
            return Matrix2::identity();
        }
        let oscillator = Oscillator::free(1.0, zeta);
        match step_matrix(self, &oscillator, h_omega) {
            Ok(matrix) => Matrix2::from_iterator(matrix.iter().copied()),
            Err(_) => Matrix2::from_element(f64::INFINITY),
        }
    }

    /// Returns the largest magnitude of an eigenvalue of [`Scheme::amplification`]: the growth per step in the long run.
    pub fn growth(self, h_omega: f64, zeta: f64) -> f64 {
        let matrix = self.amplification(h_omega, zeta);
        let (half_trace, determinant) = (0.5 * matrix.trace(), matrix.determinant());
        let under_root = half_trace * half_trace - determinant;
        let growth = if under_root < 0.0 {
            determinant.sqrt()
        } else {
            half_trace.abs() + under_root.sqrt()
        };
        if growth.is_nan() {
            f64::INFINITY
        } else {
            growth
        }
    }

    /// Returns the largest stable hω for an oscillation of damping ratio `zeta`; `None` if there is no limit up to
    /// [`MAX_H_OMEGA`], `Some(0.0)` if no step is stable.
    ///
    /// The search goes up in steps of 5 % to the first unstable hω, and bisects to [`LIMIT_TOLERANCE`]. A machine is created several
    /// times before it runs, and needs the same limits each time. So each thread keeps its last results.
    pub fn stability_limit(self, zeta: f64) -> Option<f64> {
        thread_local! {
            static FOUND: RefCell<VecDeque<(Scheme, u64, Option<f64>)>> = const { RefCell::new(VecDeque::new()) };
        }
        FOUND.with_borrow_mut(|found| {
            let key = (self, zeta.to_bits());
            let known = found
                .iter()
                .find(|&&(scheme, zeta, _)| (scheme, zeta) == key);
            if let Some(&(_, _, limit)) = known {
                return limit;
            }
            let limit = first_edge(MIN_H_OMEGA, MAX_H_OMEGA, |h_omega| {
                self.growth(h_omega, zeta) <= 1.0 + GROWTH * (1.0 + h_omega)
            });
            found.truncate(LIMITS_KEPT - 1);
            found.push_front((self, zeta.to_bits(), limit));
            limit
        })
    }

    /// Refuses a step that is longer than the method's limit for the machine's fastest mode.
    ///
    /// ```
    /// use cophase_methods::Scheme;
    /// let (omega_rad_s, zeta) = (34_190.8, 0.3437);
    /// assert!(Scheme::Rk4.check_step(80e-6, omega_rad_s, zeta).is_ok());
    /// let refused = Scheme::Rk4.check_step(1e-3, omega_rad_s, zeta).unwrap_err().to_string();
    /// assert!(refused.starts_with("step 1000.0000 us is beyond the stability limit of RK4, 81."));
    /// ```
    pub fn check_step(self, step_s: f64, omega_rad_s: f64, zeta: f64) -> Result<(), Unstable> {
        let above_0 = |value: f64| value.is_finite() && value > 0.0;
        if !(above_0(step_s) && above_0(omega_rad_s) && zeta.is_finite() && zeta >= 0.0) {
            return Err(Unstable::Input {
                step_s,
                omega_rad_s,
                zeta,
            });
        }
        match self.stability_limit(zeta) {
            Some(limit) if step_s * omega_rad_s > limit => Err(Unstable::Step {
                scheme: self,
                step_s,
                limit_s: limit / omega_rad_s,
                omega_rad_s,
                zeta,
            }),
            _ => Ok(()),
        }
    }

    /// Returns the longest stable step, s, for a linear machine with all its modes, between two step lengths; `None` if the
    /// longest is stable, `Some(0.0)` if the shortest is not.
    ///
    /// Growth below 1e-9 per step counts as rounding, so the shortest step should be at least a millionth of the fastest mode's
    /// period. The equations must be linear. For others, the result approximates the stability at y = 0.
    pub fn longest_stable_step_s(
        self,
        equations: &dyn Equations,
        shortest_s: f64,
        longest_s: f64,
    ) -> Result<Option<f64>, Refused> {
        self.prepare(equations, shortest_s)?;
        Ok(first_edge(shortest_s, longest_s, |step_s| {
            step_matrix(self, equations, step_s)
                .is_ok_and(|matrix| spectral_radius(&matrix) <= 1.0 + MACHINE_GROWTH)
        }))
    }
}

/// Measures the matrix by which a method multiplies the state of a linear machine in one step: the result for each unit
/// vector, minus the result for 0.
pub fn step_matrix(
    scheme: Scheme,
    equations: &dyn Equations,
    step_s: f64,
) -> Result<DMatrix<f64>, NotMeasured> {
    let n = equations.dimension();
    let mut method = scheme.prepare(equations, step_s)?;
    let mut of_zero = vec![0.0; n];
    method.step(equations, 0.0, &mut of_zero)?;
    let mut matrix = DMatrix::identity(n, n);
    for mut column in matrix.column_iter_mut() {
        method.step(equations, 0.0, column.as_mut_slice())?;
        for (entry, of_zero) in column.iter_mut().zip(&of_zero) {
            *entry -= of_zero;
        }
    }
    Ok(matrix)
}

/// Returns the largest magnitude of an eigenvalue.
///
/// The matrix is balanced first, as positions and velocities of a stiff machine are many powers of ten apart. Otherwise the
/// eigenvalues of an undamped machine would be up to 1e-8 off the unit circle.
pub fn spectral_radius(matrix: &DMatrix<f64>) -> f64 {
    let mut balanced = matrix.clone();
    balance_parlett_reinsch(&mut balanced);
    let magnitudes = balanced.complex_eigenvalues().map(|value| value.norm());
    magnitudes.iter().copied().fold(0.0, f64::max)
}

/// Returns the first value between `low` and `high` at which `stable` is false; `None` if it is true everywhere.
fn first_edge(low: f64, high: f64, stable: impl Fn(f64) -> bool) -> Option<f64> {
    if !stable(low) {
        return Some(0.0);
    }
    let mut inside = low;
    loop {
        let mut outside = (inside * SCAN_RATIO).min(high);
        if stable(outside) {
            if outside == high {
                return None;
            }
            inside = outside;
            continue;
        }
        while outside - inside > LIMIT_TOLERANCE * inside {
            let middle = 0.5 * (inside + outside);
            if stable(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        return Some(inside);
    }
}
