//! Exact discretisation agrees with exponentials that are known in closed form, and with RK4 at a fine step.

use cophase_methods::{Equations, Linear, Refused, Scheme, advance};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};
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
    /// The matrix is a turning pair and one decay, seen along turned axes: exp(S J S⁻¹) = S exp(J) S⁻¹. The norm of A h is at most 14,
    /// and rounding grows by at most that of the scaled series and its squarings.
    #[test]
    fn without_input_the_step_is_the_matrix_exponential(
        (growth, turn, decay) in (-2.0..2.0_f64, -5.0..5.0_f64, -7.0..1.0_f64),
        axes in prop::array::uniform3(-3.0..3.0_f64),
        start in vector(),
        step_s in 0.01..2.0_f64,
    ) {
        let turned = *Rotation3::from_euler_angles(axes[0], axes[1], axes[2]).matrix();
        let along = Matrix3::new(growth, -turn, 0.0, turn, growth, 0.0, 0.0, 0.0, decay);
        let matrix = turned * along * turned.transpose();
        let (sin, cos) = (turn * step_s).sin_cos();
        let grown = (growth * step_s).exp();
        let exponential = turned
            * Matrix3::new(grown * cos, -grown * sin, 0.0, grown * sin, grown * cos, 0.0, 0.0, 0.0, (decay * step_s).exp())
            * turned.transpose();
        let machine = Ramped { matrix, constant: Vector3::zeros(), slope: Vector3::zeros() };
        let mut method = Scheme::Exact.prepare(&machine, step_s).unwrap();
        let mut y = [start.x, start.y, start.z];
        method.step(&machine, 0.0, &mut y).unwrap();
        let off = (Vector3::from(y) - exponential * start).amax();
        let size = exponential.amax().max(1.0);
        prop_assert!(off <= 2e-13 * size, "{off:e} of {size:e}");
    }

    /// If this fails, entries that have no closed form of a turning or a decay, such as those that grow as h and h², are wrong.
    /// For A with ones above the diagonal alone, the series ends after A².
    #[test]
    fn a_chain_of_integrators_grows_as_a_polynomial(start in vector(), step_s in 0.01..100.0_f64) {
        let matrix = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0);
        let machine = Ramped { matrix, constant: Vector3::zeros(), slope: Vector3::zeros() };
        let mut method = Scheme::Exact.prepare(&machine, step_s).unwrap();
        let mut y = [start.x, start.y, start.z];
        method.step(&machine, 0.0, &mut y).unwrap();
        let first = start.x + start.y * step_s + start.z * step_s * step_s / 2.0;
        let off = (Vector3::from(y) - Vector3::new(first, start.y + start.z * step_s, start.z)).amax();
        prop_assert!(off <= 1e-12 * (1.0 + step_s * step_s), "{off:e} after {step_s} s");
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
