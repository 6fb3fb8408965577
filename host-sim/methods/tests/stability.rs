//! Methods are stable within the limits of theory, and the check reports a longer step before the run.
//!
//! Three independent ways give each limit: theory's formula (from trace and determinant, derived in the methods' own files, or the
//! stability polynomial), [`Scheme::stability_limit`], which bisects eigenvalues of the measured matrix, and long runs a hundredth inside
//! and outside.

use crate::support::play;
use cophase_methods::problems::Oscillator;
use cophase_methods::stability::{GROWTH, MAX_H_OMEGA};
use cophase_methods::{Scheme, Unstable};
use num_complex::Complex;

/// Largest stable hω by theory, for ζ below 1/2; `None` if there is no limit.
fn theory(scheme: Scheme, zeta: f64) -> Option<f64> {
    match scheme {
        Scheme::ExplicitEuler => Some(2.0 * zeta),
        Scheme::SymplecticEuler => Some(2.0 * ((1.0 + zeta * zeta).sqrt() - zeta)),
        Scheme::VelocityVerlet => Some(2.0 / (zeta + (1.0 - 3.0 * zeta * zeta).sqrt())),
        Scheme::Rk4 => Some(rk4_limit(zeta)),
        Scheme::ImplicitMidpoint | Scheme::Sdirk4 | Scheme::Exact => None,
    }
}

/// The limit of RK4, where |1 + z + z²/2 + z³/6 + z⁴/24| = 1 for z = x (−ζ + i √(1 − ζ²)): between 2 and 4, by bisection.
fn rk4_limit(zeta: f64) -> f64 {
    let (mut inside, mut outside) = (2.0, 4.0);
    for _ in 0..60 {
        let x = 0.5 * (inside + outside);
        let z = Complex::new(-zeta, (1.0 - zeta * zeta).sqrt()) * x;
        let growth = (((z / 4.0 + 1.0) * z / 3.0 + 1.0) * z / 2.0 + 1.0) * z + 1.0;
        if growth.norm() <= 1.0 {
            inside = x;
        } else {
            outside = x;
        }
    }
    inside
}

/// If this fails, a limit is wrong, and so is the advice that depends on it. The bisection error is 1e-9 of the limit. The growth
/// allowance moves the limit by less than 1e-7 (most at RK4's limit, where growth begins most gradually).
#[test]
fn stability_limits_match_theory() {
    assert!((rk4_limit(0.0) - 8.0_f64.sqrt()).abs() < 1e-12);
    for scheme in Scheme::ALL {
        for zeta in [0.0, 0.01, 0.05, 0.1, 0.3437, 0.49] {
            let (measured, theory) = (scheme.stability_limit(zeta), theory(scheme, zeta));
            println!(
                "{:20} ζ = {zeta}: {measured:?}, theory {theory:?}",
                scheme.facts().name
            );
            match (measured, theory) {
                (None, None) => {}
                (Some(measured), Some(theory)) => assert!(
                    (measured - theory).abs() <= 1e-7 * theory,
                    "{scheme} at ζ = {zeta}: {measured}, theory {theory}"
                ),
                _ => panic!("{scheme} at ζ = {zeta}: {measured:?}, theory {theory:?}"),
            }
        }
    }
}

/// Above ζ = 1/2 other conditions set the limit: real eigenvalues, and for Verlet the other side of the unit circle.
#[test]
fn stability_limits_match_theory_at_strong_damping() {
    for zeta in [0.6, 1.0, 2.0, 5.0_f64] {
        let slowest = if zeta > 1.0 {
            2.0 / (zeta + (zeta * zeta - 1.0).sqrt())
        } else {
            2.0 * zeta
        };
        for (scheme, theory) in [
            (Scheme::ExplicitEuler, slowest),
            (
                Scheme::SymplecticEuler,
                2.0 * ((1.0 + zeta * zeta).sqrt() - zeta),
            ),
            (Scheme::VelocityVerlet, 1.0 / zeta),
        ] {
            let measured = scheme.stability_limit(zeta).unwrap();
            assert!(
                (measured - theory).abs() <= 1e-6 * theory,
                "{scheme} at ζ = {zeta}: {measured}, theory {theory}"
            );
        }
        for scheme in [Scheme::ImplicitMidpoint, Scheme::Sdirk4, Scheme::Exact] {
            assert_eq!(scheme.stability_limit(zeta), None, "{scheme}");
        }
    }
}

/// If this fails, the measured matrix does not describe the steps: runs diverge inside the limit, or do not diverge outside it.
#[test]
fn runs_diverge_just_outside_the_limit_only() {
    // At 1.01 times its limit, explicit Euler grows by √(1 + 0.01 (2ζ)²) per step. At ζ = 0.1 this is e²⁰ in all.
    const STEPS: u32 = 100_000;
    let max = |scheme: Scheme, h_omega: f64, zeta: f64| {
        let machine = Oscillator::free(1.0, zeta);
        match play(
            scheme,
            &machine,
            [1.0, 0.0],
            h_omega * f64::from(STEPS),
            STEPS,
        ) {
            Ok(y) => y[0].abs().max(y[1].abs()),
            Err(_) => f64::INFINITY, // the state grew beyond f64
        }
    };
    for zeta in [0.0, 0.1] {
        for scheme in Scheme::ALL {
            match theory(scheme, zeta) {
                // The state grows by 1 + x²/2 per step at any x.
                Some(0.0) => assert!(max(scheme, 0.05, zeta) > 1e6, "{scheme}"),
                Some(limit) => {
                    // Just inside 2, the undamped ellipse is 1/√(1 − x²/4) = 7 times as long as wide.
                    let inside = max(scheme, 0.99 * limit, zeta);
                    assert!(inside < 10.0, "{scheme}, ζ = {zeta}: {inside} inside");
                    let outside = max(scheme, 1.01 * limit, zeta);
                    assert!(outside > 1e6, "{scheme}, ζ = {zeta}: {outside} outside");
                }
                None => {
                    for h_omega in [1.0, 10.0, 1e3, 1e6] {
                        let at = max(scheme, h_omega, zeta);
                        assert!(at < 1.01, "{scheme}, hω = {h_omega}: {at}");
                    }
                }
            }
        }
    }
}

/// If this fails, SDIRK4 is not L-stable, or the midpoint method damps. The documentation of modes that the step does not resolve is then
/// wrong. The stability function of SDIRK4 falls as 1/z, with a factor below 10.
#[test]
fn sdirk4_damps_unresolved_modes_and_midpoint_rings() {
    let zeta = 0.1;
    assert!(Scheme::Sdirk4.growth(1e4, zeta) < 1e-3);
    assert!(Scheme::Sdirk4.growth(1e6, zeta) < 1e-5);
    // |(1 + z/2) / (1 − z/2)| → 1 − 4ζ/x
    let ringing = Scheme::ImplicitMidpoint.growth(1e4, zeta);
    assert!(
        (ringing - (1.0 - 4.0 * zeta / 1e4)).abs() < 1e-8,
        "{ringing}"
    );
    // Growth of the machine itself: e^(−ζx).
    for h_omega in [0.1, 1.0, 10.0] {
        let exact = Scheme::Exact.growth(h_omega, zeta);
        assert!((exact - (-zeta * h_omega).exp()).abs() < GROWTH * (1.0 + h_omega));
    }
    assert!(Scheme::Exact.growth(MAX_H_OMEGA, 0.0) < 1.0 + 1e-8);
}

/// If this fails, the check or its message is wrong. A user then gets a run that diverges, or does not learn which step or method to
/// take.
#[test]
fn the_guard_names_the_limit_the_step_and_the_remedy() {
    let (omega, zeta) = (34_190.8, 0.0);
    let limit_s = 2.0 / omega;
    let scheme = Scheme::VelocityVerlet;
    assert_eq!(scheme.check_step(0.999 * limit_s, omega, zeta), Ok(()));
    let refused = scheme.check_step(1.001 * limit_s, omega, zeta).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "step 58.5538 us is beyond the stability limit of velocity Verlet, 58.4953 us, with a mode of 34190.800000 rad/s at damping ratio 0.000: take at most 58.4953 us, or a method without a limit: implicit midpoint, SDIRK4 or, if the machine is linear, exact discretisation"
    );
    let never = Scheme::ExplicitEuler
        .check_step(1e-9, omega, zeta)
        .unwrap_err();
    assert_eq!(
        never.to_string(),
        "explicit Euler is unstable at any step with a mode of 34190.800000 rad/s at damping ratio 0.000: take RK4, or a method without a limit: implicit midpoint, SDIRK4 or, if the machine is linear, exact discretisation"
    );
    for scheme in [Scheme::ImplicitMidpoint, Scheme::Sdirk4, Scheme::Exact] {
        assert_eq!(scheme.check_step(1.0, omega, zeta), Ok(()));
    }
    for (step_s, omega, zeta) in [
        (0.0, 1.0, 0.0),
        (f64::NAN, 1.0, 0.0),
        (1.0, -1.0, 0.0),
        (1.0, f64::INFINITY, 0.0),
        (1.0, 1.0, -0.1),
        (1.0, 1.0, f64::NAN),
    ] {
        let refused = Scheme::Sdirk4.check_step(step_s, omega, zeta);
        assert!(
            matches!(refused, Err(Unstable::Input { .. })),
            "{refused:?}"
        );
    }
}

/// If this fails, a stored limit is used for another method or damping ratio, and a machine is refused or diverges. The test computes
/// more limits than are stored.
#[test]
fn limits_are_the_same_the_second_time() {
    let all = || {
        let zetas = (0..10).map(|i| 0.1 * f64::from(i));
        zetas.flat_map(|zeta| {
            [Scheme::SymplecticEuler, Scheme::Rk4].map(|scheme| scheme.stability_limit(zeta))
        })
    };
    let first: Vec<_> = all().collect();
    assert!(all().eq(first.iter().copied()));
    let again = Scheme::Rk4.stability_limit(0.9);
    assert_eq!(
        (again, again),
        (first[19], Scheme::Rk4.stability_limit(0.9))
    );
    assert_ne!(first[18], first[19]);
}
