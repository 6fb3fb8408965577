//! Conformance tests of every mechanism. They compare its coefficients with numerical derivatives of its x, its torque with
//! the energy of the load, and both with the fixed-point mechanism of the controller.

use core::f64::consts::TAU;

use cophase_core::mechanism::{Mechanism as _, MechanismSettings};
use cophase_core::units::{Amax, Turns};

use super::turn_search::max_over_turn;
use super::{AnyMechanism, Configured, Load, Mechanism, Platform};

/// Close to 1 m, so that errors in metres and relative to R are similar.
const RADIUS_M: f64 = 0.8;
const TICK_HZ: u32 = 2000;

fn all() -> impl Iterator<Item = (MechanismSettings, AnyMechanism)> {
    MechanismSettings::samples().map(|settings| {
        settings.check().expect("settings that the core accepts");
        (settings, AnyMechanism::from_settings(&settings, RADIUS_M))
    })
}

fn degrees() -> impl Iterator<Item = f64> {
    (-400..400).map(|degree| f64::from(degree).to_radians())
}

/// If this fails, every speed, acceleration and torque is wrong. Central differences with step 1e-5 have an error of 1e-10
/// (a sixth of the third derivative, below 10), plus rounding of 1e-16 / 1e-5 times a rod of up to 8 m.
#[test]
fn s_and_h_are_derivatives_of_x() {
    let d = 1e-5;
    for (settings, mechanism) in all() {
        for alpha in degrees() {
            let dx = (mechanism.x_m(alpha + d) - mechanism.x_m(alpha - d)) / (2.0 * d);
            let s = -dx / mechanism.crank_radius_m();
            assert!(
                (mechanism.s(alpha) - s).abs() < 1e-9,
                "{settings:?} {alpha}"
            );
            let ds = (mechanism.s(alpha + d) - mechanism.s(alpha - d)) / (2.0 * d);
            assert!(
                (mechanism.h(alpha) - ds).abs() < 2e-8,
                "{settings:?} {alpha}"
            );
        }
    }
}

/// If this fails, a machine that is moved by torque has other kinematics than one that follows its commands.
#[test]
fn combined_kinematics_equal_the_separate_functions() {
    for (settings, mechanism) in all() {
        let farthest_m = mechanism.x_m(0.0);
        for alpha in degrees() {
            let at = mechanism.at(alpha);
            // Rounding of terms of about 1, or of the largest distance. The h of a slider-crank is divided by at least 0.6 cubed.
            let off = [
                (at.x_m - mechanism.x_m(alpha)) / farthest_m,
                at.s - mechanism.s(alpha),
                at.h - mechanism.h(alpha),
            ];
            assert!(
                off.iter().all(|off| off.abs() < 40.0 * f64::EPSILON),
                "{settings:?} {alpha}: {off:?}"
            );
        }
    }
}

/// If this fails, the platform does not return after a turn, or is not farthest at phase 0.
#[test]
fn the_platform_is_farthest_at_angle_0_and_returns() {
    for (settings, mechanism) in all() {
        let farthest_m = mechanism.x_m(0.0);
        assert_eq!(mechanism.crank_radius_m(), RADIUS_M, "{settings:?}");
        assert!(mechanism.h(0.0) > 0.0, "{settings:?}");
        for alpha in degrees() {
            let x_m = mechanism.x_m(alpha);
            assert!(x_m < farthest_m + 1e-14, "{settings:?} {alpha}");
            let turn_later = mechanism.at(alpha + TAU);
            assert!((x_m - turn_later.x_m).abs() < 1e-13, "{settings:?}");
        }
    }
}

/// If this fails, speeds computed for an amplitude are wrong. Or bounds on tilt, on torque and on values between two ticks
/// are too low.
#[test]
fn max_coefficients_bound_the_turn() {
    for (settings, mechanism) in all() {
        let max_h = mechanism.max_h();
        let peak = max_over_turn(|alpha| mechanism.h(alpha).abs());
        let h = peak.value;
        assert!((h - max_h).abs() < 1e-12, "{settings:?}: {h}");
        let max_s = mechanism.max_s();
        let s = max_over_turn(|alpha| mechanism.s(alpha).abs()).value;
        assert!(s <= max_s && max_s < 1.25 * s, "{settings:?}: {s}");
        let sharpness = mechanism.peak_sharpness();
        for beside in (-60..=60).map(|k| 0.01 * f64::from(k)) {
            let lost = 1.0 - mechanism.h(peak.alpha_rad + beside).abs() / max_h;
            let bound = sharpness * beside * beside / 2.0 + 1e-12;
            assert!(lost <= bound, "{settings:?} {beside}: {lost} > {bound}");
            assert!(
                beside.abs() > 0.05 || beside == 0.0 || lost > 0.4 * bound,
                "{settings:?} {beside}: {lost}"
            );
        }
    }
}

/// If this fails, a program shakes the platform more or less than it requests. At a steady speed the second difference of x
/// over time has the requested amplitude, within a twelfth of the squared step times the largest fourth derivative.
#[test]
fn amplitude_is_the_greatest_acceleration_at_steady_speed() {
    let d = 1e-3;
    for (settings, mechanism) in all() {
        let amax_mps2 = 700.0;
        let omega = mechanism.speed_for_amax_rad_s(amax_mps2);
        let second = |alpha: f64| {
            let beside = mechanism.x_m(alpha + d) + mechanism.x_m(alpha - d);
            (beside - 2.0 * mechanism.x_m(alpha)) * (omega / d) * (omega / d)
        };
        let max = max_over_turn(|alpha| second(alpha).abs()).value;
        assert!((max / amax_mps2 - 1.0).abs() < 1e-6, "{settings:?}: {max}");
        let back = mechanism.amax_mps2(omega);
        assert!(
            (back / amax_mps2 - 1.0).abs() < 1e-14,
            "{settings:?}: {back}"
        );
    }
}

/// If this fails, torque and motion disagree. Torque times speed must be the rate of the load's energy, with the crank
/// accelerating, for a platform above and below. Height and speed of the load come from x alone, by differences in time.
#[test]
fn torque_times_speed_is_the_rate_of_load_energy() {
    let (omega, alpha_ddot, d) = (40.0, 900.0, 1e-4);
    for (settings, mechanism) in all() {
        for (platform, up) in [(Platform::Below, -1.0), (Platform::Above, 1.0)] {
            let load = Load {
                mass_kg: 3.0,
                gravity_mps2: 9.8,
                platform,
            };
            let step_s = d / omega;
            for start in degrees() {
                let height_m =
                    |t: f64| up * mechanism.x_m(start + omega * t + 0.5 * alpha_ddot * t * t);
                let energy_j = |t: f64| {
                    let speed = (height_m(t + step_s) - height_m(t - step_s)) / (2.0 * step_s);
                    load.mass_kg * (0.5 * speed * speed + load.gravity_mps2 * height_m(t))
                };
                let power_w = (energy_j(step_s) - energy_j(-step_s)) / (2.0 * step_s);
                let torque_nm = mechanism.torque_nm(&load, start, omega, alpha_ddot);
                let scale_nm = load.mass_kg * RADIUS_M * mechanism.amax_mps2(omega);
                // Errors of two successive differences with step d, for third derivatives below 30.
                assert!(
                    (power_w / omega - torque_nm).abs() < 3e-7 * scale_nm,
                    "{settings:?} {platform:?} {start}: {} {torque_nm}",
                    power_w / omega
                );
            }
        }
    }
}

/// If this fails, a frictionless machine gains or loses energy in every turn at a steady speed.
#[test]
fn torque_does_no_work_over_a_turn() {
    for (settings, mechanism) in all() {
        for platform in [Platform::Below, Platform::Above] {
            let load = Load {
                mass_kg: 3.0,
                gravity_mps2: 9.8,
                platform,
            };
            let torques =
                (0..720).map(|k| mechanism.torque_nm(&load, f64::from(k) * TAU / 720.0, 40.0, 0.0));
            let work_j = torques.sum::<f64>() * TAU / 720.0;
            let scale_j = load.mass_kg * RADIUS_M * mechanism.amax_mps2(40.0);
            assert!(
                work_j.abs() < 1e-12 * scale_j,
                "{settings:?} {platform:?}: {work_j} J"
            );
        }
    }
}

/// If this fails, the simulated machine differs from the one for which the controller is configured.
#[test]
fn the_controller_has_the_same_mechanism() {
    for (settings, mechanism) in all() {
        let core = settings.mechanism(RADIUS_M, TICK_HZ);
        for alpha in (0..720_u32).map(|k| f64::from(k) * TAU / 720.0) {
            let kinematics = core.kinematics((alpha / TAU * 4_294_967_296.0) as u32);
            let of = |bits: i32| f64::from(bits) / f64::from(1 << 30);
            let off = [
                of(kinematics.slope) - mechanism.s(alpha),
                of(kinematics.curvature) - mechanism.h(alpha),
            ];
            assert!(
                off.iter().all(|off| off.abs() < 2e-6),
                "{settings:?} {alpha}: {off:?}"
            );
        }
        let speed: Turns = core.speed(Amax::from_num(300.0));
        let omega = speed.to_num::<f64>() * f64::from(TICK_HZ) * TAU;
        let amax_mps2 = mechanism.amax_mps2(omega);
        // The controller computes the peak of a crank-rocker in fixed point, the others in closed form.
        let error = match settings {
            MechanismSettings::CrankRocker(_) => 2e-6,
            _ => 1e-8,
        };
        assert!(
            (amax_mps2 / 300.0 - 1.0).abs() < error,
            "{settings:?}: {amax_mps2}"
        );
    }
}
