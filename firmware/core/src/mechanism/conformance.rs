//! Conformance tests of every mechanism, against numerical derivatives of its own kinematics.

use super::*;

const RADIUS_M: f64 = 0.02;
const TICK_HZ: u32 = 2000;
const ONE: f64 = (1 << 30) as f64;

/// Every mechanism, at the ends and in the middle of its settings.
fn all() -> impl Iterator<Item = (MechanismSettings, AnyMechanism)> {
    MechanismSettings::samples().map(|settings| {
        settings.check().expect("sound settings");
        (settings, settings.mechanism(RADIUS_M, TICK_HZ))
    })
}

fn at(mechanism: &AnyMechanism, turns: f64) -> (f64, f64) {
    let angle = (turns.rem_euclid(1.0) * 4294967296.0) as u32;
    let Kinematics { slope, curvature } = mechanism.kinematics(angle);
    (f64::from(slope) / ONE, f64::from(curvature) / ONE)
}

/// If this fails, a servo's torque has too little inertia, or too much.
#[test]
fn curvature_is_the_derivative_of_slope() {
    for (settings, mechanism) in all() {
        for degree in 0..360 {
            let (turns, step) = (f64::from(degree) / 360.0, 1e-3);
            let (after, before) = (
                at(&mechanism, turns + step).0,
                at(&mechanism, turns - step).0,
            );
            let derivative = (after - before) / (2.0 * step * core::f64::consts::TAU);
            let error = derivative - at(&mechanism, turns).1;
            // The error of the central difference is a sixth of the third derivative, below 30, times the squared step.
            assert!(error.abs() < 3e-4, "{settings:?} at {degree}°: {error:e}");
        }
    }
}

/// If this fails, the platform does not return to its position after a turn.
#[test]
fn the_platform_comes_back_after_a_turn() {
    for (settings, mechanism) in all() {
        let sum: f64 = (0..3600)
            .map(|i| at(&mechanism, f64::from(i) / 3600.0).0)
            .sum();
        assert!((sum / 3600.0).abs() < 1e-6, "{settings:?}: {sum}");
    }
}

/// If this fails, the machine shakes the platform harder, or less, than its program requests.
#[test]
fn amplitude_is_the_greatest_acceleration_at_steady_speed() {
    for (settings, mechanism) in all() {
        let curvatures = (0..3600).map(|i| at(&mechanism, f64::from(i) / 3600.0).1.abs());
        let max = curvatures.fold(0.0, f64::max);
        for amax_mps2 in [1.0, 98.1, 981.0] {
            let speed = mechanism.speed(Amax::from_num(amax_mps2));
            let omega = speed.to_num::<f64>() * f64::from(TICK_HZ) * core::f64::consts::TAU;
            let actual = RADIUS_M * max * omega * omega;
            assert!(
                (actual / amax_mps2 - 1.0).abs() < 1e-5,
                "{settings:?}: {actual} m/s² for {amax_mps2}"
            );
            let back = mechanism.amax(speed).to_num::<f64>();
            assert!(
                (back / amax_mps2 - 1.0).abs() < 1e-8,
                "{settings:?}: {back} m/s² for {amax_mps2}"
            );
        }
        assert_eq!(mechanism.speed(Amax::ZERO), Turns::ZERO, "{settings:?}");
    }
}

/// If this fails, a machine stops too late for its tilt, or too early.
#[test]
fn the_greatest_slope_matches_a_fine_search() {
    for (settings, mechanism) in all() {
        let slopes = (0..100_000).map(|i| at(&mechanism, f64::from(i) / 100_000.0).0.abs());
        let error = slopes.fold(0.0, f64::max) - mechanism.max_slope();
        assert!((-1e-6..1e-4).contains(&error), "{settings:?}: {error:e}");
    }
}
