//! A vibrating screen under the control loop: it crosses its resonance without dwelling there, reaches the amplitude of its throw, and a
//! motor that is too weak to pass is reported.

use std::f64::consts::TAU;

use cophase_tests::{Run, built_in, record, scene};
use host_sim::scene::library;
use host_sim::trace::{Every, Window};

/// Masses, springs and blocks of the scene.
const MASS_KG: f64 = 2900.0 + 2.0 * 83.0;
const MOMENT_KGM: f64 = 2.0 * 83.0 * 0.08727;
const STIFFNESS_N_PER_M: f64 = 1285.5e3;

/// The scene with torque, and with each line of it that is named replaced by another.
fn with(changes: &[(&str, &str)]) -> Run {
    let text = library::find("screen").unwrap().text;
    let text = text.replacen("[screen]", "fidelity = \"phased\"\n[screen]", 1);
    let text = changes.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    record(&scene(&text), Every::Ticks(1), Window::FirstMotion)
}

/// If this fails, the band is not that of the scene's own resonance, or the shafts dwell in it.
#[test]
fn the_resonance_is_crossed_and_not_dwelt_in() {
    let run = record(&built_in("screen"), Every::Ticks(1), Window::FirstMotion);
    let natural_hz = (STIFFNESS_N_PER_M / MASS_KG).sqrt() / TAU;
    let band = &run.report["scene"]["limits"]["band"][0];
    let edge = |name: &str| band[name].as_f64().unwrap() / natural_hz;
    // Twice the throw: r² = 2 |1 − r²|.
    assert!((edge("from_hz") - (2.0_f64 / 3.0).sqrt()).abs() < 1e-9);
    assert!((edge("to_hz") - 2.0_f64.sqrt()).abs() < 1e-9);
    let trace = run.trace();
    let (omega, t_s) = (trace.column("omega_rad_s"), trace.column("t_s"));
    let inside = (0..trace.rows()).filter(|&row| {
        (edge("from_hz") * natural_hz..edge("to_hz") * natural_hz)
            .contains(&(omega[row].abs() / TAU))
    });
    // Up and down, at 8 rev/s² with jerk at both ends.
    let inside_s = inside.count() as f64 * (t_s[1] - t_s[0]);
    let width_hz = (edge("to_hz") - edge("from_hz")) * natural_hz;
    assert!(
        inside_s < 2.0 * 1.3 * width_hz / 8.0,
        "{inside_s} s in the band"
    );
}

/// If this fails, the box moves by something else than what its blocks throw. What the run-up has left of free motion decays with ζ ω = 1.43 per
/// second, so that two seconds of hold leave 6 % of it.
#[test]
fn the_box_moves_by_its_throw() {
    let run = with(&[("hold_s = 1", "hold_s = 4")]);
    assert!(run.report["faults"].as_array().unwrap().is_empty());
    let trace = run.trace();
    let (omega, z_m) = (trace.column("omega_rad_s"), trace.column("z_m"));
    let top = omega.iter().copied().fold(0.0, f64::max);
    let steady: Vec<usize> = (0..trace.rows())
        .filter(|&row| omega[row] > top * (1.0 - 1e-9))
        .collect();
    let last_second = &steady[steady.len() - 2000..];
    let most_m = last_second
        .iter()
        .map(|&row| z_m[row].abs())
        .fold(0.0, f64::max);
    let amplitude_m = MOMENT_KGM * top * top / (MASS_KG * top * top - STIFFNESS_N_PER_M);
    assert!(
        (most_m / amplitude_m - 1.0).abs() < 0.03,
        "{most_m} m, not {amplitude_m}"
    );
}

/// If this fails, a screen that hangs in its resonance looks like one that works: without sensors nothing stops it, and the report must name
/// the capture. With index sensors the controller must stop it.
#[test]
fn capture_is_reported_and_stopped() {
    let weak = ("limit_nm = 700, following_error_deg = 30", "limit_nm = 100");
    let long = ("hold_s = 1", "hold_s = 3");
    let blind = (
        "steps_per_turn = 2000",
        "steps_per_turn = 2000\nindex = false",
    );
    let run = with(&[weak, long, blind]);
    let captured_hz = run.report["machine_figures"]["captured_hz"].as_f64();
    let natural_hz = (STIFFNESS_N_PER_M / MASS_KG).sqrt() / TAU;
    let captured = captured_hz.expect("the capture is reported") / natural_hz;
    assert!((0.7..1.42).contains(&captured), "{captured}");
    let warnings = run.report["warnings"].to_string();
    assert!(warnings.contains("captured at its resonance"), "{warnings}");

    let run = with(&[weak, long]);
    let faults = run.report["faults"].as_array().unwrap();
    let kind = faults.first().expect("the controller stops")["kind"].as_str();
    assert!(
        matches!(
            kind,
            Some("common-lag" | "slip" | "index-timeout" | "stuck")
        ),
        "{kind:?}"
    );

    // A motor with enough torque passes.
    let run = with(&[]);
    assert!(run.report["machine_figures"]["captured_hz"].is_null());
}

/// If this fails, two shafts that nothing but the controller couples are not kept in phase where their friction differs.
#[test]
fn the_controller_keeps_two_shafts_in_phase() {
    let unequal = (
        "[[program]]",
        "[[axis]]\nnumber = 1\nfriction_nm = 60\n\n[[program]]",
    );
    let run = with(&[unequal]);
    let spread_deg = run.report["phase_spread_worst_deg"].as_f64().unwrap();
    // 58 N·m on 40/s · 700 N·m·s are 0.12°, and the blocks' weight passes through both alike.
    assert!((0.05..1.0).contains(&spread_deg), "{spread_deg}°");
    assert!(run.report["faults"].as_array().unwrap().is_empty());
}

/// If this fails, the screen of the source, which has one shaft, does not run.
#[test]
fn one_shaft_runs() {
    let run = with(&[
        ("count = 2", "count = 1"),
        ("[-600, 600]", "[0]"),
        ("block_kg = 83 ", "block_kg = 166 "),
        ("limit_nm = 700", "limit_nm = 1400"),
    ]);
    assert!(run.report["faults"].as_array().unwrap().is_empty());
    let working = run.report["machine_figures"]["displacement_working_mm"].as_f64();
    // Throw of 4.725 mm, and what the run-up has left of free motion.
    assert!((4.7..8.0).contains(&working.unwrap()), "{working:?}");
}
