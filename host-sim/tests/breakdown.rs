//! The bad places of the `breakdown` chart: at each one the failure, and the guard that stands there.

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use cophase_core::supervisor::{FaultKind, State};
use cophase_methods::Scheme;
use host_sim::chart::breakdown::{
    band, chain, diverging, lambda, overload, pull_out, rods, root, runs,
};
use host_sim::chart::{Size, find};

/// `cophase run` of a scene, into `out` of a folder.
fn cophase(folder: &Path, text: &str) -> Output {
    std::fs::write(folder.join("scene.toml"), text).unwrap();
    Command::cargo_bin("cophase")
        .expect("the command is built")
        .current_dir(folder)
        .args(["run", "scene.toml", "--out", "out"])
        .output()
        .expect("it runs")
}

/// That a scene is refused with status 2 and nothing written; what is said.
#[track_caller]
fn refused(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = cophase(folder.path(), text);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(!folder.path().join("out").exists(), "something was written");
    String::from_utf8(output.stderr).unwrap()
}

/// That a run ends with status 1 and all its files; its report.
#[track_caller]
fn failed(text: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let output = cophase(folder.path(), text);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    // A header, and a row for each tick up to the end, at least of the way there.
    assert!(read("trace.csv").lines().count() > 100);
    assert!(read("steps.vcd").contains("$enddefinitions"));
    assert!(read("scope.svg").trim_end().ends_with("</svg>"));
    serde_json::from_str(&read("report.json")).unwrap()
}

/// Were it wrong, a program that starts from rest would be given an acceleration that no machine has, or would be a fault.
#[test]
fn root_at_rest() {
    let facts = root::look().unwrap();
    // In its first tick of h the root comes to √(40 g h / R (1 + λ)) / 2π, which is 1261 rev/s² h.
    let asked = facts.asked_hz_per_s();
    assert!((1250.0..1270.0).contains(&asked), "{asked} rev/s²");
    // A speed is a whole number of 2⁻⁴⁸ turns a tick, and a difference of two is off by one at most: 1.4e-8 rev/s².
    let most = facts.commanded_hz_per_s();
    assert!(most <= root::LIMIT_HZ_PER_S + 1e-6, "{most} rev/s²");
    assert!(most > 0.999 * root::LIMIT_HZ_PER_S, "the limit is used");
    // Behind for as long as an even rise to √t takes: 28.2 √t = 60 t at 0.22 s. Jerk of 6000 rev/s³ costs 10 ms at either end.
    let behind_s = facts.behind_s().expect("it is reported");
    assert!((0.21..0.25).contains(&behind_s), "{behind_s} s");
    assert_eq!(facts.outcome.fault, None);
    assert_eq!(facts.outcome.state, State::Parked);
}

/// Were it wrong, a frame would not mind how long a shaft stays at its resonance, or a shaft stay longer than it must.
#[test]
fn a_band_crossed_slowly() {
    let facts = band::look(Size::Small).unwrap();
    // Theory of one mass: m R / (M + m) · 1/2ζ = 5.95 mm; harmonics and the weight of what is off rest add a few per cent.
    let theory_um = 5e-3 / 21.0 / (2.0 * 0.02) * 1e6;
    let off = facts.dwelling_um / theory_um - 1.0;
    assert!(
        off.abs() < 0.05,
        "{} µm, theory {theory_um}",
        facts.dwelling_um
    );
    for pair in facts.crossings.windows(2) {
        assert!(pair[0].frame_um > 1.2 * pair[1].frame_um, "{pair:?}");
    }
    assert!(facts.crossings[0].frame_um < facts.dwelling_um);
    // At 10.2 rev/s a mass without damping goes r²/(1 − r²) = 2.56 times m R / (M + m), in the beginning up to twice that.
    let edge_um = 2.0 * 2.56 * 5e-3 / 21.0 * 1e6;
    assert!(facts.held_um < edge_um, "{} µm", facts.held_um);
    assert!(
        edge_um < 0.25 * facts.dwelling_um,
        "the edge is no resonance"
    );
    let held_s = facts.held_s.expect("it is reported");
    assert!(held_s > 3.9, "{held_s} s");
    // The width at full acceleration, which is reached long before the band and left long after; and a tick at either end.
    for crossing in &facts.crossings {
        let width_hz = band::BAND_HZ.1 - band::BAND_HZ.0;
        let most_s = width_hz / crossing.hz_per_s + 1.1e-3;
        assert!(
            crossing.inside_s <= most_s,
            "{crossing:?}, at most {most_s} s"
        );
    }
}

/// Were it wrong, a motor that is too weak would hold all the same, or its slips be noticed late or by nobody.
#[test]
fn a_motor_that_pulls_out() {
    let strong = pull_out::look(1.0).unwrap().outcome;
    assert_eq!(strong.statistics.slipped_cycles, [0, 0, 0]);
    assert_eq!((strong.state, strong.fault), (State::Parked, None));

    let weak = pull_out::look(pull_out::WEAK).unwrap();
    let slipped = &weak.outcome.statistics.slipped_cycles;
    assert!(slipped[pull_out::WEAK_AXIS] < 0, "{slipped:?}");
    let slip_s = runs::first_slip_s(&weak.outcome).expect("it slips");
    let fault = weak.outcome.fault.expect("the drift monitor sees it");
    assert_eq!(fault.kind, FaultKind::Tilt);
    assert_eq!(fault.axis, Some(pull_out::WEAK_AXIS));
    // An index is heard once a turn, a tick later at the latest, and judged in the next.
    let heard_s = runs::fault_s(&weak.outcome).expect("it is an event") - slip_s;
    let turn_s = weak.turn_s(slip_s);
    assert!(
        heard_s > 0.0 && heard_s <= turn_s + 2.0 * pull_out::TICK_S,
        "{heard_s} s, a turn {turn_s} s"
    );
    assert_eq!(weak.outcome.state, State::Fault);

    // Beforehand: more is asked than there is.
    assert!(pull_out::torque_used(pull_out::WEAK).unwrap() > 1.0);
    assert!(pull_out::torque_used(1.0).unwrap() < 0.5);
    failed(&pull_out::scene("phased", pull_out::WEAK));
}

/// Were it wrong, a step past a method's limit would not diverge, or one below it would.
#[test]
fn a_stiff_chain_past_its_step() {
    let facts = chain::look(Size::Small).unwrap();
    // Published for steady turning: 0.125 mm. From rest the first turn is within what the slowest mode still remembers of it.
    assert!(
        (facts.true_m * 1e3 - 0.125).abs() < 0.0015,
        "{} m",
        facts.true_m
    );
    for tried in &facts.methods {
        for turn in &tried.turns {
            match tried.limit_s {
                Some(limit_s) if turn.step_s > 1.2 * limit_s => assert!(
                    turn.peak > 100.0,
                    "{}: {turn:?}, limit {limit_s}",
                    tried.scheme
                ),
                // Below its limit every method is of the size of the peak, if it still resolves the slowest mode.
                _ if turn.step_s < 140e-6 => assert!(
                    (0.8..1.25).contains(&turn.peak),
                    "{}: {turn:?}",
                    tried.scheme
                ),
                _ => assert!(
                    turn.peak.is_finite() && turn.diverged.is_none(),
                    "{}: {turn:?}",
                    tried.scheme
                ),
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
    // PHYSICS.md 3.4 item 6, for the chain as printed; the damper at the cam changes nothing of the matrix.
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
fn a_step_past_the_limit_is_refused() {
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
    // The same one step a tick is stable with what auto takes, and auto takes as many as show the peaks.
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
    let report = failed(diverging::SCENE);
    let warnings = report["warnings"].to_string();
    assert!(
        warnings.contains("diverged") && warnings.contains("implicit equation"),
        "{warnings}"
    );
    assert_eq!(report["ended"]["fault"], false);
    assert_ne!(report["ended"]["state"], "parked");
}

/// Were it wrong, rods would not ask anything of a crank that stands off, or a step that did for soft ones be run on stiff ones.
#[test]
fn stiffer_rods_under_four_cranks() {
    let facts = rods::look(Size::Small).unwrap();
    // One of four that is 1° off is 0.25° off the plane of all. Were rods rigid its motor would have to give all of that: 20 N·m
    // by the sine of 50 electrical cycles.
    let most_nm = 20.0 * (50.0 * 0.25_f64.to_radians()).sin();
    let bent_nm = |seen: &rods::Seen| seen.off_nm - seen.aligned_nm;
    for pair in facts.seen.windows(2) {
        assert!(bent_nm(&pair[1]) > bent_nm(&pair[0]), "{pair:?}");
        assert!(pair[1].steps > 2 * pair[0].steps, "{pair:?}");
        // A crank that is where it should be bends nothing, whatever the rods.
        let aligned = pair[1].aligned_nm / pair[0].aligned_nm;
        assert!((aligned - 1.0).abs() < 0.01, "{pair:?}");
    }
    let [soft, stiff, rigid] = facts.seen[..] else {
        panic!("{:?}", facts.seen);
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

/// Were it wrong, a machine that bends its rods would go on, and nobody be told that it is over-constrained.
#[test]
fn a_crank_that_bends_the_rods_is_stopped() {
    // One of four that is 1° off is 0.25° off the plane of all.
    for (limit_deg, fault) in [(0.2, Some(FaultKind::Warp)), (0.3, None)] {
        let text = rods::scene(rods::SOFT_N_PER_UM, 1.0, limit_deg, "");
        let outcome = runs::run(&text, &mut |_| {}).unwrap();
        assert_eq!(outcome.fault.map(|fault| fault.kind), fault, "{limit_deg}°");
        assert_eq!(
            outcome.state,
            if fault.is_some() {
                State::Fault
            } else {
                State::Parked
            }
        );
    }
    let report = failed(&rods::scene(rods::SOFT_N_PER_UM, 1.0, 0.2, ""));
    let left_out = report["fidelity"]["left_out"].to_string();
    assert!(left_out.contains("over-constrain"), "{left_out}");
}

/// Were it wrong, motors that all slip together would go unseen, as nothing tilts; or would not slip.
#[test]
fn five_times_the_load() {
    let sized = overload::look(overload::SIZED_KG).unwrap().outcome;
    assert_eq!(sized.statistics.slipped_cycles, [0, 0, 0]);
    assert_eq!((sized.state, sized.fault), (State::Parked, None));
    let over = overload::look(5.0 * overload::SIZED_KG).unwrap();
    let slip_s = runs::first_slip_s(&over.outcome).expect("they slip");
    let fault = over.outcome.fault.expect("the common lag is watched");
    assert_eq!(fault.kind, FaultKind::CommonLag);
    assert!(runs::fault_s(&over.outcome).expect("an event") > slip_s);
    assert_eq!(over.outcome.state, State::Fault);
    let worst = over
        .ahead_deg
        .iter()
        .fold(0.0_f64, |worst, (_, deg)| worst.max(deg.abs()));
    assert!(worst > overload::COMMON_LIMIT_DEG, "{worst}°");
    // Torque is in proportion to the load where rotors take little of it: the rung that compares torques says so beforehand.
    let used = overload::torque_used(overload::SIZED_KG).unwrap();
    assert!((0.5..0.6).contains(&used), "{used}");
    assert!(overload::torque_used(5.0 * overload::SIZED_KG).unwrap() > 1.0);
    failed(&overload::scene("phased", 5.0 * overload::SIZED_KG));
}

/// Were it wrong, a loop that takes five ticks for each would turn on, in phase and too slowly, or lose its phase.
#[test]
fn a_loop_five_times_too_slow() {
    let outcome = runs::run(&overload::slow_loop(), &mut |_| {}).unwrap();
    assert_eq!(
        outcome.fault.map(|fault| fault.kind),
        Some(FaultKind::Overrun)
    );
    assert_eq!(outcome.state, State::Fault);
    assert!(outcome.statistics.missed_deadlines >= 3);
    assert_eq!(outcome.statistics.worst_spread_deg, 0.0);
    failed(&overload::slow_loop());
}

/// PHYSICS.md 1.6 item 7. Were it wrong, two terms would pass for the mechanism, or a mechanism be run that is not built.
#[test]
fn lambda_at_both_ends() {
    for (ratio, published_percent) in [(0.1, 0.046), (0.6, 9.375)] {
        let facts = lambda::look(ratio).unwrap();
        // Half of the last digit that is published.
        assert!(
            (facts.error * 100.0 - published_percent).abs() <= 5e-4,
            "{facts:?}"
        );
        let from_90 = (facts.at_deg.rem_euclid(180.0) - 90.0).abs();
        assert!(from_90 < 0.01, "{facts:?}");
        assert_eq!(runs::refusal(&lambda::scene(ratio)), None);
    }
    for ratio in [0.05, 0.7] {
        let said = refused(&lambda::scene(ratio));
        assert!(
            said.contains("machine.lambda") && said.contains("0.1 to 0.6"),
            "{said}"
        );
    }
}

/// Were it wrong, the chart would lack a panel, or be another each time.
#[test]
fn the_chart_has_all_panels() {
    let chart = find("breakdown").expect("it is a chart");
    let draw = || (chart.draw)(Size::Small, &mut |_, _| {}).unwrap();
    let (one, other) = (draw(), draw());
    assert_eq!((&one.csv, &one.svg), (&other.csv, &other.svg));
    let mut panels: Vec<String> = csv::Reader::from_reader(one.csv.as_bytes())
        .records()
        .map(|record| record.unwrap()[0].to_owned())
        .collect();
    panels.dedup();
    assert_eq!(
        panels,
        [
            "root", "band", "pull-out", "chain", "rods", "overload", "lambda"
        ]
    );
    for part in 1..=7 {
        assert!(one.says.contains(&format!("({part})")), "{}", one.says);
    }
}
