//! Input of a method: a machine as first-order equations y′ = f(t, y).
//!
//! Terms:
//! - **rates**: f(t, y), the derivative of every component of the state;
//! - **second-order**: y = (q, v), positions then their velocities, and the rates of q *are* v. Symplectic methods
//!   need this;
//! - **linear**: y′ = A y + b(t) with a constant matrix A. The exact discretisation needs this;
//! - **Jacobian**: ∂f/∂y. Implicit methods use it to iterate, never for the answer itself: a rough one costs
//!   iterations and not accuracy.
//!
//! A machine that provides more than its rates overrides the default of a function.

use nalgebra::DMatrix;

use crate::friction::DryFriction;

/// A system of ordinary differential equations in `f64`, y′ = f(t, y), time in s.
pub trait Equations {
    /// Number of components of the state.
    fn dimension(&self) -> usize;

    /// Writes f(t, y) into `rates`. Both slices have [`Equations::dimension`] components.
    ///
    /// The same arguments must give the same rates, as methods evaluate at any time and any number of times.
    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]);

    /// Returns true if the halves of the state are q and v, with q′ = v. The default is false.
    fn is_second_order(&self) -> bool {
        false
    }

    /// Writes ∂f/∂y into `jacobian`, a square matrix of [`Equations::dimension`]. The default uses forward differences
    /// ([`Differences::take`]).
    fn jacobian(
        &self,
        t_s: f64,
        y: &[f64],
        differences: &mut Differences,
        jacobian: &mut DMatrix<f64>,
    ) {
        differences.take(self, t_s, y, jacobian);
    }

    /// Returns the same system as y′ = A y + b(t), if it is linear. The default is `None`.
    ///
    /// A machine with dry friction is linear if it is so while no contact changes; the matrix is then that of free sliding.
    fn linear(&self) -> Option<&dyn Linear> {
        None
    }

    /// Returns the dry friction in the system, if it has any: its rates jump where a sliding speed passes 0. The default is `None`.
    fn friction(&self) -> Option<&dyn DryFriction> {
        None
    }
}

/// A linear system y′ = A y + b(t) with constant A.
pub trait Linear {
    /// Matrix A.
    fn matrix(&self) -> DMatrix<f64>;

    /// Writes b(t) into `input`.
    fn input(&self, t_s: f64, input: &mut [f64]);
}

/// Forward differences, with their working memory.
#[derive(Clone, Debug)]
pub struct Differences {
    moved: Vec<f64>,
    here: Vec<f64>,
    there: Vec<f64>,
}

impl Differences {
    /// Creates the memory for systems of `dimension` components.
    pub fn new(dimension: usize) -> Self {
        Self {
            moved: vec![0.0; dimension],
            here: vec![0.0; dimension],
            there: vec![0.0; dimension],
        }
    }

    /// Writes the difference quotients of `equations` at (t, y) into `jacobian`, one column for each component.
    ///
    /// A component is changed by √ε = 1.5e-8 of the larger of its size and 1e-3, away from 0. That balances rounding
    /// against curvature, for rates that change by their own size when the component does. The relative error is then
    /// about 1e-8.
    pub fn take(
        &mut self,
        equations: &(impl Equations + ?Sized),
        t_s: f64,
        y: &[f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        equations.rates(t_s, y, &mut self.here);
        self.moved.copy_from_slice(y);
        for (component, mut column) in jacobian.column_iter_mut().enumerate() {
            let size = y[component].abs().max(1e-3);
            self.moved[component] += (f64::EPSILON.sqrt() * size).copysign(y[component]);
            let by = self.moved[component] - y[component]; // the change that remains after rounding
            equations.rates(t_s, &self.moved, &mut self.there);
            for (quotient, (there, here)) in
                column.iter_mut().zip(self.there.iter().zip(&self.here))
            {
                *quotient = (there - here) / by;
            }
            self.moved[component] = y[component];
        }
    }
}
