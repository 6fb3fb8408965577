//! Torque that a turning load requires of its cranks, as harmonics of the turn.

use std::f64::consts::TAU;

use num_complex::Complex;

use crate::dynamics::Body;
use crate::mechanism::Mechanism;

/// Number of harmonics. At λ = 0.6 the ninth harmonic of the torque is 1e-4 of the second.
pub const HARMONICS: usize = 8;
/// Number of angles of the turn at which torque and lever are computed.
pub const SAMPLES: u32 = 64;

/// Torque that a turning load requires of all cranks together.
pub struct RequiredTorque {
    /// Fourier coefficients at ω = 1 rad/s, without gravity, N·m s²: sine and cosine as a complex number.
    centripetal: [Complex<f64>; HARMONICS + 1],
    /// Fourier coefficients of gravity, N·m.
    gravity: [Complex<f64>; HARMONICS + 1],
    /// Greatest slopes dT/dα of the two torques.
    slopes: (f64, f64),
    /// Largest s².
    pub lever_squared: f64,
}

impl RequiredTorque {
    /// Computes the torque of a body.
    pub fn by(body: &Body) -> Self {
        let mut required = Self {
            centripetal: [Complex::ZERO; HARMONICS + 1],
            gravity: [Complex::ZERO; HARMONICS + 1],
            slopes: (0.0, 0.0),
            lever_squared: 0.0,
        };
        let mut weightless = body.load;
        weightless.gravity_mps2 = 0.0;
        let at = |alpha: f64| {
            let turning = body.mechanism.torque_nm(&weightless, alpha, 1.0, 0.0);
            let standing = body.mechanism.torque_nm(&body.load, alpha, 0.0, 0.0);
            (turning, standing)
        };
        let by = TAU / f64::from(SAMPLES);
        for sample in 0..SAMPLES {
            let alpha = by * f64::from(sample);
            let (turning, standing) = at(alpha);
            for n in 1..=HARMONICS {
                let share = sine_and_cosine(n, alpha) * (2.0 / f64::from(SAMPLES));
                required.centripetal[n] += share * turning;
                required.gravity[n] += share * standing;
            }
            let next = at(alpha + by);
            required.slopes.0 = required.slopes.0.max((next.0 - turning).abs() / by);
            required.slopes.1 = required.slopes.1.max((next.1 - standing).abs() / by);
            required.lever_squared = required.lever_squared.max(body.mechanism.s(alpha).powi(2));
        }
        required
    }

    /// Returns harmonic `n` of all cranks together at a speed, N·m.
    pub fn harmonic_nm(&self, n: usize, omega_rad_s: f64) -> Complex<f64> {
        self.centripetal[n] * (omega_rad_s * omega_rad_s) + self.gravity[n]
    }

    /// Returns the greatest slope at a speed, N·m/rad.
    pub fn slope_nm(&self, omega_rad_s: f64) -> f64 {
        self.slopes.0 * omega_rad_s * omega_rad_s + self.slopes.1
    }
}

/// Returns sin nα and cos nα as a complex number.
fn sine_and_cosine(n: usize, alpha: f64) -> Complex<f64> {
    let (sine, cosine) = (n as f64 * alpha).sin_cos();
    Complex::new(sine, cosine)
}

/// Returns the amplitudes of the first [`HARMONICS`] harmonics of h(α), dimensionless.
pub fn harmonics_of_h(body: &Body) -> [f64; HARMONICS] {
    let by = TAU / f64::from(SAMPLES);
    std::array::from_fn(|i| {
        let at = |sample: u32| {
            let alpha = by * f64::from(sample);
            sine_and_cosine(i + 1, alpha) * body.mechanism.h(alpha)
        };
        (0..SAMPLES).map(at).sum::<Complex<f64>>().norm() * 2.0 / f64::from(SAMPLES)
    })
}
