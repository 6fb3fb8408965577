//! The elastic follower of a cam as a chain of three masses: shaft, arm, pusher.
//!
//! From an article on the pusher of a chocolate wrapping machine (2020), "dynamic characteristics of a cam-linkage combined
//! mechanism considering elasticity": the cam law s excites the first mass through the shaft's stiffness, and the others follow
//! it through arm and link.
//!
//! ```text
//! M₁ x₁″ + (C₁ + C₂) x₁′ − C₂ x₂′ + (K₁ + K₂) x₁ − K₂ x₂ = K₁ s [+ C₁ s′]
//! M₂ x₂″ − C₂ x₁′ + (C₂ + C₃) x₂′ − C₃ x₃′ − K₂ x₁ + (K₂ + K₃) x₂ − K₃ x₃ = 0
//! M₃ x₃″ − C₃ x₂′ + C₃ x₃′ − K₃ x₂ + K₃ x₃ = 0
//! ```
//!
//! The article prints the equations without the term in brackets: then the shaft's damper ends at the ground and not at the cam
//! ([`Shaft`]). Only "0.402, 0.175, ?.1" of the damping is legible, without a unit. At damping factor 0.1, C = 0.2 √(K M) gives
//! 401.6, 174.9 and 2030 N s/m. So the unit is 10³ N s/m, and the third value is 2.03, or 2.1 if its legible digit is right.

use nalgebra::{DMatrix, Matrix3, SMatrix, Vector3};

use super::Cam;
use crate::equations::{Differences, Equations, Linear};

/// Second end of the shaft's damper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shaft {
    /// At the ground, as printed: it brakes the motion of the mass.
    DampedToGround,
    /// At the cam, as the shaft does: it brakes the twist of the shaft.
    DampedToCam,
}

/// Links of the chain, from the shaft to the pusher, referred to the pusher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links {
    /// Masses, kg.
    pub mass_kg: [f64; 3],
    /// Stiffnesses, N/m, each of the link before its mass.
    pub stiffness_n_m: [f64; 3],
    /// Dampings, N s/m, in parallel to the stiffnesses.
    pub damping_n_s_m: [f64; 3],
}

impl Links {
    /// Returns links whose dampers each have the factor `zeta`, C = 2 ζ √(K M).
    pub fn damped(mass_kg: [f64; 3], stiffness_n_m: [f64; 3], zeta: f64) -> Self {
        let damper = |i: usize| 2.0 * zeta * (stiffness_n_m[i] * mass_kg[i]).sqrt();
        Self {
            mass_kg,
            stiffness_n_m,
            damping_n_s_m: core::array::from_fn(damper),
        }
    }
}

/// The chain; state (x₁, x₂, x₃, v₁, v₂, v₃), m and m/s.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Excitation.
    pub cam: Cam,
    /// Second end of its first damper.
    pub shaft: Shaft,
    matrix: SMatrix<f64, 6, 6>,
    mass_kg: Vector3<f64>,
    stiffness_n_m: Vector3<f64>,
    damping_n_s_m: Vector3<f64>,
}

/// A mode of free oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Frequency, rad/s: the magnitude of the eigenvalue.
    pub omega_rad_s: f64,
    /// Damping ratio.
    pub zeta: f64,
}

impl Chain {
    /// Masses as printed, kg.
    pub const MASS_KG: [f64; 3] = [0.525, 0.102, 1.01];
    /// Stiffnesses as printed, N/m.
    pub const STIFFNESS_N_M: [f64; 3] = [0.768e7, 0.75e7, 10.2e7];
    /// Dampings, N s/m: two as printed, the third reconstructed.
    pub const DAMPING_N_S_M: [f64; 3] = [402.0, 175.0, 2030.0];

    /// Returns the chain of the source.
    pub fn wrapper(cam: Cam, shaft: Shaft) -> Self {
        Self::new(cam, shaft, Self::DAMPING_N_S_M)
    }

    /// Returns the chain of the source with other dampings, N s/m.
    pub fn new(cam: Cam, shaft: Shaft, damping_n_s_m: [f64; 3]) -> Self {
        let links = Links {
            mass_kg: Self::MASS_KG,
            stiffness_n_m: Self::STIFFNESS_N_M,
            damping_n_s_m,
        };
        Self::with_links(cam, shaft, &links)
    }

    /// Returns a chain of other links.
    pub fn with_links(cam: Cam, shaft: Shaft, links: &Links) -> Self {
        let mass_kg = Vector3::from(links.mass_kg);
        let stiffness_n_m = Vector3::from(links.stiffness_n_m);
        let damping_n_s_m = Vector3::from(links.damping_n_s_m);
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        for (column, of) in [(0, stiffness_n_m), (3, damping_n_s_m)] {
            let mut block = -coupling(of);
            for (mut row, mass) in block.row_iter_mut().zip(&mass_kg) {
                row /= *mass;
            }
            matrix.fixed_view_mut::<3, 3>(3, column).copy_from(&block);
        }
        Self {
            cam,
            shaft,
            matrix,
            mass_kg,
            stiffness_n_m,
            damping_n_s_m,
        }
    }

    /// Returns the undamped natural frequencies, rad/s, in rising order, from M⁻½ K M⁻½.
    pub fn undamped_rad_s(&self) -> [f64; 3] {
        let root = Matrix3::from_diagonal(&self.mass_kg.map(|mass| 1.0 / mass.sqrt()));
        let squares = (root * coupling(self.stiffness_n_m) * root).symmetric_eigenvalues();
        let mut omega = [squares[0].sqrt(), squares[1].sqrt(), squares[2].sqrt()];
        omega.sort_by(f64::total_cmp);
        omega
    }

    /// Returns the damped modes in rising order of frequency, from the eigenvalues −ζω ± iω√(1 − ζ²) of the whole system.
    pub fn modes(&self) -> [Mode; 3] {
        let mut modes = [Mode {
            omega_rad_s: 0.0,
            zeta: 0.0,
        }; 3];
        let eigenvalues = self.matrix.complex_eigenvalues();
        let above = eigenvalues.iter().filter(|value| value.im > 0.0);
        for (mode, value) in modes.iter_mut().zip(above) {
            mode.omega_rad_s = value.norm();
            mode.zeta = -value.re / value.norm();
        }
        modes.sort_by(|a, b| a.omega_rad_s.total_cmp(&b.omega_rad_s));
        modes
    }

    /// Returns the fastest rate of oscillation or decay, rad/s: the largest magnitude of an eigenvalue.
    pub fn fastest_rad_s(&self) -> f64 {
        let eigenvalues = self.matrix.complex_eigenvalues();
        eigenvalues
            .iter()
            .map(|value| value.norm())
            .fold(0.0, f64::max)
    }

    /// Returns the acceleration of the first mass by the cam alone, m/s².
    fn excitation_mps2(&self, t_s: f64) -> f64 {
        let cam = self.cam.at(t_s);
        let mut force_n = self.stiffness_n_m[0] * cam.displacement;
        if self.shaft == Shaft::DampedToCam {
            force_n += self.damping_n_s_m[0] * cam.velocity;
        }
        force_n / self.mass_kg[0]
    }
}

/// Returns the matrix of three springs, or dampers, in a chain whose first one ends outside.
fn coupling(of: Vector3<f64>) -> Matrix3<f64> {
    let [a, b, c] = of.into();
    Matrix3::new(a + b, -b, 0.0, -b, b + c, -c, 0.0, -c, c)
}

impl Equations for Chain {
    fn dimension(&self) -> usize {
        6
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        let y = SMatrix::<f64, 6, 1>::from_column_slice(y);
        rates.copy_from_slice((self.matrix * y).as_slice());
        rates[3] += self.excitation_mps2(t_s);
    }

    fn is_second_order(&self) -> bool {
        true
    }

    fn jacobian(&self, _: f64, _: &[f64], _: &mut Differences, jacobian: &mut DMatrix<f64>) {
        jacobian.copy_from(&self.matrix);
    }

    fn linear(&self) -> Option<&dyn Linear> {
        Some(self)
    }
}

impl Linear for Chain {
    fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(6, 6, self.matrix.as_slice())
    }

    fn input(&self, t_s: f64, input: &mut [f64]) {
        input.fill(0.0);
        input[3] = self.excitation_mps2(t_s);
    }
}
