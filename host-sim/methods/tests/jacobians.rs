//! Jacobians and linear forms of the problems agree with their rates.

use cophase_methods::problems::{Cam, Chain, Hires, Law, Oscillator, Pendulum, Shaft, VanDerPol};
use cophase_methods::{Differences, Equations};
use nalgebra::{DMatrix, DVector};

/// If this fails, an entry of a Jacobian is wrong. Implicit methods then still give the right answer, only more slowly, and no
/// other test detects the error. Forward differences are off by some 1e-8 of the largest entry of their row, and by curvature
/// times as much.
#[test]
fn jacobians_are_the_slopes_of_the_rates() {
    let oscillator = Oscillator::free(3.0, 0.1);
    let chain = Chain::wrapper(Cam::wrapper(Law::Cycloid), Shaft::DampedToCam);
    let problems: [(&dyn Equations, &[f64]); 5] = [
        (&oscillator, &[0.3, -0.7]),
        (&Pendulum::DRIVEN, &[1.1, 0.4]),
        (&Hires, &[0.9, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]),
        (&VanDerPol::STIFF, &[1.7, -0.9]),
        (&chain, &[0.01, 0.02, 0.03, 1.0, 2.0, 3.0]),
    ];
    for (number, (problem, y)) in problems.into_iter().enumerate() {
        let n = problem.dimension();
        let (mut stated, mut taken) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        let mut differences = Differences::new(n);
        problem.jacobian(0.01, y, &mut differences, &mut stated);
        differences.take(problem, 0.01, y, &mut taken);
        for (row, (stated, taken)) in stated.row_iter().zip(taken.row_iter()).enumerate() {
            let off = (stated - taken).amax();
            assert!(
                off <= 1e-6 * taken.amax(),
                "problem {number}, row {row}: {off:e}"
            );
        }
    }
}

/// If this fails, a linear form differs from the rates, and the exact discretisation solves another problem.
#[test]
fn linear_forms_are_the_rates() {
    let oscillator = Oscillator {
        omega_rad_s: 3.0,
        zeta: 0.1,
        force: 2.0,
        drive_rad_s: 1.3,
    };
    let at_cam = Chain::wrapper(Cam::wrapper(Law::Cycloid), Shaft::DampedToCam);
    let to_ground = Chain::wrapper(Cam::wrapper(Law::Cycloid), Shaft::DampedToGround);
    let problems: [(&dyn Equations, &[f64]); 3] = [
        (&oscillator, &[0.3, -0.7]),
        (&at_cam, &[0.01, 0.02, 0.03, 1.0, 2.0, 3.0]),
        (&to_ground, &[0.01, 0.02, 0.03, 1.0, 2.0, 3.0]),
    ];
    for (problem, y) in problems {
        let linear = problem.linear().expect("it is linear");
        let mut rates = DVector::zeros(y.len());
        problem.rates(0.02, y, rates.as_mut_slice());
        let mut form = DVector::zeros(y.len());
        linear.input(0.02, form.as_mut_slice());
        form += linear.matrix() * DVector::from_column_slice(y);
        assert!((form - &rates).amax() <= 1e-14 * rates.amax());
    }
}
