//! Servo drives on STEP and DIR: the edges that they count, how they follow, and when they raise their alarm.
//!
//! The references are independent of the simulation: edges are counted in `steps.vcd`, and following errors are those of the
//! loop's transfer function. With the position gain g, the velocity gain k and the share f of velocity feed-forward, the drive
//! gives the torque T = k (f φ′ + g (φ − α) − α′). At a steady speed ω the error is therefore φ − α = (1 − f) ω/g + T/(k g).

use std::f64::consts::TAU;

use cophase_files::trace::{Every, Window};
use cophase_tests::scripted::fault;
use cophase_tests::{Run, SceneBuilder, built_in, built_in_scene, record};

const SCENE: &str = "pulse-servo";
/// Counts per turn, and control tick, of that scene.
const COUNTS: f64 = 4000.0;
const TICK_S: f64 = 5e-4;
/// Its gains: position, 1/s, and velocity, N·m·s.
const G_PER_S: f64 = 100.0;
const K_NMS: f64 = 0.5;

/// The scene on a model level, with faults and commands.
fn on(model_level: &str, more: &str) -> SceneBuilder {
    built_in_scene(SCENE)
        .set("fidelity", model_level)
        .with(more)
}

fn run(machine: &SceneBuilder) -> Run {
    record(&machine.checked(), Every::Ticks(1), Window::All)
}

/// Command minus actual position of an axis in each row, turns.
fn following_turns(run: &Run, axis: usize) -> Vec<f64> {
    let trace = run.trace();
    let command = trace.axis("command_turns", axis);
    let actual = trace.axis("actual_turns", axis);
    command.iter().zip(actual).map(|(c, a)| c - a).collect()
}

/// If this fails, a drive does not count the edges on its wires, and its crank is off permanently.
#[test]
fn final_crank_positions_match_the_step_edges() {
    let checked = built_in(SCENE);
    let run = record(&checked, Every::Ticks(1), Window::All);
    let (trace, edges) = (run.trace(), run.edges());
    run.assert_parked();
    assert_eq!(run.report["faults"].as_array().map(Vec::len), Some(0));
    // The integral holds the friction of 0.1 N·m. When it has settled, a hundredth of the error under that friction is left.
    let settled_turns = 0.01 * 0.1 / (K_NMS * G_PER_S) / TAU;
    for axis in 0..3 {
        let counts = edges.steps(axis, axis == 2);
        assert!(counts > 20_000, "axis {axis} moves");
        let last = |name| *trace.axis(name, axis).last().expect("a row");
        assert_eq!(last("steps") as i64, counts, "axis {axis}");
        let off = last("actual_turns") - counts as f64 / COUNTS;
        // The edges are made from the commanded phase. Between two edges the command is up to a count from the last edge.
        assert!(
            off.abs() < 1.0 / COUNTS + settled_turns,
            "axis {axis}: {off} turns"
        );
    }
    // Where cranks are at their commanded positions, counts and edges are equal.
    let kinematic = self::run(&on("kinematic", ""));
    for axis in 0..3 {
        let counts = kinematic.edges().steps(axis, axis == 2);
        let trace = kinematic.trace();
        let actual = trace.axis("actual_turns", axis).last().copied();
        assert_eq!(actual, Some(counts as f64 / COUNTS), "axis {axis}");
    }
}

/// If this fails, a scene cannot give the lag of its cranks, or `drift.lag_us` cannot be computed from the drive's parameters.
#[test]
fn steady_following_error_matches_the_loop_gains() {
    for feed_forward in [0.0, 0.5, 0.9, 1.0] {
        for integral in [true, false] {
            let machine = on("phased", "")
                .set("axes.servo.velocity_feed_forward", feed_forward)
                .set("axes.servo.following_error_deg", 90)
                // The cranks lag by up to 54°. No limit of the loop is made for such cranks.
                .without("axes.index_width_deg")
                .set("axes.index", false)
                // The load's torque oscillates about zero twice a turn. With a light load, the mean is the loop's.
                .set("machine.load_kg", 0.5);
            let run = self::run(&match integral {
                true => machine,
                false => machine.without("axes.servo.integral_s"),
            });
            run.assert_parked();
            let trace = run.trace();
            // The last 0.4 s of the upper level, and only whole turns of it, so that the load's torque averages out.
            let requested = trace.column("amax_requested_mps2");
            let max = requested.iter().copied().fold(0.0, f64::max);
            let held = requested.iter().rposition(|&amax| amax == max);
            let to = held.expect("a level") - 1;
            let turns = trace.axis("actual_turns", 1);
            let whole = (turns[to] - turns[to - 800]).floor();
            let from = turns.partition_point(|&turn| turn < turns[to] - whole);
            let errors = &following_turns(&run, 1)[from..to];
            let mean_rad = TAU * errors.iter().sum::<f64>() / errors.len() as f64;

            // The edges give the speed.
            let between = (from as u64 * 500_000)..(to as u64 * 500_000);
            let edges = run.edges();
            let rises = edges.wire("step_1").rises();
            let counted = rises.filter(|at| between.contains(at)).count();
            let omega = TAU * counted as f64 / COUNTS / ((to - from) as f64 * TICK_S);
            assert!(omega > 80.0, "{omega} rad/s");
            // Friction is 0.1 N·m, and an integral supplies all of it.
            let friction_nm = if integral { 0.0 } else { 0.1 };
            let expected_rad =
                (1.0 - feed_forward) * omega / G_PER_S + friction_nm / (K_NMS * G_PER_S);
            // One edge more or less in 0.4 s, and whole turns that end within a tick: 1e-3 of the lag, and 1e-4 rad.
            assert!(
                (mean_rad - expected_rad).abs() < 1e-3 * expected_rad + 1e-4,
                "{feed_forward}, integral: {integral}: {mean_rad} rad, not {expected_rad}"
            );
        }
    }
}

/// The row in which the following error of an axis first exceeds the window, by the trace alone.
fn first_beyond(run: &Run, axis: usize, window_deg: f64) -> Option<usize> {
    let errors = following_turns(run, axis);
    errors.iter().position(|e| e.abs() > window_deg / 360.0)
}

/// If this fails, the alarm comes before the window or after it, or for another axis.
///
/// A stuck crank stays behind by the travel of its command. An overloaded crank is dragged off. The alarm is read with the end of
/// the tick in which the error passes the window.
#[test]
fn alarm_occurs_at_the_following_error_window() {
    let stuck = "[[fault]]\nat_s = 1.5\nkind = \"stuck\"\naxis = 1\n";
    let load =
        "[[fault]]\nat_s = 1.5\nkind = \"load-step\"\naxis = 1\ntorque_nm = 13\nfor_s = 0.05\n";
    for (model_level, fault) in [("kinematic", stuck), ("phased", load), ("phased", stuck)] {
        for window_deg in [15.0, 30.0] {
            let machine = on(model_level, fault);
            let run = run(&machine.set("axes.servo.following_error_deg", window_deg));
            let row = first_beyond(&run, 1, window_deg).expect("it goes beyond the window");
            let first = &run.report["faults"][0];
            assert_eq!(first["kind"], "drive-alarm", "{model_level}, {window_deg}°");
            assert_eq!(first["axis"], 1);
            let end_s = run.trace().column("t_s")[row] + TICK_S;
            let t_s = first["t_s"].as_f64().expect("a time");
            assert!(
                (t_s - end_s).abs() < 1e-9,
                "{model_level}, {window_deg}°: {t_s} s, not {end_s}"
            );
            for other in [0, 2] {
                let before = &following_turns(&run, other)[..row];
                assert!(before.iter().all(|e| e.abs() < window_deg / 360.0));
            }
        }
    }
}

/// If this fails, a window just above the error of a lasting load raises the alarm, or one just below does not. A lasting load T
/// is held by an error of T/(k g) where the loop has no integral.
#[test]
fn load_within_the_window_raises_no_alarm() {
    let torque_nm = 6.0;
    let error_deg = torque_nm / (K_NMS * G_PER_S) / TAU * 360.0;
    // The loop is far from resonance: its damping ratio is above 1, so the step of load overshoots nowhere. A light load at a low
    // speed adds less than half a degree, friction a tenth.
    for (window_deg, is_beyond) in [(error_deg + 1.0, false), (error_deg - 1.0, true)] {
        let fault = format!(
            "[[fault]]\nat_s = 0.8\nkind = \"load-step\"\naxis = 1\ntorque_nm = {torque_nm}\nfor_s = 0.2\n"
        );
        let machine = on("phased", &fault)
            .without("axes.servo.integral_s")
            .set("axes.servo.velocity_feed_forward", 1)
            .set("axes.servo.following_error_deg", window_deg)
            .without("drift.lag_us")
            .with("drift = { tilt_limit_mrad = 50, warp_limit_deg = 50 }")
            .set("machine.load_kg", 0.5)
            .program([(1.0, 0.5, 0.2), (1.0, 0.5, 0.6)]);
        let run = run(&machine);
        let alarms = run.report["faults"].as_array().expect("a list");
        assert_eq!(
            alarms.len(),
            usize::from(is_beyond),
            "{window_deg}°: {alarms:?}"
        );
        assert!(alarms.iter().all(|fault| fault["kind"] == "drive-alarm"));
    }
}

/// If this fails, one axis stops while the others go on, the drives are cut while the machine turns, or an alarm stays on without
/// end.
#[test]
fn alarm_stops_all_axes_in_phase() {
    let fault = "[[fault]]\nat_s = 1.5\nkind = \"load-step\"\naxis = 1\ntorque_nm = 13\nfor_s = 0.05\n\
                 [[command]]\nat_s = 0\ndo = \"start\"\n[[command]]\nat_s = 3\ndo = \"reset\"\n\
                 [[command]]\nat_s = 3.1\ndo = \"start\"\n";
    let run = run(&on("phased", fault));
    let faults = run.report["faults"].as_array().expect("a list");
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert_eq!(faults[0]["kind"], "drive-alarm");
    let trace = run.trace();
    let (stop, fault) = (trace.first("stop"), trace.first("fault"));
    assert!(
        stop.end == fault.start && stop.len() > 100,
        "{stop:?}, {fault:?}"
    );
    for row in stop.clone() {
        for axis in [1, 2] {
            assert_eq!(
                trace.axis("command_turns", axis)[row],
                trace.axis("command_turns", 0)[row],
                "row {row}"
            );
        }
    }
    // All cranks have followed by the time the drives go off. The remaining error is the lag of the last ticks and the rest of the
    // load's effect.
    for axis in 0..3 {
        let off = following_turns(&run, axis)[stop.end - 1] * 360.0;
        assert!(off.abs() < 1.0, "axis {axis} stands {off}° off");
    }
    let speed = trace.column("omega_rad_s");
    let max = TAU * 40.0 * TICK_S;
    for row in stop.start + 1..stop.end {
        assert!(
            (speed[row] - speed[row - 1]).abs() <= max + 2e-6,
            "row {row}"
        );
    }
    let (first, last) = (speed[stop.start], speed[stop.end - 1]);
    assert!(first > 60.0 && last < 1.0, "from {first} to {last} rad/s");
    run.assert_parked();
}

/// If this fails, a drive that was cut at speed jumps back by the distance that its crank coasted, as soon as it is on again.
#[test]
fn reenabled_drive_counts_from_the_actual_crank_position() {
    let cut = "[[fault]]\nat_s = 1.5\nkind = \"enable-loss\"\nfor_s = 1\n\
               [[command]]\nat_s = 0\ndo = \"start\"\n[[command]]\nat_s = 3\ndo = \"reset\"\n\
               [[command]]\nat_s = 3.1\ndo = \"start\"\n";
    for more in ["", "[noise]\nload_nm = 0.001\n"] {
        let run = run(&on("phased", &format!("{cut}{more}")));
        let kinds = run.report["faults"].as_array().expect("a list");
        assert!(
            kinds.iter().all(|fault| fault["kind"] != "drive-alarm"),
            "{kinds:?}"
        );
        let trace = run.trace();
        let at = |s: f64| trace.column("t_s").partition_point(|&t| t < s);
        for axis in 0..3 {
            let actual = trace.axis("actual_turns", axis);
            let coasted = actual[at(2.9)] - trace.axis("command_turns", axis)[at(2.9)];
            assert!(coasted.abs() > 0.1, "axis {axis}: {coasted} turns");
            // The crank has nearly come to rest. With the drive on, it moves no more than that in the 20 ms in which the drives
            // settle.
            let moved = actual[at(3.118)] - actual[at(3.1)];
            assert!(moved.abs() < 1e-3, "axis {axis} jumps by {moved} turns");
        }
    }
}

/// If this fails, a crank of a servo is reported to have lost steps, although a servo drive does not lose steps.
#[test]
fn servo_slip_is_not_reported_as_lost_steps() {
    // 7.2°, four full steps of 1.8°, in one tick.
    let slip = "[[fault]]\nat_s = 1.5\nkind = \"slip\"\naxis = 1\nrate_deg_per_s = 14400\nfor_s = 0.0005\n";
    let named = |machine: &SceneBuilder| {
        let run = run(machine);
        let last = run.report["faults"].as_array().and_then(|all| all.last());
        last.and_then(|fault| fault["kind"].as_str().map(str::to_owned))
    };
    assert_eq!(named(&on("kinematic", slip)).as_deref(), Some("slip"));
    let stepper = on("kinematic", slip)
        .without("axes.servo")
        .set("axes.drive", "stepper")
        .set("drift.lag_us", 0);
    assert_eq!(named(&stepper).as_deref(), Some("lost-steps"));
}

/// If this fails, a scene accepts settings and faults that do not apply to such a drive.
#[test]
fn inapplicable_settings_and_faults_are_refused_by_name() {
    let lost = on("kinematic", &fault("lost-steps", 1.0, "axis = 1"));
    let coupled = on("kinematic", "correction.couple = true").set("axes.encoder", true);
    let damped = built_in_scene(SCENE)
        .without("axes.friction_nm")
        .set("axes.damping_nms", 0.1);
    let pulled = built_in_scene(SCENE)
        .without("axes.friction_nm")
        .with("axes.pull_out = [[0, 5.0]]");
    let swapped = fault(
        "swapped-wiring",
        0.0,
        "axis = 0\nwith = 1\nlines = \"drive\"",
    );
    let swapped = on("kinematic", &swapped).axis(1, "drive", "servo");
    for (machine, key, said) in [
        (lost, "fault[0].axis", "is a servo"),
        (coupled, "correction.", "encoder"),
        (damped, "axes.damping_nms", "no axis here is a stepper"),
        (pulled, "axes.pull_out", "no axis here is a stepper"),
        (swapped, "fault[0].with", "takes pulses"),
    ] {
        let refused = machine.refused();
        assert!(refused.contains(key) && refused.contains(said), "{refused}");
    }
}

/// If this fails, the board refuses the drives that this scene shows, or accepts encoders, for which it has no pins.
#[test]
fn board_accepts_the_scene_and_refuses_encoders() {
    use cophase_link::board::{Rp2040, Unfit, check};
    let mut settings = built_in(SCENE).settings;
    assert_eq!(check::<Rp2040>(&settings), Ok(()));
    settings.axes[1].encoder = true;
    assert_eq!(check::<Rp2040>(&settings), Err(Unfit::Encoder(1)));
    settings.axes[1].encoder = false;
    settings.axes[2].drive = cophase_core::settings::DriveKind::Servo;
    assert_eq!(check::<Rp2040>(&settings), Err(Unfit::Servo(2)));
}
