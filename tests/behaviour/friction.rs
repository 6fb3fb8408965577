//! Dry friction of the cranks: machines with much of it run with every method, and a crank that it holds stands.

use cophase_tests::{Run, SceneBuilder, bench_scene, built_in_scene};

/// Three steppers on light rotors, with much friction: near standstill it stops a rotor at 8000 rad/s².
fn rods() -> SceneBuilder {
    bench_scene()
        .with(r#"
fidelity = "phased"
machine = { load_kg = 10, rods = "elastic" }
limits = { speed_hz = 10, acceleration_hz_per_s = 20, jerk_hz_per_s2 = 200, homing_speed_hz = 3 }
axes = { rotor_inertia_kgm2 = 5e-4, friction_nm = 4, damping_nms = 0.2, pull_out = [[0, 20], [15, 16]] }
"#)
        .program([(2.0, 0.2, 0.1)])
}

/// Machine that all random scenes share.
fn random() -> SceneBuilder {
    bench_scene().with(
        r#"
fidelity = "phased"
machine = { rods = "elastic" }
control = { tick_hz = 1000, settle_s = 0.02 }
limits = { homing_speed_hz = 6 }
drift = { tilt_limit_mrad = 100, warp_limit_deg = 60, common_limit_deg = 90, reading_error_deg = 3 }
"#,
    )
}

/// Stepper machine whose cranks differ in friction, up to 5 N·m: a random scene.
fn unequal() -> SceneBuilder {
    random()
        .with(r#"
machine = { crank_radius_mm = 8.456, lambda = 0.4547, load_kg = 33.52, mount_radius_mm = 82.05, rod_n_per_um = 3.419, tilt_inertia_kgm2 = 0.09577 }
limits = { speed_hz = 36.91, acceleration_hz_per_s = 60.89, jerk_hz_per_s2 = 596.1 }
axis = [{ number = 0, friction_nm = 1.564, pull_out_scale = 0.997 }, { number = 1, friction_nm = 4.998 }]
[axes]
steps_per_turn = 6400
rotor_inertia_kgm2 = 0.0005699
friction_nm = 2.161
pull_out = [[0, 62.55], [44.29, 40.65]]
damping_nms = 1.883
"#)
        .program([(20.0, 0.2, 0.1)])
}

/// Two induction motors with a steep torque over slip, on light rotors: a random scene. RK4 would take 1716 steps a tick.
fn induction() -> SceneBuilder {
    random()
        .with(r#"
machine = { crank_radius_mm = 42.01, lambda = 0.3428, load_kg = 9.188, mount_radius_mm = 439.1, rod_n_per_um = 45.03, tilt_inertia_kgm2 = 0.6922 }
limits = { speed_hz = 29.65, acceleration_hz_per_s = 106.4, jerk_hz_per_s2 = 1222 }
axis = [
  { number = 0, friction_nm = 46.8, reversed = true, offset_deg = 0.4564 },
  { number = 1, offset_deg = 0.9934 },
]
[axes]
count = 2
drive = "induction"
steps_per_turn = 12800
rotor_inertia_kgm2 = 0.000163
friction_nm = 18.99
index = false
induction = { rated_nm = 621.1, rated_slip_hz = 0.2761, breakdown_ratio = 1.884, position_gain_per_s = 14.93 }
"#)
        .program([(40.0, 0.2, 0.1)])
}

fn with(machine: SceneBuilder, method: &str, steps_per_tick: i64) -> SceneBuilder {
    machine
        .set("method.name", method)
        .set("method.steps_per_tick", steps_per_tick)
}

/// The machine as it is, with the method that `auto` takes, and with two implicit methods.
fn usual_methods(machine: &SceneBuilder) -> [SceneBuilder; 3] {
    [
        machine.clone(),
        machine.clone().set("method.name", "sdirk4"),
        machine.clone().set("method.name", "implicit-midpoint"),
    ]
}

#[track_caller]
fn parks(machine: &SceneBuilder) -> Run {
    let run = machine.run();
    let method = &run.report["method"]["name"];
    assert_eq!(run.outcome.diverged, None, "{method}");
    assert_eq!(run.outcome.fault, None, "{method}");
    run
}

/// Returns the largest difference of a crank's angle between two runs, turns.
fn apart(one: &Run, other: &Run, axes: usize) -> f64 {
    let (one, other) = (one.trace(), other.trace());
    let angles = |axis| {
        let column = format!("actual_turns_{axis}");
        let pairs = one.column(&column).iter().zip(other.column(&column));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    (0..axes).map(angles).fold(0.0, f64::max)
}

/// If this fails, a method does not solve its step where friction acts, and a valid machine diverges. Or it treats friction in another way
/// than the others. RK4 with a hundredth of a tick is the judge. All methods resolve the rods' oscillation in 16 steps a tick; the bounds are
/// their errors in a lag of some 1e-3 turns.
#[test]
fn elastic_rods_with_friction_move_alike_with_every_method() {
    let judge = parks(&with(rods(), "rk4", 100));
    for machine in usual_methods(&rods()) {
        parks(&machine);
    }
    for (name, turns) in [
        ("rk4", 1e-8),
        ("sdirk4", 1e-8),
        ("implicit-midpoint", 1e-7),
        ("velocity-verlet", 1e-7),
        ("symplectic-euler", 1e-5),
    ] {
        let found = parks(&with(rods(), name, 16));
        let off = apart(&judge, &found, 3);
        println!("{name}: {off:.1e} turns");
        assert!(off < turns, "{name}: {off} turns");
    }
}

/// If this fails, a machine with much friction on a frame diverges when its cranks begin to turn.
#[test]
fn machine_on_a_frame_runs_with_friction() {
    for kind in ["elastic", "quasi-static"] {
        let machine = rods()
            .set("fidelity", "elastic")
            .set("machine.rods", kind)
            .with("frame = { mass_kg = 60, suspension_n_per_mm = 40 }");
        let judge = parks(&with(machine.clone(), "rk4", 100));
        for machine in usual_methods(&machine) {
            let found = parks(&machine);
            let off = apart(&judge, &found, 3);
            let method = &found.report["method"]["name"];
            assert!(off < 1e-6, "{kind} rods, {method}: {off} turns");
        }
    }
}

/// If this fails, cranks whose frictions differ do not stick and slide one by one.
#[test]
fn cranks_of_unequal_friction_run_with_every_method() {
    let judge = parks(&with(unequal(), "rk4", 100));
    for machine in usual_methods(&unequal()) {
        let found = parks(&machine);
        let off = apart(&judge, &found, 3);
        let method = &found.report["method"]["name"];
        println!("{method}: {off:.1e} turns");
        assert!(off < 1e-6, "{method}: {off} turns");
    }
}

/// If this fails, `auto` refuses a machine for which it has a method, or an implicit method does not solve its steps. SDIRK4 and
/// implicit midpoint share no formula; RK4 needs a thousandth of a tick, and the test is short of time for that.
#[test]
fn induction_motors_with_friction_run_with_implicit_methods() {
    let auto = parks(&induction());
    assert_eq!(auto.report["method"]["name"], "SDIRK4");
    for name in ["sdirk4", "implicit-midpoint"] {
        let found = parks(&induction().set("method.name", name));
        let off = apart(&auto, &found, 2);
        println!("{name}: {off:.1e} turns");
        assert!(off < 1e-6, "{name}: {off} turns");
    }
}

/// If this fails, a crank drifts or shakes that friction holds. Its motor pulls with less than the friction at the end of each run: the
/// platform's weight has no lever at the dead centre where it parks.
#[test]
fn crank_that_friction_holds_stands() {
    for name in [
        "rk4",
        "sdirk4",
        "implicit-midpoint",
        "velocity-verlet",
        "symplectic-euler",
    ] {
        let run = parks(&with(rods(), name, 16));
        let trace = run.trace();
        for axis in 0..3 {
            let turns = trace.axis("actual_turns", axis);
            let parked = &turns[trace.first("parked").start + 20..];
            assert!(parked.len() > 50);
            assert!(
                parked.iter().all(|turns| *turns == parked[0]),
                "{name}, axis {axis}"
            );
            // Friction leaves it beside its command, by what the field's spring needs for less than 4 of 20 N·m.
            let aim = trace.axis("command_turns", axis);
            let off = (parked[0] - aim[aim.len() - 1]).abs();
            assert!(
                off <= f64::asin(4.0 / 20.0) / 50.0 / std::f64::consts::TAU,
                "{name}: {off}"
            );
            assert!(off > 1e-6, "{name}: {off}");
        }
    }
}

/// If this fails, a crank that friction should hold shakes by the method's step. Its index then passes early, and homing ends a turn
/// sooner.
#[test]
fn friction_near_standstill_does_not_depend_on_the_step() {
    let stiff = built_in_scene("stiff-bearing");
    let running_s = |machine: &SceneBuilder| {
        let run = machine.run();
        let trace = run.trace();
        let at = trace.states.iter().position(|state| state == "run");
        trace.column("t_s")[at.expect("it runs")]
    };
    let auto_s = running_s(&stiff);
    let short = "method = { name = \"rk4\", steps_per_tick = 40 }";
    assert_eq!(auto_s, running_s(&stiff.with(short)));
    assert!(auto_s > 1.0, "{auto_s}: a turn at 1 rev/s");
}
