//! Scotch yoke: a pin on the crank slides in a slot of the platform, and the slot is perpendicular to the line of travel.
//!
//! x = R cos α, so that s = sin α and h = cos α. At a steady speed the platform's motion is a pure cosine: amax = R ω² at
//! both dead centres, without a second harmonic. The yoke is the limit of a slider-crank with an infinite rod.
//!
//! A slot has no length, so x is measured from the crank axes. On model levels with elastic links, pin and slot deform between
//! crank and platform.
//!
//! Not modelled: clearance and friction of the pin in its slot, and the mass of the pin.

use cophase_core::mechanism::ScotchYokeSettings;
use cophase_scene::SceneError;
use cophase_scene::file::Machine;

use super::drawing::{self, Link, Mount};
use super::{AtAngle, Configured, Mechanism};
use crate::sines::sin_cos;

/// A Scotch yoke of known size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScotchYoke {
    crank_radius_m: f64,
}

impl Configured for ScotchYoke {
    type Settings = ScotchYokeSettings;

    const KEYS: &'static [&'static str] = &["machine.crank_radius_mm"];

    fn settings(_: &Machine) -> Result<ScotchYokeSettings, SceneError> {
        Ok(ScotchYokeSettings {})
    }

    fn from_settings(_: &ScotchYokeSettings, crank_radius_m: f64) -> Self {
        Self { crank_radius_m }
    }
}

impl Mechanism for ScotchYoke {
    fn crank_radius_m(&self) -> f64 {
        self.crank_radius_m
    }

    #[inline(always)]
    fn at_each<const N: usize>(&self, alpha_rad: &[f64; N]) -> [AtAngle; N] {
        let (sines, cosines) = sin_cos(alpha_rad);
        std::array::from_fn(|i| AtAngle {
            x_m: self.crank_radius_m * cosines[i],
            s: sines[i],
            h: cosines[i],
        })
    }

    fn max_s(&self) -> f64 {
        1.0
    }

    fn max_h(&self) -> f64 {
        1.0
    }

    fn peak_sharpness(&self) -> f64 {
        1.0
    }

    fn links(&self) -> &'static str {
        "slots"
    }

    fn draw(&self, mount: &Mount) -> String {
        drawing::cranks(self, Link::Slot, mount)
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::mechanism::slider_crank::SliderCrank;
    use crate::mechanism::{Load, Platform};

    const YOKE: ScotchYoke = ScotchYoke {
        crank_radius_m: 0.02,
    };

    /// If this fails, the yoke differs in sign or scale from the slider-crank, whose limit it is for a long rod. s and h
    /// differ by λ at most. The platform positions differ by the rod length, within λ R/2.
    #[test]
    fn a_slider_crank_with_long_rod_approaches_the_yoke() {
        let omega = 60.0;
        for lambda in [1e-2, 1e-4, 1e-6] {
            let rod_m = YOKE.crank_radius_m / lambda;
            let crank = SliderCrank::new(YOKE.crank_radius_m, rod_m).unwrap();
            for (platform, degree) in (-180..180).flat_map(|degree| {
                [Platform::Above, Platform::Below].map(|platform| (platform, degree))
            }) {
                let alpha = f64::from(degree).to_radians();
                let (yoke, limit) = (YOKE.at(alpha), crank.at(alpha));
                assert!((yoke.s - limit.s).abs() <= lambda, "{lambda} {degree}°");
                assert!(
                    (yoke.h - limit.h).abs() <= 1.001 * lambda,
                    "{lambda} {degree}°"
                );
                let travel_m = limit.x_m - rod_m;
                let max_m = 0.501 * lambda * YOKE.crank_radius_m + 1e-15 * rod_m;
                assert!((yoke.x_m - travel_m).abs() <= max_m, "{lambda} {degree}°");
                let load = Load {
                    mass_kg: 6.0,
                    gravity_mps2: 9.8,
                    platform,
                };
                let off_nm = YOKE.torque_nm(&load, alpha, omega, 500.0)
                    - crank.torque_nm(&load, alpha, omega, 500.0);
                let scale_nm = load.mass_kg * YOKE.crank_radius_m * YOKE.amax_mps2(omega);
                assert!(
                    off_nm.abs() <= 4.0 * lambda * scale_nm,
                    "{lambda} {degree}°: {off_nm}"
                );
            }
        }
    }

    /// If this fails, the platform moves with a second harmonic, as with a rod. The acceleration is computed from positions only.
    #[test]
    fn the_acceleration_has_only_the_crank_frequency() {
        const SAMPLES: u32 = 360;
        let step = TAU / f64::from(SAMPLES);
        let at = |k: u32| YOKE.x_m(f64::from(k) * step);
        let second = |k: u32| (at(k + 1) - 2.0 * at(k) + at(k + SAMPLES - 1)) / (step * step);
        let harmonic = |n: u32| {
            let parts = (0..SAMPLES).map(|k| second(k) * (f64::from(n * k) * step).cos());
            2.0 / f64::from(SAMPLES) * parts.sum::<f64>()
        };
        // A second difference with step h underestimates the derivative by the fraction h²/12.
        let first = -harmonic(1) / YOKE.crank_radius_m;
        assert!((first - 1.0).abs() < step * step / 11.0, "{first}");
        for n in 2..=6 {
            assert!(harmonic(n).abs() < 1e-12, "harmonic {n}: {}", harmonic(n));
        }
    }

    /// If this fails, motors are sized wrongly. Without gravity the torque is ½ m R² ω² sin 2α: the rate at which the
    /// kinetic energy ½ m v² of a harmonic motion changes.
    #[test]
    fn torque_oscillates_twice_per_turn() {
        let load = Load {
            mass_kg: 6.0,
            gravity_mps2: 0.0,
            platform: Platform::Above,
        };
        let kinetic_j = 0.5 * 6.0 * (0.02 * 60.0_f64).powi(2);
        for degree in 0..360 {
            let alpha = f64::from(degree).to_radians();
            let torque_nm = YOKE.torque_nm(&load, alpha, 60.0, 0.0);
            let right_nm = kinetic_j * (2.0 * alpha).sin();
            assert!(
                (torque_nm - right_nm).abs() < 1e-12,
                "{degree}°: {torque_nm}"
            );
        }
    }
}
