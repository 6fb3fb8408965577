use core::f64::consts::{PI, TAU};

use super::*;
use crate::mechanism::{Load, Platform};

const LAMBDAS: [f64; 7] = [0.1, 0.2, 0.25, 0.3, 0.5, 0.6, LAMBDA_MAX];

fn of_lambda(lambda: f64) -> SliderCrank {
    SliderCrank::new(lambda, 1.0).expect("a buildable mechanism")
}

/// If this fails, x is not on the circle of the rod about the crank pin, or the rod angle is wrong.
#[test]
fn the_rod_keeps_its_length() {
    for mechanism in LAMBDAS.map(of_lambda) {
        for k in 0..360 {
            let alpha = f64::from(k).to_radians();
            let pin_y = mechanism.crank_radius_m() * alpha.sin();
            let pin_x = mechanism.crank_radius_m() * alpha.cos();
            let rod = (mechanism.x_m(alpha) - pin_x).hypot(pin_y);
            assert!((rod - mechanism.rod_length_m()).abs() < 1e-15);
            let beta = mechanism.rod_angle_rad(alpha);
            assert!((beta.sin() * mechanism.rod_length_m() - pin_y).abs() < 1e-15);
        }
    }
}

/// If this fails, the source's torque formula is transcribed wrongly. The test repeats the formula as printed, with sin(α + β)/cos β.
#[test]
fn two_term_torque_is_the_printed_formula() {
    let mechanism = of_lambda(0.4);
    let (m, g, omega) = (7.0, 10.0, 30.0);
    let load = Load {
        mass_kg: m,
        gravity_mps2: g,
        platform: Platform::Below,
    };
    for k in 0..360 {
        let alpha = f64::from(k).to_radians();
        let beta = (0.4 * alpha.sin()).asin();
        let force = m * g + m * 0.4 * omega * omega * (alpha.cos() + 0.4 * (2.0 * alpha).cos());
        let printed = force / beta.cos() * (alpha + beta).sin() * 0.4;
        let ours = mechanism.torque_two_term_nm(&load, alpha, omega);
        assert!((printed - ours).abs() < 1e-11, "{alpha}: {printed} {ours}");
    }
}

/// If this fails, a turning point is missed, invented or misplaced. The lowest of 36,000 samples must not lie below it, and
/// must be within (1e-4 rad)² times the curvature (below 40) of it.
#[test]
fn extrema_bound_the_sampled_curve() {
    for mechanism in (1..=80).map(|k| of_lambda(f64::from(k) / 100.0)) {
        type Curve = fn(&SliderCrank, f64) -> f64;
        let cases: [(Extrema, Curve); 2] = [
            (mechanism.extrema_two_term(1.0), |m, a| {
                m.a_two_term_mps2(a, 1.0)
            }),
            (mechanism.extrema_exact(1.0), |m, a| {
                m.a_exact_mps2(a, 1.0, 0.0)
            }),
        ];
        for (extrema, curve) in cases {
            let samples = (0..36_000).map(|k| curve(&mechanism, f64::from(k) * TAU / 36_000.0));
            let sampled = samples.clone().fold(f64::INFINITY, f64::min);
            let max = samples.fold(0.0, |max: f64, a| max.max(a.abs()));
            let lowest = extrema.lowest().a_mps2;
            assert!(
                lowest < sampled + 1e-15 && sampled < lowest + 1e-6,
                "{mechanism:?}"
            );
            // amax must be the largest magnitude. Otherwise speeds computed from it are wrong.
            assert!(
                (max - mechanism.amax_mps2(1.0)).abs() < 1e-15,
                "{mechanism:?}"
            );
        }
    }
}

/// If this fails, the ratio at which the exact curve splits is not the root of its curvature.
#[test]
fn exact_split_is_the_root_of_the_curvature() {
    let lambda = SliderCrank::LAMBDA_SPLIT_EXACT;
    assert!((3.0 * lambda.powi(3) - 4.0 * lambda + 1.0).abs() < 1e-15);
    assert!(
        of_lambda(lambda - 1e-9)
            .extrema_exact(1.0)
            .between
            .is_none()
    );
    let just_above = of_lambda(lambda + 1e-6).extrema_exact(1.0).between;
    assert!(just_above.is_some_and(|e| e.alpha_rad > 3.1 && e.alpha_rad < PI));
}

/// If this fails, invalid lengths are accepted as a mechanism.
#[test]
fn invalid_lengths_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            SliderCrank::new(bad, 1.0),
            Err(SliderCrankError::Radius(_))
        ));
        assert!(matches!(
            SliderCrank::new(1.0, bad),
            Err(SliderCrankError::Rod(_))
        ));
    }
    assert_eq!(
        SliderCrank::new(0.9, 1.0),
        Err(SliderCrankError::Ratio(0.9))
    );
    assert!(SliderCrank::for_amax(100.0, 0.0, 0.3).is_err());
}
