//! Bounds on the difference between a pusher that follows its law exactly and one that is driven through springs.
//!
//! The chain of masses is linear. So harmonic n of the law reaches the pusher multiplied by the transfer function H(i nω). The error
//! of the acceleration is then at most the sum of (nω)² |sₙ| |H(i nω) − 1|.

use cophase_methods::problems::{Cam, Chain, Links, Shaft};
use cophase_scene::file::Fidelity;
use nalgebra::{Matrix3, Vector3};
use num_complex::Complex;

use crate::dynamics::Mode;
use crate::machines::Bounds;
use crate::output::Output;

/// Number of harmonics of the law. The jerk of a modified sine jumps, so harmonic n of its acceleration falls as 1/n². The harmonics
/// beyond these are some percent of the peak, which [`TAIL`] allows for.
const HARMONICS: u32 = 96;
const SAMPLES: u32 = 1024;
/// Allowance for the harmonics beyond, relative to the peak.
const TAIL: f64 = 0.02;
/// Part of a peak that exact discretisation misses at its own step: half a step of 0.05 rad of the slowest mode.
const RESOLVED: f64 = 3.2e-4;
/// Number of speeds that are compared, up to the top speed.
const SPEEDS: u32 = 40;

/// Deviation of followers from their law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OfFollower {
    /// Deviation of the acceleration, relative to the law's peak at top speed.
    off: f64,
    /// Ratio of the highest speed to the frequency of the slowest mode.
    frequency_ratio: f64,
    /// Slowest mode of the chain, which dominates its peaks.
    mode: Mode,
}

impl OfFollower {
    /// Creates the bounds of a cam and its chain of masses and springs, at speeds of the shaft up to `top_rad_s`.
    pub fn new(cam: Cam, (links, shaft): (Links, Shaft), top_rad_s: f64) -> Self {
        let accelerations = harmonics(&cam);
        let at_speed = |omega: f64| -> f64 {
            let missed = accelerations.iter().zip(1..).map(|(harmonic, n)| {
                let off = transfer(&links, shaft, f64::from(n) * omega) - 1.0;
                harmonic * off.norm()
            });
            missed.sum::<f64>() * (omega / top_rad_s).powi(2)
        };
        let speeds = (1..=SPEEDS).map(|i| top_rad_s * f64::from(i) / f64::from(SPEEDS));
        let slowest = Chain::with_links(cam, shaft, &links).modes()[0];
        Self {
            off: speeds.map(at_speed).fold(0.0, f64::max) / cam.peak_m() + TAIL,
            frequency_ratio: top_rad_s / slowest_rad_s(&links),
            mode: Mode {
                omega_rad_s: slowest.omega_rad_s,
                zeta: slowest.zeta,
            },
        }
    }
}

impl Bounds for OfFollower {
    /// Cams turn as commanded on all levels.
    fn of(&self, model_level: Fidelity, output: Output) -> f64 {
        match output {
            Output::Torque | Output::Ground => f64::INFINITY,
            Output::Amax if model_level < Fidelity::Elastic => 100.0 * self.off,
            Output::Amax => 100.0 * RESOLVED,
            _ => 0.0,
        }
    }

    fn mode(&self) -> Option<Mode> {
        Some(self.mode)
    }

    fn numbers(&self) -> String {
        format!(
            "the cam turns at no more than {:.3} times the follower's lowest natural frequency, which changes the acceleration by at \
             most {:.1} %",
            self.frequency_ratio,
            100.0 * self.off
        )
    }
}

/// Returns the amplitudes of the harmonics of the law's acceleration at 1 rad/s, m.
fn harmonics(cam: &Cam) -> Vec<f64> {
    let by = std::f64::consts::TAU / f64::from(SAMPLES);
    let law: Vec<f64> = (0..SAMPLES)
        .map(|i| cam.at_angle(by * f64::from(i)).acceleration)
        .collect();
    let size = |n: u32| {
        let turning = |i: usize| Complex::new(0.0, -by * f64::from(n) * i as f64).exp();
        let sum: Complex<f64> = law
            .iter()
            .enumerate()
            .map(|(i, value)| turning(i) * *value)
            .sum();
        2.0 * sum.norm() / f64::from(SAMPLES)
    };
    (1..=HARMONICS).map(size).collect()
}

/// Returns the transfer function x₃/s at a frequency.
fn transfer(links: &Links, shaft: Shaft, radians: f64) -> Complex<f64> {
    let link = |i: usize| Complex::new(links.stiffness_n_m[i], radians * links.damping_n_s_m[i]);
    let mass = |i: usize| Complex::from(links.mass_kg[i] * radians * radians);
    let none = Complex::from(0.0);
    let matrix = Matrix3::new(
        link(0) + link(1) - mass(0),
        -link(1),
        none,
        -link(1),
        link(1) + link(2) - mass(1),
        -link(2),
        none,
        -link(2),
        link(2) - mass(2),
    );
    let push = match shaft {
        Shaft::DampedToGround => Complex::from(links.stiffness_n_m[0]),
        Shaft::DampedToCam => link(0),
    };
    let solved = matrix.lu().solve(&Vector3::new(push, none, none));
    solved.map_or(Complex::from(f64::INFINITY), |solved| solved[2])
}

/// Returns the frequency of all masses on all springs in series, rad/s. It is below the slowest mode of the chain, and near it if the
/// last mass is the largest.
fn slowest_rad_s(links: &Links) -> f64 {
    let compliance: f64 = links.stiffness_n_m.iter().map(|k| k.recip()).sum();
    let mass: f64 = links.mass_kg.iter().sum();
    (compliance * mass).recip().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_methods::problems::Law;

    /// If this fails, the transfer function is wrong, and with it the bound. At low speed the pusher follows its law. Without damping
    /// the function is infinite at the chain's modes (published: 1718.3, 5610.0 and 34190.8 rad/s).
    #[test]
    fn the_transfer_function_has_the_modes_of_the_chain() {
        let links = Links::damped([0.525, 0.102, 1.01], [0.768e7, 0.75e7, 10.2e7], 0.0);
        assert!((transfer(&links, Shaft::DampedToCam, 1.0) - 1.0).norm() < 1e-5);
        for mode in [1718.3, 5610.0, 34190.8] {
            let at = transfer(&links, Shaft::DampedToCam, mode).norm();
            let beside = transfer(&links, Shaft::DampedToCam, 1.05 * mode).norm();
            assert!(at > 100.0 * beside, "{mode}: {at}, {beside} beside it");
        }
    }

    /// If this fails, the harmonics do not add up to the law's peak within the allowance for the tail.
    #[test]
    fn harmonics_sum_to_at_least_the_peak() {
        let cam = Cam {
            speed_rad_s: 1.0,
            ..Cam::wrapper(Law::ModifiedSine)
        };
        let sum: f64 = harmonics(&cam).iter().sum();
        assert!(sum > cam.peak_m(), "{sum}, {}", cam.peak_m());
    }
}
