//! Effect of elastic rods on the platform: a mass m on N springs k, which the cranks move.
//!
//! There are two cases. With elastic rods in a scene, a model level without springs has an error in every harmonic. With quasi-static
//! rods, the static response replaces the fast mode ω_r = √(N k/m). Beside that static response, the error of the platform's position
//! is at most
//!
//! ```text
//! (max|f″| + 2 ζ ω_r max|f′|) / ω_r⁴ · coth(π ζ / (2 √(1 − ζ²)))
//! ```
//!
//! with f the acceleration that the cranks require. The first factor is the response to the curvature of f and to its slope by
//! damping. The second sums the remainders of earlier half periods, exp(−π ζ/√(1 − ζ²)) of each.

use std::f64::consts::PI;

use num_complex::Complex;

use super::required_torque::{HARMONICS, harmonics_of_h};
use crate::dynamics::Body;
use crate::machines::Duty;
use crate::mechanism::Mechanism;

/// Number of speeds that are compared, up to the top speed.
const SPEEDS: u32 = 100;

/// Returns the largest change of the platform's acceleration by elastic rods, relative to amax at the top speed.
pub fn share(body: &Body, zeta: f64, duty: &Duty<'_>) -> f64 {
    let mode = heave_rad_s(body);
    let harmonics = harmonics_of_h(body);
    let at_speed = |omega: f64| -> f64 {
        let parts = harmonics.iter().zip(1_u8..).map(|(harmonic, n)| {
            let ratio = f64::from(n) * omega / mode;
            let spring = Complex::new(1.0, 2.0 * zeta * ratio);
            let follows = spring / (spring - ratio * ratio);
            harmonic * (follows - 1.0).norm()
        });
        parts.sum::<f64>() * (omega / duty.top_rad_s).powi(2) / body.mechanism.max_h()
    };
    let even = (1..=SPEEDS).map(|i| duty.top_rad_s * f64::from(i) / f64::from(SPEEDS));
    let met = (1..=HARMONICS)
        .map(|n| mode / n as f64)
        .filter(|&omega| omega < duty.top_rad_s);
    even.chain(met).map(at_speed).fold(0.0, f64::max)
}

/// Returns the largest distance of the platform from its position on quasi-static rods, at any steady speed up to the top, m.
pub fn quasi_static_m(body: &Body, zeta: f64, duty: &Duty<'_>) -> f64 {
    let mode = heave_rad_s(body);
    let (mut first, mut second) = (0.0, 0.0);
    let amax = body.mechanism.crank_radius_m() * duty.top_rad_s.powi(2);
    for (harmonic, n) in harmonics_of_h(body).iter().zip(1_u8..) {
        let radians = f64::from(n) * duty.top_rad_s;
        first += amax * harmonic * radians;
        second += amax * harmonic * radians * radians;
    }
    // Quasi-static rods hold the platform at the position of its cranks. Springs deflect by the load, at amax in both directions.
    let carried = amax * body.mechanism.max_h() + body.load.gravity_mps2;
    carried / (mode * mode) + static_response_off(first, second, mode, zeta)
}

/// Returns the largest difference between a mode and its static response, for the greatest |f′| and |f″| of its excitation per unit
/// mass.
fn static_response_off(first: f64, second: f64, omega_rad_s: f64, zeta: f64) -> f64 {
    let left = PI * zeta / (2.0 * (1.0 - zeta * zeta).max(f64::MIN_POSITIVE).sqrt());
    (second + 2.0 * zeta * omega_rad_s * first) / omega_rad_s.powi(4) / left.tanh()
}

fn heave_rad_s(body: &Body) -> f64 {
    (body.axes() as f64 * body.rod_n_per_m / body.load.mass_kg).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a mode can differ from its static response by more than the bound. For f = cos Ωt the difference is known:
    /// |1/(ω² − Ω² + 2iζωΩ) − 1/ω²|.
    #[test]
    fn a_mode_differs_from_static_response_within_its_bound() {
        let omega = 5000.0_f64;
        for zeta in [0.005, 0.02, 0.1, 0.5] {
            for ratio in [0.01, 0.05, 0.2, 0.5, 0.9] {
                let drive = ratio * omega;
                let held = Complex::new(omega * omega - drive * drive, 2.0 * zeta * omega * drive);
                let off = (1.0 / held - 1.0 / (omega * omega)).norm();
                let bound = static_response_off(drive, drive * drive, omega, zeta);
                assert!(off <= bound, "{zeta}, {ratio}: {off:e} > {bound:e}");
            }
        }
    }
}
