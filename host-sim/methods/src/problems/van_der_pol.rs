//! Van der Pol's oscillator, very stiff: y₁′ = y₂, ε y₂′ = (1 − y₁²) y₂ − y₁ with ε = 1e-6.
//!
//! E. Hairer, G. Wanner, *Solving ODEs II*, section IV.1, and the *Test Set for IVP Solvers* (Bari/Geneva). It moves slowly along
//! a slow branch, then jumps to the other within some ε, at t = 0.807 and again every 0.807.

use nalgebra::DMatrix;

use crate::equations::{Differences, Equations};

/// Van der Pol's oscillator; state (y₁, y₂).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VanDerPol {
    /// ε, above 0.
    pub epsilon: f64,
}

impl VanDerPol {
    /// As published: ε = 1e-6.
    pub const STIFF: Self = Self { epsilon: 1e-6 };

    /// State at time 0. (With the start (2, −0.66), which some sources give, the published state is missed by 3e-7.)
    pub const START: [f64; 2] = [2.0, 0.0];

    /// Time of the published state.
    pub const END: f64 = 2.0;

    /// Published state at [`VanDerPol::END`], for ε = 1e-6.
    pub const PUBLISHED: [f64; 2] = [1.706_167_732_170_483, -0.892_809_701_024_797_5];
}

impl Equations for VanDerPol {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        rates[0] = y[1];
        rates[1] = ((1.0 - y[0] * y[0]) * y[1] - y[0]) / self.epsilon;
    }

    fn jacobian(&self, _: f64, y: &[f64], _: &mut Differences, jacobian: &mut DMatrix<f64>) {
        jacobian.copy_from_slice(&[
            0.0,
            (-2.0 * y[0] * y[1] - 1.0) / self.epsilon,
            1.0,
            (1.0 - y[0] * y[0]) / self.epsilon,
        ]);
    }
}
