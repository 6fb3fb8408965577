//! Andrews' squeezing mechanism: seven bodies in one plane, joined without friction in three closed loops, driven by a
//! constant torque and held by a spring.
//!
//! W. Schiehlen (ed.), *Multibody Systems Handbook*, 1990; from the *Test Set for IVP Solvers* (Bari/Geneva),
//! problem `andrews`, and E. Hairer, G. Wanner, *Solving ODEs II*, section VII.7. The names of lengths and angles are theirs.
//!
//! Seven angles q = (β, Θ, γ, Φ, δ, Ω, ε) under six constraints g(q) = 0. Differentiated twice, these give the accelerations w
//! together with the six constraint forces λ:
//!
//! ```text
//! ⎡ M  Gᵀ ⎤ ⎡ w ⎤   ⎡ f           ⎤
//! ⎣ G  0  ⎦ ⎣ λ ⎦ = ⎣ −g_qq(v, v) ⎦
//! ```
//!
//! This gives q″ = a(q, v) of seven components (index reduced from 3 to 0). The constraints then hold to the accuracy of the
//! method, which is enough over the 30 ms of the problem.

use nalgebra::{SMatrix, SVector};

use crate::Equations;

/// Andrews' squeezing mechanism; state (q, v), rad and rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Andrews;

const BODIES: usize = 7;
const CONSTRAINTS: usize = 6;

// Masses, kg.
const M1: f64 = 0.04325;
const M2: f64 = 0.00365;
const M3: f64 = 0.02373;
const M4: f64 = 0.00706;
const M5: f64 = 0.07050;
const M6: f64 = 0.00706;
const M7: f64 = 0.05498;
// Moments of inertia, kg m².
const I1: f64 = 2.194e-6;
const I2: f64 = 4.410e-7;
const I3: f64 = 5.255e-6;
const I4: f64 = 5.667e-7;
const I5: f64 = 1.169e-5;
const I6: f64 = 5.667e-7;
const I7: f64 = 1.912e-5;
// Fixed points, m.
const XA: f64 = -0.06934;
const YA: f64 = -0.00227;
const XB: f64 = -0.03635;
const YB: f64 = 0.03273;
const XC: f64 = 0.014;
const YC: f64 = 0.072;
// Spring: stiffness, N/m, and length at rest, m.
const C0: f64 = 4530.0;
const L0: f64 = 0.07785;
// Lengths, m.
const D: f64 = 0.028;
const DA: f64 = 0.0115;
const E: f64 = 0.02;
const EA: f64 = 0.01421;
const RR: f64 = 0.007;
const RA: f64 = 0.00092;
const SS: f64 = 0.035;
const SA: f64 = 0.01874;
const SB: f64 = 0.01043;
const SC: f64 = 0.018;
const SD: f64 = 0.02;
const TA: f64 = 0.02308;
const TB: f64 = 0.00916;
const U: f64 = 0.04;
const UA: f64 = 0.01228;
const UB: f64 = 0.00449;
const ZF: f64 = 0.02;
const ZT: f64 = 0.04;
const FA: f64 = 0.01421;
// Driving torque, N m.
const MOM: f64 = 0.033;

impl Andrews {
    /// Angles at time 0, rad; the velocities are 0.
    pub const START: [f64; BODIES] = [
        -0.061_713_890_014_276_45,
        0.0,
        0.455_279_819_163_070_4,
        0.222_668_390_165_885_88,
        0.487_364_979_543_842_55,
        -0.222_668_390_165_885_88,
        1.230_547_444_549_821_2,
    ];

    /// Time of the published state, s.
    pub const END_S: f64 = 0.03;

    /// Published angles at [`Andrews::END_S`], rad: PSIDE at tolerance 1e-14 in 128-bit arithmetic.
    pub const PUBLISHED: [f64; BODIES] = [
        15.810_771_196_299_04,
        -15.756_371_059_842_98,
        0.040_822_240_130_731_01,
        -0.534_730_116_322_694_8,
        0.524_409_965_880_530_4,
        0.534_730_116_322_694_8,
        1.048_080_741_042_263,
    ];

    /// Published accelerations of the first two angles at time 0, rad/s².
    pub const PUBLISHED_START_ACCELERATION: [f64; 2] =
        [14_222.443_919_954_114, -10_666.832_939_965_585];

    /// Returns the constraints g(q), m; 0 where the loops are closed.
    pub fn constraints(&self, q: &[f64]) -> [f64; CONSTRAINTS] {
        let &[beta, theta, gamma, phi, delta, omega, epsilon] = q.first_chunk().expect("7 angles");
        let x = RR * beta.cos() - D * (beta + theta).cos();
        let y = RR * beta.sin() - D * (beta + theta).sin();
        [
            x - SS * gamma.sin() - XB,
            y + SS * gamma.cos() - YB,
            x - E * (phi + delta).sin() - ZT * delta.cos() - XA,
            y + E * (phi + delta).cos() - ZT * delta.sin() - YA,
            x - ZF * (omega + epsilon).cos() - U * epsilon.sin() - XA,
            y - ZF * (omega + epsilon).sin() + U * epsilon.cos() - YA,
        ]
    }
}

impl Equations for Andrews {
    fn dimension(&self) -> usize {
        2 * BODIES
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        let (q, v) = y.split_at(BODIES);
        let (q_rates, accelerations) = rates.split_at_mut(BODIES);
        q_rates.copy_from_slice(v);
        let mut right = SVector::<f64, { BODIES + CONSTRAINTS }>::zeros();
        right.fixed_rows_mut::<BODIES>(0).copy_from(&forces(q, v));
        right
            .fixed_rows_mut::<CONSTRAINTS>(BODIES)
            .copy_from(&-constraint_curvature(q, v));
        let jacobian = constraint_jacobian(q);
        let mut matrix =
            SMatrix::<f64, { BODIES + CONSTRAINTS }, { BODIES + CONSTRAINTS }>::zeros();
        matrix
            .fixed_view_mut::<BODIES, BODIES>(0, 0)
            .copy_from(&masses(q));
        matrix
            .fixed_view_mut::<CONSTRAINTS, BODIES>(BODIES, 0)
            .copy_from(&jacobian);
        matrix
            .fixed_view_mut::<BODIES, CONSTRAINTS>(0, BODIES)
            .copy_from(&jacobian.transpose());
        if matrix.lu().solve_mut(&mut right) {
            accelerations.copy_from_slice(right.fixed_rows::<BODIES>(0).as_slice());
        } else {
            // A singular position has no acceleration; the method reports a value that is not finite.
            accelerations.fill(f64::NAN);
        }
    }

    fn is_second_order(&self) -> bool {
        true
    }
}

/// Mass matrix M(q), symmetric.
fn masses(q: &[f64]) -> SMatrix<f64, BODIES, BODIES> {
    let (cos_theta, sin_phi, sin_omega) = (q[1].cos(), q[3].sin(), q[5].sin());
    let (e, zf) = (E - EA, ZF - FA);
    let mut m = SMatrix::<f64, BODIES, BODIES>::zeros();
    m[(0, 0)] = M1 * RA * RA + M2 * (RR * RR - 2.0 * DA * RR * cos_theta + DA * DA) + I1 + I2;
    m[(1, 0)] = M2 * (DA * DA - DA * RR * cos_theta) + I2;
    m[(1, 1)] = M2 * DA * DA + I2;
    m[(2, 2)] = M3 * (SA * SA + SB * SB) + I3;
    m[(3, 3)] = M4 * e * e + I4;
    m[(4, 3)] = M4 * (e * e + ZT * e * sin_phi) + I4;
    m[(4, 4)] =
        M4 * (ZT * ZT + 2.0 * ZT * e * sin_phi + e * e) + M5 * (TA * TA + TB * TB) + I4 + I5;
    m[(5, 5)] = M6 * zf * zf + I6;
    m[(6, 5)] = M6 * (zf * zf - U * zf * sin_omega) + I6;
    m[(6, 6)] =
        M6 * (zf * zf - 2.0 * U * zf * sin_omega + U * U) + M7 * (UA * UA + UB * UB) + I6 + I7;
    m.fill_upper_triangle_with_lower_triangle();
    m
}

/// Forces f(q, v): torque, spring, and the terms of rotating frames.
fn forces(q: &[f64], v: &[f64]) -> SVector<f64, BODIES> {
    let (sin_theta, cos_phi, cos_omega) = (q[1].sin(), q[3].cos(), q[5].cos());
    let (sin_gamma, cos_gamma) = q[2].sin_cos();
    let (x, y) = (
        SD * cos_gamma + SC * sin_gamma + XB - XC,
        SD * sin_gamma - SC * cos_gamma + YB - YC,
    );
    let length = x.hypot(y);
    let pull = -C0 * (length - L0) / length;
    SVector::from([
        MOM - M2 * DA * RR * v[1] * (v[1] + 2.0 * v[0]) * sin_theta,
        M2 * DA * RR * v[0] * v[0] * sin_theta,
        pull * (x * (SC * cos_gamma - SD * sin_gamma) + y * (SD * cos_gamma + SC * sin_gamma)),
        M4 * ZT * (E - EA) * v[4] * v[4] * cos_phi,
        -M4 * ZT * (E - EA) * v[3] * (v[3] + 2.0 * v[4]) * cos_phi,
        -M6 * U * (ZF - FA) * v[6] * v[6] * cos_omega,
        M6 * U * (ZF - FA) * v[5] * (v[5] + 2.0 * v[6]) * cos_omega,
    ])
}

/// Jacobian G = ∂g/∂q of the constraints.
fn constraint_jacobian(q: &[f64]) -> SMatrix<f64, CONSTRAINTS, BODIES> {
    let (sin_beta, cos_beta) = q[0].sin_cos();
    let (sin_crank, cos_crank) = (q[0] + q[1]).sin_cos();
    let (sin_gamma, cos_gamma) = q[2].sin_cos();
    let (sin_pd, cos_pd) = (q[3] + q[4]).sin_cos();
    let (sin_delta, cos_delta) = q[4].sin_cos();
    let (sin_oe, cos_oe) = (q[5] + q[6]).sin_cos();
    let (sin_epsilon, cos_epsilon) = q[6].sin_cos();
    let mut g = SMatrix::zeros();
    for loop_closure in 0..3 {
        g[(2 * loop_closure, 0)] = -RR * sin_beta + D * sin_crank;
        g[(2 * loop_closure, 1)] = D * sin_crank;
        g[(2 * loop_closure + 1, 0)] = RR * cos_beta - D * cos_crank;
        g[(2 * loop_closure + 1, 1)] = -D * cos_crank;
    }
    g[(0, 2)] = -SS * cos_gamma;
    g[(1, 2)] = -SS * sin_gamma;
    g[(2, 3)] = -E * cos_pd;
    g[(2, 4)] = -E * cos_pd + ZT * sin_delta;
    g[(3, 3)] = -E * sin_pd;
    g[(3, 4)] = -E * sin_pd - ZT * cos_delta;
    g[(4, 5)] = ZF * sin_oe;
    g[(4, 6)] = ZF * sin_oe - U * cos_epsilon;
    g[(5, 5)] = -ZF * cos_oe;
    g[(5, 6)] = -ZF * cos_oe - U * sin_epsilon;
    g
}

/// Term g_qq(v, v): g″ without accelerations.
fn constraint_curvature(q: &[f64], v: &[f64]) -> SVector<f64, CONSTRAINTS> {
    let (sin_beta, cos_beta) = q[0].sin_cos();
    let (sin_crank, cos_crank) = (q[0] + q[1]).sin_cos();
    let (sin_gamma, cos_gamma) = q[2].sin_cos();
    let (sin_pd, cos_pd) = (q[3] + q[4]).sin_cos();
    let (sin_delta, cos_delta) = q[4].sin_cos();
    let (sin_oe, cos_oe) = (q[5] + q[6]).sin_cos();
    let (sin_epsilon, cos_epsilon) = q[6].sin_cos();
    let square = |speed: f64| speed * speed;
    let (beta, crank, gamma) = (square(v[0]), square(v[0] + v[1]), square(v[2]));
    let (pd, delta) = (square(v[3] + v[4]), square(v[4]));
    let (oe, epsilon) = (square(v[5] + v[6]), square(v[6]));
    let x = -RR * cos_beta * beta + D * cos_crank * crank;
    let y = -RR * sin_beta * beta + D * sin_crank * crank;
    SVector::from([
        x + SS * sin_gamma * gamma,
        y - SS * cos_gamma * gamma,
        x + E * sin_pd * pd + ZT * cos_delta * delta,
        y - E * cos_pd * pd + ZT * sin_delta * delta,
        x + ZF * cos_oe * oe + U * sin_epsilon * epsilon,
        y + ZF * sin_oe * oe - U * cos_epsilon * epsilon,
    ])
}
