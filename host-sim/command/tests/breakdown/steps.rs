//! Steps beyond the stability limit of a method. They are refused where the limit is known. Elsewhere the run ends with a clear message.

use cophase_core::supervisor::State;
use cophase_lab::chart::Size;
use cophase_lab::chart::breakdown::{chain, diverging, rods, runs};
use cophase_methods::{Scheme, StepError};

use super::{failed, refused};

/// If this fails, a step beyond a method's limit does not diverge, or a step below it does.
#[test]
fn a_stiff_chain_diverges_only_beyond_the_step_limit() {
    let facts = chain::measure(Size::Small).unwrap();
    // Published for steady turning: 0.125 mm. From rest, the first turn differs by at most the remaining transient of the slowest mode.
    assert!(
        (facts.true_m * 1e3 - 0.125).abs() < 0.0015,
        "{} m",
        facts.true_m
    );
    for tried in &facts.methods {
        for turn in &tried.turns {
            let what = format!("{}: {turn:?}, limit {:?}", tried.scheme, tried.limit_s);
            let is_beyond = tried.limit_s.is_some_and(|limit_s| turn.step_s > limit_s);
            // The two coarsest steps leave 64 and 128 steps in which to grow. All others leave at least twice as many.
            if is_beyond && turn.step_s < 600e-6 {
                let end = turn.diverged;
                assert!(matches!(end, Some(StepError::NotFinite { .. })), "{what}");
            } else if is_beyond {
                assert!(turn.peak > 1e6, "{what}");
            } else {
                assert!(turn.peak.is_finite() && turn.diverged.is_none(), "{what}");
            }
            // Below its limit, explicit Euler subtracts hω/2 from the slowest mode's damping ratio, 0.014 of 0.035 at 16 µs. An overshoot
            // e^-πζ then grows by at most 4.5 % of itself. All other methods are far more accurate.
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
    // Limits of the elastic follower in `docs/reproduced.md`, for the chain as printed. The damper at the cam does not change the matrix.
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

/// If this fails, a scene runs where its method is unstable.
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
    // A step count that the scene leaves open is stable and resolves the peaks. The same holds for a method that it leaves open.
    for (method, scheme) in [("", Scheme::Exact), ("name = \"rk4\"", Scheme::Rk4)] {
        let outcome = runs::run(&chain::scene(method), &mut |_| {}).unwrap();
        let (taken, steps) = outcome.method.expect("it is integrated");
        assert_eq!(taken, scheme);
        assert!(steps > 1);
        assert_eq!((outcome.diverged, outcome.state), (None, State::Parked));
        let off_mm = outcome.record.axes[0]
            .follower
            .unwrap()
            .of("off_law_worst_mm")
            .unwrap();
        assert!((off_mm - 0.125).abs() < 0.002, "{off_mm} mm");
    }
}

/// If this fails, a run that diverges writes no files, or looks like a good run.
#[test]
fn a_diverging_run_is_reported_and_written() {
    let report = failed(&diverging::scene());
    let warnings = report["warnings"].to_string();
    assert!(
        warnings.contains("diverged") && warnings.contains("the step is too long"),
        "{warnings}"
    );
    assert_eq!(report["ended"]["fault"], false);
    assert_ne!(report["ended"]["state"], "parked");
}

/// If this fails, rods do not load a crank that is out of phase, or a step that suits soft rods is accepted for stiff ones.
#[test]
fn stiffer_rods_increase_torque_and_step_count() {
    let facts = rods::measure(Size::Small).unwrap();
    // One crank of four that is 1° off is 0.25° off the plane of all four. With rigid rods its motor has to give all of that: 20 N·m by
    // the sine of 50 electrical cycles.
    let max_nm = 20.0 * (50.0 * 0.25_f64.to_radians()).sin();
    let bent_nm = |measured: &rods::Measured| measured.off_nm - measured.in_phase_nm;
    for pair in facts.measured.windows(2) {
        assert!(bent_nm(&pair[1]) > bent_nm(&pair[0]), "{pair:?}");
        assert!(pair[1].steps > 2 * pair[0].steps, "{pair:?}");
        // A crank in phase bends no rod, whatever the stiffness of the rods.
        let in_phase = pair[1].in_phase_nm / pair[0].in_phase_nm;
        assert!((in_phase - 1.0).abs() < 0.01, "{pair:?}");
    }
    let [soft, stiff, rigid] = facts.measured[..] else {
        panic!("{:?}", facts.measured);
    };
    assert!(bent_nm(&stiff) > 2.0 * bent_nm(&soft), "{stiff:?}");
    assert!(bent_nm(&rigid) <= max_nm, "{rigid:?}, at most {max_nm}");
    assert!(
        bent_nm(&rigid) > 0.95 * max_nm,
        "{rigid:?}, nearly {max_nm}"
    );
    // The step count suits soft rods. It is tried on the soft rods and on rods ten times stiffer.
    let scene = |rod| rods::scene(rod, 1.0, 3.0, "steps_per_tick = 1");
    assert_eq!(runs::refusal(&scene(rods::SOFT_N_PER_UM)), None);
    let said = refused(&scene(10.0 * rods::SOFT_N_PER_UM));
    assert!(said.contains("stability limit of RK4"), "{said}");
    let edge = facts.refused_from_n_per_um;
    assert!((5.0..50.0).contains(&edge), "{edge} N/µm");
}
