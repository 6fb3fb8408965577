//! Elastic follower chain, compared item by item with numbers that were calculated independently.
//!
//! `cargo test -p cophase-references chain:: -- --nocapture` prints all the numbers.

use core::f64::consts::TAU;

use cophase_methods::problems::{Cam, Chain, Law, Shaft};
use cophase_methods::{Equations, Scheme, advance};
use cophase_references::reference;

use super::difference;
use super::support::play;

fn assert_within(what: &str, is: f64, must: f64, relative: f64) {
    println!("{what}: {is:.6}, published {must}");
    assert!(
        (is - must).abs() <= relative * must.abs(),
        "{what}: {is}, published {must}"
    );
}

/// 1: times of the cycle, to the printed digits.
#[test]
fn cycle_times_match_the_printed_digits() {
    let cam = Cam::wrapper(Law::Cycloid);
    assert_within("speed", cam.speed_rad_s, 47.1239, 1e-6);
    assert_within("rise", cam.rise_s(), 0.044_444_4, 2e-6);
    assert_within("dwell", cam.dwell_s(), 0.05, 1e-12);
    assert_within("return", cam.return_s(), 0.038_888_9, 2e-6);
    assert_within("cycle", cam.cycle_s(), 0.133_333_3, 1e-6);
}

/// 2: modes; frequencies and damping ratios to 0.01 %.
#[test]
fn modes_match_published_frequencies_and_damping() {
    let chain = Chain::wrapper(Cam::wrapper(Law::Cycloid), Shaft::DampedToGround);
    let published = [
        (1718.3, 273.48, 0.034_70),
        (5610.0, 892.86, 0.098_42),
        (34_190.8, 5441.6, 0.343_71),
    ];
    for ((omega, mode), (rad_s, hz, zeta)) in
        (chain.undamped_rad_s().into_iter().zip(chain.modes())).zip(published)
    {
        assert_within("frequency, rad/s", omega, rad_s, 1e-4);
        assert_within("frequency, Hz", omega / TAU, hz, 1e-4);
        assert_within("damping ratio", mode.zeta, zeta, 1e-4);
    }
}

/// 3: design peaks of the four laws, to 1e-4. The laws themselves have these peaks.
#[test]
fn design_peaks_match_the_published_ones() {
    let published = [
        (TAU, 267.19, 348.99), // published as 6.2832
        (5.8883, 250.40, 327.05),
        (5.5280, 235.08, 307.04),
        (4.8881, 207.87, 271.50),
    ];
    for (law, (coefficient, rise, return_)) in Law::ALL.into_iter().zip(published) {
        let (rise_mps2, return_mps2) = Cam::wrapper(law).peaks_mps2();
        assert_within(
            "peak coefficient",
            law.peak_coefficient(),
            coefficient,
            1e-5,
        );
        assert_within("rise, m/s²", rise_mps2, rise, 1e-4);
        assert_within("return, m/s²", return_mps2, return_, 1e-4);
        let sampled = (0..=100_000)
            .map(|i| law.at(f64::from(i) / 100_000.0).acceleration.abs())
            .fold(0.0, f64::max);
        // The peak is flat: a sample is off it by the square of half a sample, 5e-6.
        assert!(
            (sampled / law.peak_coefficient() - 1.0).abs() < 1e-8,
            "{law:?}"
        );
    }
}

/// If this fails, a piece of a law is joined or differentiated wrongly: its velocity is not the slope of its displacement,
/// or its ends are not 0 and 1. Central differences at 1e-6 are off by 2e-11 of rounding and 1e-10 of curvature.
#[test]
fn laws_are_consistent() {
    for law in Law::ALL {
        let (start, end) = (law.at(0.0), law.at(1.0));
        assert!(start.displacement.abs() < 1e-15 && (end.displacement - 1.0).abs() < 1e-15);
        assert!(start.velocity.abs() < 1e-14 && end.velocity.abs() < 1e-14);
        assert!(start.acceleration.abs() < 1e-13 && end.acceleration.abs() < 1e-13);
        for i in 1..1000 {
            let (u, by) = (f64::from(i) / 1000.0, 1e-6);
            let (before, at, after) = (law.at(u - by), law.at(u), law.at(u + by));
            let slope = (after.displacement - before.displacement) / (2.0 * by);
            assert!((slope - at.velocity).abs() < 1e-9, "{law:?} at {u}");
            // Where two pieces meet, the jerk jumps by up to 80. The difference is off by a quarter of that times 1e-6.
            let slope = (after.velocity - before.velocity) / (2.0 * by);
            assert!((slope - at.acceleration).abs() < 5e-5, "{law:?} at {u}");
        }
    }
}

/// Largest values over one cycle, after enough cycles for the start to decay: the slowest mode decays by e⁻⁸ in each.
#[derive(Clone, Copy, Debug, Default)]
struct Periodic {
    first_mps2: f64,
    third_mps2: f64,
    follower_off_m: f64,
    damper_w: f64,
}

fn periodic(law: Law, shaft: Shaft, scheme: Scheme) -> Periodic {
    const STEPS: u32 = 1 << 16; // of 2 us
    const SETTLING: u32 = 6;
    let cam = Cam::wrapper(law);
    let chain = Chain::wrapper(cam, shaft);
    let step_s = cam.cycle_s() / f64::from(STEPS);
    let mut method = scheme.prepare(&chain, step_s).unwrap();
    let (mut y, mut rates) = ([0.0; 6], [0.0; 6]);
    advance(method.as_mut(), &chain, 0.0, SETTLING * STEPS, &mut y).unwrap();
    let mut found = Periodic::default();
    for i in SETTLING * STEPS..(SETTLING + 1) * STEPS {
        let t_s = f64::from(i) * step_s;
        chain.rates(t_s, &y, &mut rates);
        found.first_mps2 = found.first_mps2.max(rates[3].abs());
        found.third_mps2 = found.third_mps2.max(rates[5].abs());
        let off_m = y[2] - cam.at(t_s).displacement;
        found.follower_off_m = found.follower_off_m.max(off_m.abs());
        found.damper_w += Chain::DAMPING_N_S_M[0] * y[3] * y[3] / f64::from(STEPS);
        method.step(&chain, t_s, &mut y).unwrap();
    }
    found
}

/// 4: accelerations by the equations as printed, to 0.1 %, from two independent methods.
#[test]
fn peak_accelerations_match_the_printed_ones() {
    let published = [
        (361.01, 371.61),
        (350.21, 369.92),
        (323.36, 340.43),
        (288.07, 302.36),
    ];
    for (law, (first, third)) in Law::ALL.into_iter().zip(published) {
        for scheme in [Scheme::Exact, Scheme::Rk4] {
            println!("{law:?}, {scheme}");
            let found = periodic(law, Shaft::DampedToGround, scheme);
            assert_within("first mass, m/s²", found.first_mps2, first, 1e-3);
            assert_within("third mass, m/s²", found.third_mps2, third, 1e-3);
            let (_, design) = Cam::wrapper(law).peaks_mps2();
            let overshoot = |mps2: f64| 100.0 * (mps2 / design - 1.0);
            assert!((3.0..7.2).contains(&overshoot(found.first_mps2)));
            assert!((6.0..13.2).contains(&overshoot(found.third_mps2)));
        }
    }
}

/// 5: the damper's second end at the cam, and the loss with that end at the ground. Three digits are published. The results
/// agree to half of the last digit.
#[test]
fn figures_with_damper_at_the_cam_match_published_ones() {
    let law = Law::ModifiedSine;
    let (ground, at_cam) = (
        periodic(law, Shaft::DampedToGround, Scheme::Exact),
        periodic(law, Shaft::DampedToCam, Scheme::Exact),
    );
    assert_within("first mass, m/s²", at_cam.first_mps2, 323.45, 1e-3);
    assert_within("third mass, m/s²", at_cam.third_mps2, 340.58, 1e-3);
    assert_within(
        "off, damped to cam, mm",
        at_cam.follower_off_m * 1e3,
        0.125,
        4e-3,
    );
    assert_within(
        "off, to ground, mm",
        ground.follower_off_m * 1e3,
        0.246,
        2e-3,
    );
    assert_within(
        "burnt at the ground, kW",
        ground.damper_w * 1e-3,
        1.40,
        3.5e-3,
    );
    // The damper to ground holds the cam-side mass back by C₁ s′ / K₁ at the highest speed.
    let cam = Cam::wrapper(law);
    let fastest_mps = (0..10_000)
        .map(|i| cam.at(cam.cycle_s() * f64::from(i) / 1e4).velocity.abs())
        .fold(0.0, f64::max);
    let lag_mm = Chain::DAMPING_N_S_M[0] * fastest_mps / Chain::STIFFNESS_N_M[0] * 1e3;
    assert_within("lag, mm", lag_mm, 0.199, 2.5e-3);
}

/// 6: step limits, to 1 %. The published limit of semi-implicit Euler, 58.5 us, is 2/ω of the fastest mode without damping.
/// With its damping, taken at the velocity before the step, the limit is 2 (√(1 + ζ²) − ζ)/ω: 41.7 us.
#[test]
fn longest_stable_steps_match_published_limits() {
    let cam = Cam::wrapper(Law::ModifiedSine);
    let chain = Chain::wrapper(cam, Shaft::DampedToGround);
    let undamped = Chain::new(cam, Shaft::DampedToGround, [0.0; 3]);
    let limit_us = |scheme: Scheme, chain: &Chain| {
        let limit_s = scheme.longest_stable_step_s(chain, 1e-6, 1e-2).unwrap();
        limit_s.map(|limit_s| limit_s * 1e6)
    };
    let limited = |scheme, chain| limit_us(scheme, chain).unwrap();
    assert_within("RK4, us", limited(Scheme::Rk4, &chain), 81.5, 1e-2);
    assert_within(
        "Euler, us",
        limited(Scheme::ExplicitEuler, &chain),
        20.1,
        1e-2,
    );
    let semi_implicit = Scheme::SymplecticEuler;
    assert_within(
        "undamped, us",
        limited(semi_implicit, &undamped),
        58.5,
        1e-2,
    );
    let fastest = chain.modes()[2];
    let theory_s = 2.0 * (fastest.zeta.hypot(1.0) - fastest.zeta) / fastest.omega_rad_s;
    assert_within(
        "damped, us",
        limited(semi_implicit, &chain),
        theory_s * 1e6,
        1e-4,
    );
    for scheme in [Scheme::ImplicitMidpoint, Scheme::Sdirk4, Scheme::Exact] {
        assert_eq!(limit_us(scheme, &chain), None, "{scheme}");
    }
    // The check of the fastest mode alone gives the same limit: no other mode sets it.
    for scheme in [
        Scheme::Rk4,
        Scheme::ExplicitEuler,
        Scheme::SymplecticEuler,
        Scheme::VelocityVerlet,
    ] {
        let alone_us = scheme.stability_limit(fastest.zeta).unwrap() / fastest.omega_rad_s * 1e6;
        assert_within(
            "by its mode alone, us",
            limited(scheme, &chain),
            alone_us,
            1e-4,
        );
    }
}

/// A 1 kHz loop with an explicit method diverges and returns an error. With a method without a limit, the loop continues.
#[test]
fn methods_with_a_stability_limit_diverge_at_a_kilohertz() {
    let chain = Chain::wrapper(Cam::wrapper(Law::ModifiedSine), Shaft::DampedToGround);
    for scheme in Scheme::ALL {
        let played = play(scheme, &chain, [0.0; 6], 1.0, 1000);
        let has_limit = scheme.stability_limit(0.0).is_some();
        assert_eq!(played.is_err(), has_limit, "{scheme}: {played:?}");
        if let Ok(y) = played {
            assert!(y[..3].iter().all(|x| x.abs() < 0.1), "{scheme}: {y:?}");
        }
    }
}

/// If this fails, the equations or a method on them are wrong in a way that the periodic peaks hide: the state differs from
/// that of the library solvers. The run covers the rise of the cycloid, where all is smooth, in steps of 16 us. hω is 0.55
/// for the fastest mode, which hardly takes part, and 0.09 and 0.03 for the others. Bounds are 2 (hω)^p at 0.09, of 1 m/s.
#[test]
fn methods_follow_the_library_solvers() {
    let cam = Cam::wrapper(Law::Cycloid);
    let chain = Chain::wrapper(cam, Shaft::DampedToCam);
    let end_s = 0.04;
    let truth = reference::dop853(&chain, [0.0; 6], end_s, 1e-14);
    let other = reference::tsit45(&chain, [0.0; 6], end_s, 1e-13, 1e-13);
    let bdf = reference::bdf_of_diffsol(&chain, [0.0; 6], end_s, 1e-14, 1e-14);
    let uncertainty = difference(&truth, &other).max(difference(&truth, &bdf));
    println!("DOP853, TSIT45 and diffsol's BDF differ by {uncertainty:.1e}");
    for scheme in Scheme::ALL {
        let y = play(scheme, &chain, [0.0; 6], end_s, 2500).unwrap();
        let error = difference(&truth, &y);
        println!("{:20} {error:.1e}", scheme.facts().name);
        assert!(
            error > 10.0 * uncertainty,
            "{scheme}: {error:e} is within the references' uncertainty"
        );
        let order = i32::try_from(scheme.facts().order).unwrap();
        let bound = 2.0 * 0.09_f64.powi(order);
        assert!(error < bound, "{scheme}: {error:e}");
    }
}
