//! The step of exact discretisation against the matrix exponential of nalgebra.

use cophase_methods::{Equations, Linear, Scheme};
use nalgebra::{DMatrix, DVector};

/// y′ = A y.
#[derive(Debug)]
struct Free(DMatrix<f64>);

impl Equations for Free {
    fn dimension(&self) -> usize {
        self.0.nrows()
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        rates.copy_from_slice((&self.0 * DVector::from_column_slice(y)).as_slice());
    }

    fn linear(&self) -> Option<&dyn Linear> {
        Some(self)
    }
}

impl Linear for Free {
    fn matrix(&self) -> DMatrix<f64> {
        self.0.clone()
    }

    fn input(&self, _: f64, input: &mut [f64]) {
        input.fill(0.0);
    }
}

/// If this fails, Φ is wrong for matrices that are neither symmetrical nor turning. Entries are up to 2 and steps up to 2 s, so the norm of
/// the exponential, which multiplies rounding errors, is at most e^(|A| h).
#[test]
fn a_free_step_is_the_exponential_of_another_library() {
    let mut bits = 1_u64;
    let mut between = |low: f64, high: f64| {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        low + (high - low) * (bits >> 11) as f64 / (1_u64 << 53) as f64
    };
    for case in 0..1000 {
        let size = 1 + case % 6;
        let matrix = DMatrix::from_fn(size, size, |_, _| between(-2.0, 2.0));
        let start = DVector::from_fn(size, |_, _| between(-2.0, 2.0));
        let step_s = between(0.01, 2.0);
        let machine = Free(matrix.clone());
        let mut y = start.clone();
        let mut method = Scheme::Exact.prepare(&machine, step_s).unwrap();
        method.step(&machine, 0.0, y.as_mut_slice()).unwrap();
        let off = (y - (&matrix * step_s).exp() * start).amax();
        let bound = 1e-14 * (matrix.norm() * step_s).exp();
        assert!(off <= bound, "case {case}: {off:e}, at most {bound:e}");
    }
}
