//! The loop on cranks that torque moves: where they settle, when they slip, and whether the model levels agree.

use cophase_tests::{Run, SceneBuilder, bench_scene};
use host_sim::sim::simulate;

/// Four steppers with 50 electrical cycles a turn. They are parked at 90°, where the load pulls on every crank.
fn machine() -> SceneBuilder {
    bench_scene()
        .with(
            r#"
fidelity = "phased"
machine = { load_kg = 8, mount_radius_mm = 200 }
control = { park_deg = 90 }
limits = { speed_hz = 30, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 600, homing_speed_hz = 5 }
[axes]
count = 4
steps_per_turn = 12800
rotor_inertia_kgm2 = 1e-3
damping_nms = 0.2
pull_out = [[0, 20.0], [60, 20.0]]
"#,
        )
        .program([(15.0, 0.5, 0.5)])
}

/// The same machine on servos.
fn servos(position_gain_per_s: f64, velocity_gain_nms: f64) -> SceneBuilder {
    machine()
        .without("axes.damping_nms")
        .without("axes.pull_out")
        .set("axes.drive", "servo")
        .set("axes.servo.position_gain_per_s", position_gain_per_s)
        .set("axes.servo.velocity_gain_nms", velocity_gain_nms)
}

fn last(run: &Run, column: &str) -> f64 {
    *run.trace().column(column).last().expect("a run has rows")
}

/// Returns the lead of a crank over its command at the end, turns.
fn ahead(run: &Run, axis: usize) -> f64 {
    last(run, &format!("actual_turns_{axis}")) - last(run, &format!("command_turns_{axis}"))
}

/// If this fails, a motor's spring does not carry the load of gravity on its crank.
///
/// At 90° the load of m g pushes on N cranks with levers of R each (s = 1), so that T sin(p δ) = m g R / N. A platform above its cranks
/// pushes them ahead, one below holds them back.
#[test]
fn gravity_deflects_a_parked_crank_by_the_motor_stiffness() {
    for (platform, sign) in [("above", 1.0), ("below", -1.0)] {
        // A run continues at rest for 50 ms. With this damping, that is twenty of its time constants.
        let machine = machine()
            .set("machine.platform", platform)
            .set("axes.damping_nms", 1);
        let run = machine.run();
        let torque_nm: f64 = 8.0 * 9.80665 * 0.010 / 4.0;
        let lag_turns = (torque_nm / 20.0).asin() / 50.0 / std::f64::consts::TAU;
        for axis in 0..4 {
            let found = ahead(&run, axis);
            // The crank is then not exactly at 90°, but its lever there is nearly at its maximum: 1e-3 of the lag.
            assert!(
                (found - sign * lag_turns).abs() < 1e-3 * lag_turns,
                "{platform}, axis {axis}: {found}, not {}",
                sign * lag_turns
            );
        }
    }
}

/// If this fails, the rigid and the phased level disagree where both describe the machine completely.
#[test]
fn equal_cranks_move_as_one_shaft() {
    let phased = machine().run();
    let rigid = machine().set("fidelity", "rigid").run();
    assert_eq!(rigid.report["fidelity"]["model_level"], "rigid");
    let (one, other) = (rigid.trace(), phased.trace());
    let pairs = one
        .column("actual_turns_3")
        .iter()
        .zip(other.column("actual_turns_3"))
        .map(|(a, b)| (a - b).abs());
    // The steps of both resolve the fastest mode of each. Their errors differ, and are of the order of 1e-3 of the lag, which is at most
    // some 1e-4 turns.
    let worst = pairs.fold(0.0, f64::max);
    assert!(worst < 1e-6, "{worst} turns apart");
    assert!(phased.outcome.record.figures.phase_spread_worst_deg < Some(1e-6));
}

/// If this fails, a motor that is too weak lags a little more, without end, and never loses a step.
#[test]
fn weak_motor_slips_by_whole_cycles() {
    // Three cranks: a fourth would bend the rods, and no motor holds against that.
    let weak = machine()
        .set("axes.count", 3)
        .axis(2, "friction_nm", 6)
        .axis(2, "pull_out_scale", 0.2);
    let run = weak.run();
    let axes = run.outcome.record.axes.iter();
    let slipped: Vec<_> = axes.map(|axis| axis.motor_slips).collect();
    assert!(slipped[2] < 0, "{slipped:?}");
    for axis in [0, 1] {
        assert_eq!(slipped[axis], 0, "axis {axis}");
    }
    // Its friction exceeds its motor's torque. Once the crank has stopped, it stands, wherever its field is.
    let trace = run.trace();
    let row = trace.first("fault").start - 2;
    let actual = trace.column("actual_turns_2");
    assert_eq!(actual[row], actual[row - 20]);
}

/// If this fails, a servo leaves its load to its position loop, although it receives the torque as a command.
#[test]
fn servo_with_torque_feed_forward_lags_less() {
    let run = servos(500.0, 2.0).run();
    let trace = run.trace();
    let (actual, command) = (
        trace.column("actual_turns_1"),
        trace.column("command_turns_1"),
    );
    let lags = actual.iter().zip(command).map(|(a, c)| (a - c).abs());
    let worst = lags.fold(0.0, f64::max);
    // The lag under its share of the load at 15 g, by the stiffness alone: m (a + g) R max(s) / N / k. Without feed-forward, the damping of
    // the speed loop leaves 0.4 of it.
    let alone = 8.0 * 16.0 * 9.80665 * 0.010 * 1.03 / 4.0 / 1000.0 / std::f64::consts::TAU;
    assert!(
        worst < 0.1 * alone,
        "{worst} turns; by stiffness alone {alone}"
    );
}

/// If this fails, a model level that needs torques runs on a scene without them.
#[test]
fn torque_levels_require_inertia_and_pull_out_torque() {
    for model_level in ["rigid", "phased"] {
        let machine = machine().set("fidelity", model_level);
        for key in ["axes.rotor_inertia_kgm2", "axes.pull_out"] {
            let said = machine.clone().without(key).refused();
            assert!(said.contains(key) && said.contains(model_level), "{said}");
        }
        let said = machine.set("axes.rotor_inertia_kgm2", 1e-12).refused();
        assert!(
            said.contains("method") && said.contains("steps a tick"),
            "{said}"
        );
    }
}

/// If this fails, a method runs where it is unstable, and its wrong results are taken for the machine's.
#[test]
fn method_is_not_run_where_it_is_unstable() {
    let with = |method: &str, steps_per_tick: i64| {
        machine()
            .set("method.name", method)
            .set("method.steps_per_tick", steps_per_tick)
    };
    // The fastest mode, a rotor between its motor (1000 N·m/rad) and a rod (50e6 · 0.0125² N·m/rad), turns at 2966 rad/s: 1.48
    // rad a tick of 0.5 ms, at a damping ratio of 0.034.
    for (method, steps_per_tick, name) in [
        ("explicit-euler", 2, "explicit Euler"),
        ("velocity-verlet", 1, "velocity Verlet"),
    ] {
        let stiff = with(method, steps_per_tick).set("machine.rod_n_per_um", 500);
        let said = stiff.refused();
        assert!(said.contains(name) && said.contains("limit"), "{said}");
    }
    let usual = last(&machine().run(), "actual_turns_0");
    for name in ["rk4", "velocity-verlet", "implicit-midpoint", "sdirk4"] {
        let run = with(name, 8).run();
        assert_eq!(run.report["method"]["steps_per_tick"], 8, "{name}");
        assert_eq!(run.report["method"]["why"], "the scene sets it");
        assert_eq!(run.outcome.diverged, None);
        let off = (last(&run, "actual_turns_0") - usual).abs();
        assert!(off < 1e-6, "{name}: {off} turns from the usual method");
    }
}

/// If this fails, a run continues with cranks that turn as no machine does. Or a drive without a torque limit is taken for a method with
/// too long a step.
#[test]
fn runaway_ends_the_run_and_its_cause_is_named() {
    let runaway = servos(100.0, 0.06)
        .set("axes.rotor_inertia_kgm2", 1e-4)
        .with("limits = { speed_hz = 5, homing_speed_hz = 2 }")
        .program([(1.0, 0.5, 0.5)])
        .with("fault = [{ at_s = 1.2, kind = \"runaway\", axis = 1, speed_hz = 190 }]");
    let run = runaway.run();
    let why = run.outcome.diverged.as_deref().expect("it runs away");
    assert!(why.contains("crank 1"), "{why}");
    assert!(why.contains("shorter steps give the same speed"), "{why}");
    // The run ends at once. At its end no crank is farther than ten times the greatest speed and 50 rev/s more take it in a tick.
    for axis in 0..4 {
        let column = run.trace().column(&format!("actual_turns_{axis}")).to_vec();
        let steps = column.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 0.1, "axis {axis}");
    }
}

/// If this fails, cranks that stand apart are put at one angle on one shaft, and are taken to have slipped there.
#[test]
fn rigid_level_refuses_cranks_out_of_phase() {
    let rigid = machine()
        .set("fidelity", "rigid")
        .set("machine.allow_commanded_tilt", true);
    for (key, deg) in [("offset_deg", 90), ("start_deg", 1), ("trim_deg", 1)] {
        let said = rigid.clone().axis(1, key, deg).refused();
        assert!(
            said.contains(key) && said.contains("let it be \"phased\""),
            "{said}"
        );
    }
}

/// If this fails, the method's steps for a motor that is stronger at speed than at rest are those for a soft motor.
#[test]
fn step_counts_use_the_greatest_motor_stiffness() {
    let rising = machine()
        .with("method = { name = \"velocity-verlet\", steps_per_tick = 1 }")
        .with("axes = { count = 3, rotor_inertia_kgm2 = 1e-4, pull_out = [[0, 2.0], [1, 60.0], [60, 60.0]] }");
    let said = rising.refused();
    assert!(
        said.contains("velocity Verlet") && said.contains("method.steps_per_tick = 2 or more"),
        "{said}"
    );
}

/// If this fails, cranks that are apart by design shake the platform as if they were in phase. Three cranks, a third of a turn apart,
/// hardly lift it.
#[test]
fn cranks_evenly_apart_hardly_lift_the_platform() {
    let apart = machine()
        .set("fidelity", "kinematic")
        .set("machine.allow_commanded_tilt", true)
        .set("axes.count", 3)
        .axis(1, "offset_deg", 120)
        .axis(2, "offset_deg", -120);
    let run = apart.run();
    let trace = run.trace();
    let max = |column: &str| {
        trace
            .column(column)
            .iter()
            .fold(0.0_f64, |max, a| max.max(a.abs()))
    };
    // Only multiples of the third harmonic of h remain: at λ = 0.25 the sixth, below 1e-3 of the first.
    let amax = 15.0 * 9.80665;
    assert!(max("accel_mps2") < 2e-3 * amax, "{}", max("accel_mps2"));
    assert!(max("tilt_x_mrad") > 1.0);
}

/// If this fails, a machine with strong friction does not come to rest with an implicit method.
#[test]
fn implicit_methods_bring_machines_with_friction_to_rest() {
    for method in ["sdirk4", "implicit-midpoint"] {
        let machine = servos(100.0, 0.06)
            .with("axes = { count = 3, steps_per_turn = 3200, rotor_inertia_kgm2 = 1e-4, friction_nm = 2 }")
            .set("method.name", method);
        let outcome = simulate(&machine.checked(), &mut (), |_, _| {}).unwrap();
        assert_eq!(outcome.diverged, None, "{method}");
    }
}
