//! Steps past what a method is stable for: refused where that is known, and a clear end where it is not.

use cophase_core::supervisor::State;
use cophase_lab::chart::Size;
use cophase_lab::chart::breakdown::{chain, diverging, rods, runs};
use cophase_methods::{Scheme, StepError};

use super::{failed, refused};

/// Were it wrong, a step past a method's limit would not diverge, or one below it would.
#[test]
fn a_stiff_chain_beyond_its_step() {
    let facts = chain::measure(Size::Small).unwrap();
    // Published for steady turning: 0.125 mm. From rest the first turn is within what the slowest mode still remembers of it.
    assert!(
        (facts.true_m * 1e3 - 0.125).abs() < 0.0015,
        "{} m",
        facts.true_m
    );
    for tried in &facts.methods {
        for turn in &tried.turns {
            let what = format!("{}: {turn:?}, limit {:?}", tried.scheme, tried.limit_s);
            let is_beyond = tried.limit_s.is_some_and(|limit_s| turn.step_s > limit_s);
            // The two coarsest have 64 and 128 steps in which to grow, all others at least twice as many.
            if is_beyond && turn.step_s < 600e-6 {
                let end = turn.diverged;
                assert!(matches!(end, Some(StepError::NotFinite { .. })), "{what}");
            } else if is_beyond {
                assert!(turn.peak > 1e6, "{what}");
            } else {
                assert!(turn.peak.is_finite() && turn.diverged.is_none(), "{what}");
            }
            // Below its limit explicit Euler takes hω/2 from the slowest mode's damping ratio, 0.014 of 0.035 at 16 µs: an
            // overshoot e^-πζ grows by 4.5 % of itself at most. All others are better by far.
            if !is_beyond && turn.step_s < 140e-6 {
                assert!((turn.peak - 1.0).abs() < 0.045, "{what}");
            }
        }
    }
    let limit_us = |scheme: Scheme| {
        let tried = facts.methods.iter().find(|tried| tried.scheme == scheme);
        tried
            .expect("all are tried")
            .limit_s
            .map(|limit_s| limit_s * 1e6)
    };
    // `docs/reproduced.md`, limits of the elastic follower, for the chain as printed; the damper at the cam changes nothing of the matrix.
    for (scheme, published_us) in [(Scheme::Rk4, 81.5), (Scheme::ExplicitEuler, 20.1)] {
        let found = limit_us(scheme).expect("it has one");
        assert!(
            (found / published_us - 1.0).abs() < 0.01,
            "{scheme}: {found} µs"
        );
    }
    for scheme in [Scheme::ImplicitMidpoint, Scheme::Sdirk4, Scheme::Exact] {
        assert_eq!(limit_us(scheme), None, "{scheme}");
    }
}

/// Were it wrong, a scene would run where its method is unstable.
#[test]
fn a_step_beyond_the_limit_is_refused() {
    for (method, limit) in [("rk4", "81.1464 us"), ("explicit-euler", "20.1057 us")] {
        let said = refused(&chain::scene(&format!(
            "name = \"{method}\"\nsteps_per_tick = 1"
        )));
        assert!(
            said.contains("stability limit") && said.contains(limit),
            "{said}"
        );
        assert!(said.contains("steps_per_tick = "), "what would do: {said}");
    }
    // Steps that are left open are as many as are stable and show the peaks; so is the method.
    for (method, scheme) in [("", Scheme::Exact), ("name = \"rk4\"", Scheme::Rk4)] {
        let outcome = runs::run(&chain::scene(method), &mut |_| {}).unwrap();
        let (taken, steps) = outcome.method.expect("it is integrated");
        assert_eq!(taken, scheme);
        assert!(steps > 1);
        assert_eq!((outcome.diverged, outcome.state), (None, State::Parked));
        let off_mm = outcome.statistics.followers[0].off_m * 1e3;
        assert!((off_mm - 0.125).abs() < 0.002, "{off_mm} mm");
    }
}

/// Were it wrong, equations that come to an end would take the run's files with them, or leave a run that looks well.
#[test]
fn a_run_that_diverges_says_so_and_is_written() {
    let report = failed(&diverging::scene());
    let warnings = report["warnings"].to_string();
    assert!(
        warnings.contains("diverged") && warnings.contains("the step is too long"),
        "{warnings}"
    );
    assert_eq!(report["ended"]["fault"], false);
    assert_ne!(report["ended"]["state"], "parked");
}

/// Were it wrong, rods would not ask anything of a crank that stands off, or a step that did for soft ones be run on stiff ones.
#[test]
fn stiffer_rods_under_four_cranks() {
    let facts = rods::measure(Size::Small).unwrap();
    // One of four that is 1° off is 0.25° off the plane of all. Were rods rigid its motor would have to give all of that: 20 N·m
    // by the sine of 50 electrical cycles.
    let most_nm = 20.0 * (50.0 * 0.25_f64.to_radians()).sin();
    let bent_nm = |measured: &rods::Measured| measured.off_nm - measured.in_phase_nm;
    for pair in facts.measured.windows(2) {
        assert!(bent_nm(&pair[1]) > bent_nm(&pair[0]), "{pair:?}");
        assert!(pair[1].steps > 2 * pair[0].steps, "{pair:?}");
        // A crank that is where it should be bends nothing, whatever the rods.
        let in_phase = pair[1].in_phase_nm / pair[0].in_phase_nm;
        assert!((in_phase - 1.0).abs() < 0.01, "{pair:?}");
    }
    let [soft, stiff, rigid] = facts.measured[..] else {
        panic!("{:?}", facts.measured);
    };
    assert!(bent_nm(&stiff) > 2.0 * bent_nm(&soft), "{stiff:?}");
    assert!(bent_nm(&rigid) <= most_nm, "{rigid:?}, at most {most_nm}");
    assert!(
        bent_nm(&rigid) > 0.95 * most_nm,
        "{rigid:?}, nearly {most_nm}"
    );
    // The soft rods' step, on the soft rods and on rods ten times stiffer.
    let scene = |rod| rods::scene(rod, 1.0, 3.0, "steps_per_tick = 1");
    assert_eq!(runs::refusal(&scene(rods::SOFT_N_PER_UM)), None);
    let said = refused(&scene(10.0 * rods::SOFT_N_PER_UM));
    assert!(said.contains("stability limit of RK4"), "{said}");
    let edge = facts.refused_from_n_per_um;
    assert!((5.0..50.0).contains(&edge), "{edge} N/µm");
}
