//! Effect of a moving frame on the platform's acceleration, from the frequency response of frame and foundation.
//!
//! Cranks in phase move the platform by z against the frame. Frame and platform together then have heave f with
//!
//! ```text
//! (M + m) f″ + c (f′ − b′) + k (f − b) = −m z″
//! M_b b″ + c_g b′ + k_g b = c (f′ − b′) + k (f − b)
//! ```
//!
//! (without a foundation b = 0). So harmonic n of z″ makes G(nω) of itself in f″.

use nalgebra::{Matrix2, Vector2};
use num_complex::Complex;

use super::OnCranks;
use super::required_torque::{HARMONICS, harmonics_of_h};
use crate::dynamics::Layer;
use crate::machines::Duty;
use crate::mechanism::Mechanism;

const SPEEDS: u32 = 400;

/// Returns the largest acceleration of the frame at any steady speed up to the top speed, relative to amax at the top speed. It is an
/// upper bound, the sum over harmonics; 0 without a frame.
pub fn share(platform: &OnCranks<'_>, duty: &Duty<'_>) -> f64 {
    let Some(frame) = platform.frame else {
        return 0.0;
    };
    let body = platform.body;
    let mechanism = &body.mechanism;
    let harmonics = harmonics_of_h(body);
    let at_speed = |omega: f64| -> f64 {
        let parts = harmonics.iter().enumerate().map(|(i, harmonic)| {
            let radians = (i + 1) as f64 * omega;
            let answer = answer(
                &frame.suspended,
                frame.foundation.as_ref(),
                body.load.mass_kg,
                radians,
            );
            harmonic * answer
        });
        parts.sum::<f64>() * (omega / duty.top_rad_s).powi(2) / mechanism.max_h()
    };
    let even = (1..=SPEEDS).map(|i| duty.top_rad_s * f64::from(i) / f64::from(SPEEDS));
    let met = modes_rad_s(
        &frame.suspended,
        frame.foundation.as_ref(),
        body.load.mass_kg,
    );
    let met = met
        .into_iter()
        .flat_map(|mode| (1..=HARMONICS).map(move |n| mode / n as f64))
        .filter(|&omega| omega < duty.top_rad_s);
    even.chain(met).map(at_speed).fold(0.0, f64::max)
}

/// Returns the undamped heave frequencies, rad/s: that of frame and platform on the frame's springs, and that of the foundation.
fn modes_rad_s(frame: &Layer, foundation: Option<&Layer>, load_kg: f64) -> [f64; 2] {
    let upper = frame.stiffness[0] / (frame.masses[0] + load_kg);
    let Some(block) = foundation else {
        return [upper.sqrt(); 2];
    };
    let lower = (frame.stiffness[0] + block.stiffness[0]) / block.masses[0];
    let coupling =
        frame.stiffness[0] * frame.stiffness[0] / ((frame.masses[0] + load_kg) * block.masses[0]);
    let (mean, half) = (0.5 * (upper + lower), 0.5 * (upper - lower));
    let apart = (half * half + coupling).sqrt();
    [(mean - apart).max(0.0).sqrt(), (mean + apart).sqrt()]
}

/// Returns |f″ / z″| at a frequency.
fn answer(frame: &Layer, foundation: Option<&Layer>, load_kg: f64, radians: f64) -> f64 {
    let spring = |layer: &Layer| Complex::new(layer.stiffness[0], radians * layer.damping[0]);
    let square = radians * radians;
    let own = spring(frame) - (frame.masses[0] + load_kg) * square;
    // With z″ = 1, the force is −m.
    let push = Complex::from(-load_kg);
    let heave = match foundation {
        None => push / own,
        Some(block) => {
            let under = spring(frame) + spring(block) - block.masses[0] * square;
            let matrix = Matrix2::new(own, -spring(frame), -spring(frame), under);
            let solved = matrix.lu().solve(&Vector2::new(push, Complex::from(0.0)));
            solved.map_or(Complex::from(f64::INFINITY), |solved| solved[0])
        }
    };
    square * heave.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the bound is below the true motion of a frame. Far above its resonance, a free frame of mass M moves by
    /// m/(M + m) of the platform's motion; at resonance, by m ω²/(c ω) = m/((M + m) 2 ζ).
    #[test]
    fn the_frame_response_matches_its_closed_form() {
        let frame = Layer::new([90.0, 1.0, 1.0], [10.0, 1.0, 1.0], 1e6, 0.2, 0.05);
        assert!((answer(&frame, None, 10.0, 1e5) - 0.1).abs() < 1e-3);
        let resonance = (1e6_f64 / 100.0).sqrt();
        let at_it = answer(&frame, None, 10.0, resonance);
        assert!((at_it - 0.1 / (2.0 * 0.05)).abs() < 1e-9, "{at_it}");
        // A very heavy foundation is like the ground.
        let heavy = Layer::new([1e9, 1.0, 1.0], [100.0, 1.0, 1.0], 1e12, 0.2, 0.05);
        let on_it = answer(&frame, Some(&heavy), 10.0, resonance);
        assert!((on_it / at_it - 1.0).abs() < 1e-3, "{on_it}");
    }
}
