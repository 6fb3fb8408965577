//! How long a step may be: where a method stops being stable, and a guard that says so beforehand.
//!
//! Words:
//! - **hω**: step × frequency, dimensionless: 2π over the steps a period;
//! - **damping ratio** ζ of the oscillator q″ + 2ζω q′ + ω² q = 0;
//! - **amplification**: the matrix by which a method multiplies (ω q, v) in one step. The method is stable where no
//!   eigenvalue of it is larger than 1.
//!
//! Nothing here is a table. The matrix is measured: the method itself steps the two unit vectors. So the limit is that of the
//! code, and the tests compare it with theory.
//!
//! Stable is not accurate. An implicit method at hω = 10 does not blow up, and is wrong about that mode.

use core::cell::RefCell;
use core::fmt;
use std::collections::VecDeque;

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, Matrix2};

use crate::problems::Oscillator;
use crate::{Equations, Refused, Scheme, StepError};

/// Largest hω looked at. A method that is stable up to here is taken to have no limit.
pub const LARGEST_H_OMEGA: f64 = 1e6;

/// Relative error of a limit found by bisection.
pub const LIMIT_TOLERANCE: f64 = 1e-9;

/// Growth a step that counts as rounding, per radian that the step spans: 16 ε (1 + hω). (The exponential of a matrix loses
/// an ε for each.) A method that is unstable from 0 on, but grows by less than this in a step of
/// [`SMALLEST_H_OMEGA`], would be taken for stable; explicit Euler grows by 100 times as much.
pub const GROWTH: f64 = 16.0 * f64::EPSILON;

/// Smallest hω looked at. A method that is unstable here is taken to be so at any step.
pub const SMALLEST_H_OMEGA: f64 = 1e-6;

/// Growth a step that counts as rounding where the state is a machine's own, whose units spread the entries of the step
/// matrix over many powers of ten.
const MACHINE_GROWTH: f64 = 1e-9;

/// Limits that a thread keeps: more than a machine with six different rotors on a frame needs.
const LIMITS_KEPT: usize = 16;

/// Ratio of one step length tried to the next. Between two that are stable nothing unstable is looked for.
const SCAN_RATIO: f64 = 1.05;

/// Why the growth over a step could not be measured.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotMeasured {
    /// The method cannot be made for these equations.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// A step failed.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// Why a step should not be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unstable {
    /// Step, frequency or damping ratio are no such thing: finite, the step and the frequency above 0, the ratio 0 or more.
    Input {
        /// Step, s.
        step_s: f64,
        /// Frequency, rad/s.
        omega_rad_s: f64,
        /// Damping ratio.
        zeta: f64,
    },
    /// The step is beyond the limit.
    Step {
        /// The method.
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
    /// The matrix by which the method multiplies (ω q, v) of q″ + 2ζω q′ + ω² q = 0 in a step of hω = `h_omega`, for
    /// finite hω and ζ from 0 on.
    ///
    /// It is measured, by stepping (1, 0) and (0, 1) at ω = 1. Infinite where the method overflows.
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

    /// Largest magnitude of an eigenvalue of [`Scheme::amplification`]: growth a step, in the long run.
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

    /// Largest stable hω for an oscillation of damping ratio `zeta`; `None` if there is no limit up to
    /// [`LARGEST_H_OMEGA`], `Some(0.0)` if no step is stable.
    ///
    /// The first change from stable to unstable, in steps of 5 %, then bisected to [`LIMIT_TOLERANCE`]. A machine is made several times
    /// before it runs, and needs the same limits each time, so each thread keeps those that it found last.
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
            let limit = first_edge(SMALLEST_H_OMEGA, LARGEST_H_OMEGA, |h_omega| {
                self.growth(h_omega, zeta) <= 1.0 + GROWTH * (1.0 + h_omega)
            });
            found.truncate(LIMITS_KEPT - 1);
            found.push_front((self, zeta.to_bits(), limit));
            limit
        })
    }

    /// Refuses a step that is beyond the method's limit for the machine's fastest mode.
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

    /// Longest stable step, s, for a linear machine with all its modes, between two step lengths; `None` if the longest
    /// is stable, `Some(0.0)` if the shortest is not.
    ///
    /// Growth below 1e-9 a step counts as rounding, so the shortest should be no shorter than a millionth of the
    /// fastest mode's period. The equations must be linear: of others it gives the stability at y = 0 only roughly.
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

/// The matrix by which a method multiplies the state of a linear machine in one step: what becomes of each unit vector,
/// less what becomes of 0.
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

/// Largest magnitude of an eigenvalue.
///
/// The matrix is balanced first: positions and velocities of a stiff machine are many powers of ten apart, and the
/// eigenvalues of an undamped one, all on the unit circle, would come out up to 1e-8 off it.
pub fn spectral_radius(matrix: &DMatrix<f64>) -> f64 {
    let mut balanced = matrix.clone();
    balance_parlett_reinsch(&mut balanced);
    let magnitudes = balanced.complex_eigenvalues().map(|value| value.norm());
    magnitudes.iter().copied().fold(0.0, f64::max)
}

/// Where `stable` first turns false between `low` and `high`; `None` if it does not.
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
