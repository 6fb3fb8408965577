//! HIRES: how a plant's cells respond to light, eight concentrations.
//!
//! E. Schäfer (1975), in the form of the *Test Set for IVP Solvers* (Bari/Geneva), problem HIRES. Its time constants
//! span four powers of ten.

use nalgebra::DMatrix;

use crate::equations::{Differences, Equations};

/// The HIRES problem.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hires;

impl Hires {
    /// State at time 0.
    pub const START: [f64; 8] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];

    /// Time of the published state.
    pub const END: f64 = 321.8122;

    /// Published state at [`Hires::END`]: RADAU5 at tolerance 1.1e-18 in 128-bit arithmetic.
    pub const PUBLISHED: [f64; 8] = [
        0.7371312573325668e-3,
        0.1442485726316185e-3,
        0.5888729740967575e-4,
        0.1175651343283149e-2,
        0.2386356198831331e-2,
        0.6238968252742796e-2,
        0.2849998395185769e-2,
        0.2850001604814231e-2,
    ];
}

impl Equations for Hires {
    fn dimension(&self) -> usize {
        8
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        let binding = 280.0 * y[5] * y[7];
        rates[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
        rates[1] = 1.71 * y[0] - 8.75 * y[1];
        rates[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
        rates[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
        rates[4] = -1.745 * y[4] + 0.43 * (y[5] + y[6]);
        rates[5] = -binding + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
        rates[6] = binding - 1.81 * y[6];
        rates[7] = -rates[6];
    }

    fn jacobian(&self, _: f64, y: &[f64], _: &mut Differences, jacobian: &mut DMatrix<f64>) {
        let (by_5, by_7) = (280.0 * y[7], 280.0 * y[5]);
        jacobian.fill(0.0);
        for (row, column, entry) in [
            (0, 0, -1.71),
            (0, 1, 0.43),
            (0, 2, 8.32),
            (1, 0, 1.71),
            (1, 1, -8.75),
            (2, 2, -10.03),
            (2, 3, 0.43),
            (2, 4, 0.035),
            (3, 1, 8.32),
            (3, 2, 1.71),
            (3, 3, -1.12),
            (4, 4, -1.745),
            (4, 5, 0.43),
            (4, 6, 0.43),
            (5, 3, 0.69),
            (5, 4, 1.71),
            (5, 5, -by_5 - 0.43),
            (5, 6, 0.69),
            (5, 7, -by_7),
            (6, 5, by_5),
            (6, 6, -1.81),
            (6, 7, by_7),
            (7, 5, -by_5),
            (7, 6, 1.81),
            (7, 7, -by_7),
        ] {
            jacobian[(row, column)] = entry;
        }
    }
}
