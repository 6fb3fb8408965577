//! Exact discretisation agrees with nalgebra's exponential, and with RK4 at a fine step.

use cophase_methods::{Equations, Linear, Refused, Scheme, advance};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proptest::prelude::*;

/// y′ = A y + b₀ + b₁ t.
#[derive(Debug)]
struct Ramped {
    matrix: Matrix3<f64>,
    constant: Vector3<f64>,
    slope: Vector3<f64>,
}

impl Equations for Ramped {
    fn dimension(&self) -> usize {
        3
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        let y = Vector3::from_column_slice(y);
        let all = self.matrix * y + self.constant + self.slope * t_s;
        rates.copy_from_slice(all.as_slice());
    }

    fn linear(&self) -> Option<&dyn Linear> {
        Some(self)
    }
}

impl Linear for Ramped {
    fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(3, 3, self.matrix.as_slice())
    }

    fn input(&self, t_s: f64, input: &mut [f64]) {
        input.copy_from_slice((self.constant + self.slope * t_s).as_slice());
    }
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-2.0..2.0_f64).prop_map(Vector3::from)
}

proptest! {
    /// If this fails, Φ is not the exponential or is taken over another step, and a free system ends at another state.
    /// The entries are up to 2 and the step is up to 2 s. So the norm of A is at most 6, and rounding grows by at most
    /// e¹².
    #[test]
    fn without_input_the_step_is_the_matrix_exponential(
        entries in prop::array::uniform9(-2.0..2.0_f64),
        start in vector(),
        step_s in 0.01..2.0_f64,
    ) {
        let matrix = Matrix3::from_column_slice(&entries);
        let machine = Ramped { matrix, constant: Vector3::zeros(), slope: Vector3::zeros() };
        let mut method = Scheme::Exact.prepare(&machine, step_s).unwrap();
        let mut y = [start.x, start.y, start.z];
        method.step(&machine, 0.0, &mut y).unwrap();
        let exponential = (matrix * step_s).exp() * start;
        let off = (Vector3::from(y) - exponential).amax();
        let size = (matrix.norm() * step_s).exp();
        prop_assert!(off <= 1e-14 * size, "{off:e} of {size:e}");
    }

    /// If this fails, P or Q is wrong, or they are swapped, and the method does not follow an input on a ramp exactly.
    /// The error of RK4 in 2000 steps is (|A| h)⁴/120 ≤ 1.1e-11 of a size that grows as e^(|A| t), times |A| t ≤ 12.
    #[test]
    fn a_ramp_is_followed_exactly_in_one_step(
        entries in prop::array::uniform9(-2.0..2.0_f64),
        start in vector(),
        constant in vector(),
        slope in vector(),
        from_s in -3.0..3.0_f64,
        step_s in 0.01..2.0_f64,
    ) {
        let machine = Ramped { matrix: Matrix3::from_column_slice(&entries), constant, slope };
        let (mut exact, mut fine) = ([start.x, start.y, start.z], [start.x, start.y, start.z]);
        let mut method = Scheme::Exact.prepare(&machine, step_s).unwrap();
        method.step(&machine, from_s, &mut exact).unwrap();
        let mut rk4 = Scheme::Rk4.prepare(&machine, step_s / 2000.0).unwrap();
        advance(rk4.as_mut(), &machine, from_s, 2000, &mut fine).unwrap();
        let off = (Vector3::from(exact) - Vector3::from(fine)).amax();
        let size = (machine.matrix.norm() * step_s).exp();
        prop_assert!(off <= 1.3e-10 * size * 12.0, "{off:e} of {size:e}");
    }
}

/// If this fails, growth beyond `f64` is not refused: the matrices hold infinities, and every step gives NaN.
#[test]
fn growth_beyond_f64_is_refused() {
    let machine = Ramped {
        matrix: Matrix3::from_diagonal_element(1e3),
        constant: Vector3::zeros(),
        slope: Vector3::zeros(),
    };
    let refused = Scheme::Exact.prepare(&machine, 1.0).unwrap_err();
    assert_eq!(refused, Refused::Exponential { step_s: 1.0 });
    let mut y = DVector::from_element(3, 1.0);
    let mut shorter = Scheme::Exact.prepare(&machine, 0.5).unwrap();
    shorter.step(&machine, 0.0, y.as_mut_slice()).unwrap();
    assert!((y[0] / 500.0_f64.exp() - 1.0).abs() < 1e-11);
}
