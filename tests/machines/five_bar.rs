//! A five-bar arm under the control loop: the program is a path, the joints follow cam tables, and the hand presses against a surface.

use std::f64::consts::TAU;

use cophase_tests::scripted::fault;
use cophase_tests::{SceneBuilder, built_in_scene};

fn arm() -> SceneBuilder {
    built_in_scene("five-bar").with("[[program]]\nramp_s = 1\nhold_s = 21")
}

/// Hand of the assumed arm at joint angles in turns, m.
fn hand_m(turns: [f64; 2]) -> [f64; 2] {
    let [(sin_1, cos_1), (sin_2, cos_2)] = turns.map(|turns| (turns * TAU).sin_cos());
    [0.25 * (cos_1 + cos_2), 0.25 * (sin_1 + sin_2)]
}

/// If this fails, the joints' cam tables do not lead the hand along the line at its speed: 200 mm in 10 s with blends of 0.5 s, there and
/// back.
#[test]
fn joints_lead_the_hand_along_the_line() {
    let run = arm().set("fidelity", "kinematic").run();
    assert!(run.report["faults"].as_array().unwrap().is_empty());
    let trace = run.trace();
    let (one, two) = (
        trace.column("actual_turns_0"),
        trace.column("actual_turns_1"),
    );
    let (t_s, omega) = (trace.column("t_s"), trace.column("omega_rad_s"));
    let hand = |row: usize| hand_m([one[row], two[row]]);
    // A step is 1/20000 turn: 0.11 mm of the hand by both joints.
    let step_m = 2.0 * 0.25 * TAU / 20_000.0;
    let top = omega.iter().copied().fold(0.0, f64::max);
    assert!((top * 20.0 / TAU - 1.0).abs() < 1e-4, "{top} rad/s");
    let (mut min, mut max) = (f64::MAX, f64::MIN);
    for row in 0..trace.rows() {
        let [x, y] = hand(row);
        assert!((y - 0.3).abs() < step_m, "row {row}: {y}");
        min = min.min(x);
        max = max.max(x);
    }
    assert!(
        min.abs() < step_m && (max - 0.2).abs() < step_m,
        "{min} to {max} m"
    );
    // Half a second in the middle of the line.
    let from = (0..trace.rows())
        .find(|&row| omega[row] > top * (1.0 - 1e-9) && hand(row)[0] > 0.08)
        .unwrap();
    let to = (from..trace.rows())
        .find(|&row| t_s[row] >= t_s[from] + 0.5)
        .unwrap();
    let speed = (hand(to)[0] - hand(from)[0]) / (t_s[to] - t_s[from]);
    assert!((speed / 0.021_052_6 - 1.0).abs() < 0.01, "{speed} m/s");
    assert!(run.figure("table_error_mm").unwrap() < 2e-3);
}

/// Force at the hand by which the friction of a joint that turns back changes, N.
const REVERSAL_N: f64 = 2.0 * 0.02 / 0.25;

/// If this fails, the hand does not press as required, or the suspension costs more than its side pull. The rope is vertical in the middle
/// of the line, and pulls by 19.62 N · 0.1 m / 1 m at its ends.
#[test]
fn hand_presses_while_it_follows_the_line() {
    let hung = arm().run();
    assert!(hung.report["faults"].as_array().unwrap().is_empty());
    // A joint that turns back takes its friction along: 2 · 0.02 N·m on a link of 0.25 m. A step of the source's force sensor is
    // 9.58 mN, and nothing else is left without friction.
    assert!(hung.figure("force_error_n").unwrap() < REVERSAL_N);
    let smooth = arm().set("axes.friction_nm", 0).run();
    assert!(smooth.figure("force_error_n").unwrap() < 0.02);
    let place_mm = hung.figure("place_error_mm").unwrap();
    // The law's stiffness along the line is its position gain times the mass that acts at the hand there. The load is 1.962 N · 0.25 m over
    // both joints.
    assert!((0.3..1.0).contains(&place_mm), "{place_mm} mm");
    let free = arm().set("five_bar.lift_n", 0).run();
    let free_mm = free.figure("place_error_mm").unwrap();
    println!("on the rope {place_mm:.3} mm, without it {free_mm:.3} mm");
    assert!(free_mm < 0.2 * place_mm);
}

/// If this fails, the errors do not grow with the joints' friction. The suspension exists to reduce that friction.
#[test]
fn friction_increases_position_and_force_errors() {
    let light = arm().set("five_bar.lift_n", 0).run();
    let heavy = arm()
        .set("five_bar.lift_n", 0)
        .set("axes.friction_nm", 0.3)
        .run();
    for key in ["place_error_mm", "force_error_n"] {
        let (light, heavy) = (light.figure(key).unwrap(), heavy.figure(key).unwrap());
        println!("{key}: {light:.4} with 0.02 N·m, {heavy:.4} with 0.30");
        assert!(heavy > 3.0 * light, "{key}");
    }
}

/// If this fails, drives with their own loops do not hold the arm on its path where there is no surface.
#[test]
fn drives_hold_the_path_without_a_surface() {
    let run = arm().without("five_bar.contact").run();
    assert!(run.report["machine_figures"]["force_error_n"].is_null());
    // 1.96 N · 0.29 m on 30/s · 20 N·m·s/rad are 0.95 mrad, 0.24 mm of the hand.
    assert!(run.figure("place_error_mm").unwrap() < 0.3);
}

/// If this fails, a force that the law's sensor cannot measure is accepted: the law winds up, and the hand leaves its path.
#[test]
fn force_beyond_the_sensor_is_refused_with_the_fix() {
    for force in ["19.62", "20", "100"] {
        let machine = arm().with(&format!("five_bar.contact.force_n = {force}"));
        let error = machine.refused();
        for words in [
            "five_bar.contact.force_n",
            force,
            "sensor_n = 19.62",
            "wider range",
        ] {
            assert!(error.contains(words), "{error}");
        }
    }
}

/// If this fails, a sensor of a wider range does not let the law hold a larger force.
#[test]
fn wider_sensor_holds_a_larger_force() {
    let run = arm()
        .with("five_bar.contact = { force_n = 20, sensor_n = 50 }")
        .run();
    // A step of the converter is 24 mN.
    assert!(run.figure("force_error_n").unwrap() < REVERSAL_N + 0.05);
    assert!(run.figure("place_error_mm").unwrap() < 1.0);
    assert_eq!(run.figure("sensor_saturated_s").unwrap(), 0.0);
    let warnings = run.report["warnings"].to_string();
    assert!(!warnings.contains("left its path"), "{warnings}");
}

/// If this fails, a run in which the force left the range of its sensor, or the hand its path, looks like one without a problem. A torque
/// on one joint pushes the hand into the surface and along it.
#[test]
fn saturated_sensor_and_a_hand_off_its_path_are_warned_of() {
    let push = fault("load-step", 4.0, "axis = 0\ntorque_nm = 8\nfor_s = 1.0");
    let run = arm().with(&push).run();
    let warnings = run.report["warnings"].to_string();
    assert!(
        warnings.contains("beyond the range of its sensor"),
        "{warnings}"
    );
    assert!(run.figure("sensor_saturated_s").unwrap() > 0.01);
    assert!(warnings.contains("The hand left its path"), "{warnings}");
}
