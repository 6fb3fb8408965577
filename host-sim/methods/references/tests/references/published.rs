//! Public problems: comparison of published values, library solvers and the methods of `cophase_methods`.
//!
//! `cargo test -p cophase-references published:: -- --nocapture` prints the error of each.

use cophase_methods::problems::{Andrews, BouncingBall, Hires, VanDerPol};
use cophase_methods::{Equations, Scheme, StepError};
use cophase_references::reference;

use super::difference;
use super::support::play;

fn andrews_start() -> [f64; 14] {
    let mut start = [0.0; 14];
    start[..7].copy_from_slice(&Andrews::START);
    start
}

fn angles(y: &[f64; 14]) -> [f64; 7] {
    *y.first_chunk().unwrap()
}

/// If this fails, a mass, a length or a sign is wrong: the first accelerations are not those published, or the loops are not
/// closed.
#[test]
fn andrews_starts_closed_and_as_published() {
    let start = andrews_start();
    for g in Andrews.constraints(&start) {
        assert!(g.abs() < 1e-16, "{g:e} m"); // rounding of 0.07 m
    }
    let mut rates = [0.0; 14];
    Andrews.rates(0.0, &start, &mut rates);
    for (is, must) in rates[7..].iter().zip(Andrews::PUBLISHED_START_ACCELERATION) {
        assert!((is / must - 1.0).abs() < 1e-12, "{is} for {must}");
    }
    for rest in &rates[9..] {
        assert!(rest.abs() < 1e-9, "{rest:e}"); // the other bodies start without acceleration
    }
}

/// If this fails, the equations are wrong elsewhere, and the squeezer ends at wrong angles after seven turns. Two libraries
/// agree to 1e-13. They differ from the published value by 1.43e-9 in the two angles that turned furthest, which is 1e-10 of
/// these angles. So the published value itself has this error, and the test requires 2e-9.
///
/// The test also fails if a method is wrong on a nonlinear machine of many bodies: a third of the step then does not reduce its
/// error by 3^p.
#[test]
fn andrews_ends_at_the_published_angles() {
    let start = andrews_start();
    let end_s = Andrews::END_S;
    let truth = angles(&reference::dop853(&Andrews, start, end_s, 1e-14));
    let other = angles(&reference::tsit45(&Andrews, start, end_s, 1e-14, 1e-14));
    let bdf = angles(&reference::bdf_of_diffsol(
        &Andrews, start, end_s, 1e-13, 1e-12,
    ));
    let uncertainty = difference(&truth, &other);
    println!("DOP853 and TSIT45 differ by {uncertainty:.1e}");
    println!(
        "DOP853 and diffsol's BDF differ by {:.1e}",
        difference(&truth, &bdf)
    );
    println!(
        "published is off by {:.2e}",
        difference(&truth, &Andrews::PUBLISHED)
    );
    assert!(difference(&truth, &bdf) < 1e-9);
    assert!(difference(&truth, &Andrews::PUBLISHED) < 2e-9);
    for scheme in Scheme::ALL {
        if !scheme.suits(&Andrews) {
            continue;
        }
        let error = |steps| {
            let y = play(scheme, &Andrews, start, end_s, steps).unwrap();
            difference(&angles(&y), &truth)
        };
        let (coarse, fine) = (error(1000), error(3000));
        let order = (coarse / fine).ln() / 3.0_f64.ln();
        println!(
            "{:20} 1000 steps {coarse:.1e}, 3000 steps {fine:.1e}: order {order:.2}",
            scheme.facts().name
        );
        assert!(fine > 10.0 * uncertainty, "{scheme}: {fine:e}");
        assert!(
            (order - f64::from(scheme.facts().order)).abs() < 0.2,
            "{scheme}: {order}"
        );
    }
    let fine = play(Scheme::Rk4, &Andrews, start, end_s, 30_000).unwrap();
    assert!(difference(&angles(&fine), &truth) < 2e-12);
    for g in Andrews.constraints(&fine) {
        assert!(g.abs() < 1e-12, "a loop came open by {g:e} m");
    }
}

/// If this fails, a rate constant or SDIRK4 is wrong, and HIRES ends at another state. The fastest reaction limits the step of
/// RK4, and RK4 returns an error if the step is too long. At a short enough step it is the most accurate method.
#[test]
fn hires_ends_as_published() {
    let (start, end, published) = (Hires::START, Hires::END, Hires::PUBLISHED);
    let bdf = reference::bdf(&Hires, start, end, 1e-10, 1e-10);
    let other = reference::bdf_of_diffsol(&Hires, start, end, 1e-12, 1e-15);
    let uncertainty = difference(&other, &published);
    println!(
        "differential-equations' BDF is off by {:.1e}, diffsol's by {uncertainty:.1e}",
        difference(&bdf, &published)
    );
    assert!(difference(&bdf, &published) < 1e-8);
    assert!(uncertainty < 5e-12);
    for (scheme, steps, bound) in [
        (Scheme::Sdirk4, 1000, 4e-6),
        (Scheme::Sdirk4, 10_000, 5e-10),
        (Scheme::ImplicitMidpoint, 10_000, 2e-6),
        (Scheme::ImplicitMidpoint, 30_000, 2e-7),
        // As good as the references.
        (Scheme::Sdirk4, 30_000, 10.0 * uncertainty),
        (Scheme::Rk4, 30_000, 10.0 * uncertainty),
    ] {
        let y = play(scheme, &Hires, start, end, steps).unwrap();
        let error = difference(&y, &published);
        println!("{:20} {steps:6} steps: {error:.1e}", scheme.facts().name);
        assert!(error < bound, "{scheme}, {steps} steps: {error:e}");
    }
    let too_long = play(Scheme::Rk4, &Hires, start, end, 10_000);
    assert!(
        matches!(too_long, Err(StepError::NotFinite { .. })),
        "{too_long:?}"
    );
}

/// If this fails, SDIRK4 is not stiffly accurate or not L-stable, and ε = 1e-6 affects the result. On the slow branch, steps of
/// 5000 ε are short enough. Over the jumps, which last some ε, only steps of that length can follow. SDIRK4 reports longer ones
/// and does not make them.
#[test]
fn van_der_pol_ends_as_published() {
    let (machine, start) = (VanDerPol::STIFF, VanDerPol::START);
    let radau = reference::radau5(&machine, start, VanDerPol::END, 1e-11, 1e-11);
    let bdf = reference::bdf_of_diffsol(&machine, start, VanDerPol::END, 1e-11, 1e-11);
    for (name, state) in [("Radau IIA", radau), ("diffsol's BDF", bdf)] {
        let off = difference(&state, &VanDerPol::PUBLISHED);
        println!("{name} is off by {off:.1e}");
        assert!(off < 1e-9, "{name}: {off:e}");
    }

    let slow = reference::bdf_of_diffsol(&machine, start, 0.5, 1e-11, 1e-11);
    let radau = reference::radau5(&machine, start, 0.5, 1e-11, 1e-11);
    let uncertainty = difference(&slow, &radau);
    println!("on the slow branch the two differ by {uncertainty:.1e}");
    let error = |steps| {
        difference(
            &play(Scheme::Sdirk4, &machine, start, 0.5, steps).unwrap(),
            &slow,
        )
    };
    println!("on the slow branch, steps of 5000 ε: {:.1e}", error(100));
    assert!(error(100) < 1e-6 && uncertainty < 1e-9);

    let across = |steps| play(Scheme::Sdirk4, &machine, start, VanDerPol::END, steps);
    let too_long = across(20_000);
    let Err(StepError::NotConverged { t_s, .. }) = too_long else {
        panic!("{too_long:?}");
    };
    assert!(
        (0.806..0.8075).contains(&t_s),
        "the jump is at 0.807, not at {t_s}"
    );
    let published = &VanDerPol::PUBLISHED;
    let (coarse, fine) = (
        difference(&across(4_000_000).unwrap(), published),
        difference(&across(8_000_000).unwrap(), published),
    );
    println!("across two jumps, steps of ε/2: {coarse:.1e}, of ε/4: {fine:.1e}");
    assert!(coarse < 4e-4 && fine < coarse / 8.0);
}

/// If this fails, events are not found, or found at a wrong time, and the last bounce comes early or late. Every method of
/// order 2 integrates a parabola exactly. The remaining error is the rounding of some hundred bounces, and 1e-12/(1 − e) that
/// is not simulated.
#[test]
fn the_last_bounce_comes_at_its_exact_time() {
    for restitution in [0.5, 0.8, 0.9] {
        let ball = BouncingBall {
            gravity_mps2: 9.81,
            height_m: 1.0,
            restitution,
        };
        // Speeds fall by the factor e per bounce, from √(2gH) until 2v/g < 1e-12.
        let bounces =
            ((1e-12 * 9.81 / 2.0 / (2.0 * 9.81_f64).sqrt()).ln() / restitution.ln()).ceil();
        for scheme in Scheme::ALL {
            if scheme.facts().order == 1 {
                continue;
            }
            for step_s in [1e-1, 1e-3] {
                let (at_s, count) = ball.play(scheme, step_s).unwrap().expect("it lies");
                let off_s = (at_s - ball.last_bounce_s()).abs();
                println!(
                    "{:20} e = {restitution}, {step_s} s: {off_s:.1e} s",
                    scheme.facts().name
                );
                assert!(off_s < 3e-11, "{scheme}: {off_s:e} s");
                assert_eq!(f64::from(count), bounces, "{scheme}");
            }
        }
        assert_eq!(ball.play(Scheme::ExplicitEuler, 1e-3), Ok(None));
    }
}
