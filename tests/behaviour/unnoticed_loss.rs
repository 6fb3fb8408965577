//! Shafts that end away from their commands, unnoticed by the controller. Such a run has not ended as it should: its report warns, and its
//! exit status is 1.

use cophase_files::trace::{Every, Window};
use cophase_tests::{Run, SceneBuilder, bench_scene, built_in, built_in_scene, record};

fn run(scene: &SceneBuilder) -> Run {
    record(&scene.checked(), Every::Ticks(8), Window::FirstMotion)
}

fn warnings(run: &Run) -> String {
    run.report["warnings"].to_string()
}

fn slipped_cycles(run: &Run, axis: usize) -> i64 {
    run.report["axes"][axis]["slipped_cycles"].as_i64().unwrap()
}

/// Four steppers with an index each, of which one loses cycles while the program runs.
fn steppers(level: &str, cycles: u32) -> SceneBuilder {
    bench_scene()
        .set("fidelity", level)
        .with(
            r#"
machine = { crank_radius_mm = 20, load_kg = 1 }
limits = { speed_hz = 9, acceleration_hz_per_s = 24, jerk_hz_per_s2 = 288, homing_speed_hz = 2 }
axes = { count = 4, rotor_inertia_kgm2 = 1e-3, damping_nms = 0.2, pull_out = [[0, 40], [20, 40]] }
correction = { gain = 0 }
"#,
        )
        .program([(4.0, 0.6, 2.0)])
        .with(&format!(
            "fault = [{{ at_s = 2.0, kind = \"lost-steps\", axis = 1, cycles = {cycles} }}]"
        ))
}

/// If this fails, an arm that friction holds looks like one that works, as its path ends where it begins.
#[test]
fn arm_that_stands_is_warned_of() {
    let held = built_in_scene("five-bar")
        .set("axes.friction_nm", 50)
        .with("[[program]]\nramp_s = 1\nhold_s = 19");
    let held = run(&held);
    assert!(
        warnings(&held).contains("made less than half of its commanded motion"),
        "{}",
        warnings(&held)
    );
}

/// If this fails, a crank that is a whole turn behind looks like one in place. Its index shows the same again, so only the simulator knows.
#[test]
fn whole_lost_turn_is_counted_and_warned_of() {
    for level in ["kinematic", "phased"] {
        let lost = run(&steppers(level, 50));
        assert!(lost.report["faults"].as_array().unwrap().is_empty());
        assert_eq!(slipped_cycles(&lost, 1), -50, "{level}");
        assert_eq!(slipped_cycles(&lost, 0), 0, "{level}");
        assert!(lost.outcome.went_wrong(), "{level}");
        let expected = "Axis 1 ended 1.00 turns behind its command (50 electrical cycles)";
        assert!(warnings(&lost).contains(expected), "{}", warnings(&lost));
    }
}

/// If this fails, a loss that the controller found and stopped for is warned of as unnoticed.
#[test]
fn loss_that_the_controller_reports_is_no_unnoticed_one() {
    let lost = run(&steppers("kinematic", 1));
    assert_eq!(slipped_cycles(&lost, 1), -1);
    assert!(lost.outcome.went_wrong(), "it ended in a fault");
    assert!(
        !warnings(&lost).contains("did not notice"),
        "{}",
        warnings(&lost)
    );
}

/// Two shafts of a screen without sensors, whose motors lift no block.
fn stuck_screen() -> SceneBuilder {
    bench_scene()
        .without("machine")
        .with(r#"
fidelity = "phased"
control = { settle_s = 0.01, park_deg = 270 }
limits = { speed_hz = 7.8, acceleration_hz_per_s = 3.2, jerk_hz_per_s2 = 38, homing_speed_hz = 0.95 }
drift = { common_limit_deg = 90 }
[screen]
box_kg = 328
length_mm = 1350
block_kg = 4.4
eccentricity_mm = 40
shafts_mm = [-450, 450]
stiffness_n_per_mm = 75
allow_capture = true
[axes]
count = 2
drive = "pulse-servo"
steps_per_turn = 6400
index = false
rotor_inertia_kgm2 = 0.035
servo = { position_gain_per_s = 37, velocity_gain_nms = 9.4, limit_nm = 1.5 }
"#)
        .program([(0.2, 2.0, 1.0)])
}

/// If this fails, a machine whose shafts never turned seems to have run its program.
#[test]
fn shafts_that_never_turn_are_warned_of() {
    let stuck = run(&stuck_screen());
    assert!(stuck.outcome.fault.is_none(), "no sensor could show it");
    assert!(
        stuck.report["axes"][0]["actual_turns"]
            .as_f64()
            .unwrap()
            .abs()
            < 0.5
    );
    assert!(stuck.outcome.went_wrong());
    for axis in ["Axis 0 ended", "Axis 1 ended"] {
        assert!(warnings(&stuck).contains(axis), "{}", warnings(&stuck));
    }
}

/// If this fails, a crusher that rock has stopped for good, with a drive without an alarm and without sensors, seems to have parked.
#[test]
fn crusher_that_stays_stalled_is_warned_of() {
    let stalled = built_in_scene("jaw-crusher")
        .set("crusher.rock_kn", 4000)
        .without("axes.induction.following_error_deg")
        .set("axes.index", false);
    let stalled = run(&stalled);
    assert!(stalled.outcome.fault.is_none());
    assert!(stalled.outcome.went_wrong());
    assert!(
        warnings(&stalled).contains("Axis 0 ended"),
        "{}",
        warnings(&stalled)
    );
}

/// If this fails, ordinary lags are taken for losses: servos without feed-forward lag by turns at speed and by half a turn at homing, and
/// cranks stand off their place at power-up.
#[test]
fn lags_at_speed_and_errors_at_power_up_are_no_losses() {
    // The shafts reach their places seconds after the master stands, so the run goes on.
    let servos = bench_scene()
        .with(
            r#"
fidelity = "phased"
machine = { crank_radius_mm = 20, load_kg = 1 }
control = { settle_s = 1 }
limits = { speed_hz = 9, acceleration_hz_per_s = 6, jerk_hz_per_s2 = 60, homing_speed_hz = 2 }
command = [{ at_s = 0, do = "start" }, { at_s = 15, do = "reset-peak" }]
[axes]
drive = "pulse-servo"
steps_per_turn = 4000
index = false
rotor_inertia_kgm2 = 1e-3
servo = { position_gain_per_s = 4, velocity_gain_nms = 2, velocity_feed_forward = 0 }
"#,
        )
        .axis(1, "start_deg", 40)
        .program([(4.0, 0.6, 2.0)]);
    let lagged = run(&servos);
    assert!(!lagged.outcome.went_wrong(), "{}", warnings(&lagged));
    for name in [
        "default",
        "pulse-servo",
        "five-bar",
        "jaw-crusher",
        "screen",
        "wrapper",
    ] {
        let run = record(&built_in(name), Every::Ticks(8), Window::FirstMotion);
        assert!(!run.outcome.went_wrong(), "{name}: {}", warnings(&run));
    }
}
