//! Belts and gearboxes between motors and cranks. Unit tests: `firmware/motion/src/pulse/planner/tests.rs`.
//!
//! The reference of a motor behind a gear is a motor on the crank's own shaft whose data the test converts by hand. With i turns of the
//! motor per turn of the crank, speeds are divided by i, torques multiplied by i, and inertia, damping and velocity gain by i².

use cophase_files::trace::{Every, Window};
use cophase_tests::{Run, SceneBuilder, bench_scene, record};

fn machine(level: &str, axes: &str) -> SceneBuilder {
    bench_scene()
        .set("fidelity", level)
        .set("machine.crank_radius_mm", 12)
        .with("limits = { speed_hz = 12, acceleration_hz_per_s = 20, jerk_hz_per_s2 = 300, homing_speed_hz = 3 }")
        .program([(5.0, 0.6, 0.4)])
        .with(&format!("[axes]\n{axes}"))
}

fn run(machine: &SceneBuilder) -> Run {
    record(&machine.checked(), Every::Ticks(1), Window::All)
}

/// Largest difference of a column of two runs.
fn apart(one: &Run, other: &Run, column: &str) -> f64 {
    let (one, other) = (one.trace(), other.trace());
    let (one, other) = (one.column(column).to_vec(), other.column(column).to_vec());
    assert_eq!(one.len(), other.len());
    let apart = one
        .iter()
        .zip(&other)
        .map(|(one, other)| (one - other).abs());
    apart.fold(0.0, f64::max)
}

/// If this fails, a scene prints an amplitude that its platform does not have.
#[test]
fn ratio_to_the_master_is_refused_under_a_platform() {
    for (ratio, key) in [
        ("ratio = [36, 20]\n", "axes.ratio"),
        ("ratio = [20, 36]\n", "axes.ratio"),
        ("ratio = [3, 1]\n", "axes.ratio"),
        ("[[axis]]\nnumber = 1\nratio = [2, 1]\n", "axis[0].ratio"),
    ] {
        let said = machine("auto", ratio).refused();
        assert!(said.contains(key), "{said}");
        assert!(said.contains("gear = [motor turns, crank turns]"), "{said}");
    }
    for same in ["ratio = [1, 1]\n", "ratio = [7, 7]\n"] {
        run(&machine("auto", same)).assert_parked();
    }
}

/// Motors behind a gear of i = 3, and the same on the crank's own shaft.
const PAIRS: [(&str, [&str; 2]); 4] = [
    (
        "steppers",
        [
            "drive = \"stepper\"\nsteps_per_turn = 3200\ngear = [3, 1]\nrotor_inertia_kgm2 = 1e-4\ndamping_nms = 0.02\n\
             friction_nm = 0.2\npull_out = [[0, 4], [30, 3]]",
            "drive = \"stepper\"\nsteps_per_turn = 9600\nfull_steps_per_turn = 600\nrotor_inertia_kgm2 = 9e-4\ndamping_nms = 0.18\n\
             friction_nm = 0.2\npull_out = [[0, 12], [10, 9]]",
        ],
    ),
    (
        "servos on STEP and DIR",
        [
            "drive = \"pulse-servo\"\nsteps_per_turn = 4000\ngear = [3, 1]\nrotor_inertia_kgm2 = 1e-4\n\
             servo = { position_gain_per_s = 100, velocity_gain_nms = 0.1, integral_s = 0.05, limit_nm = 2, following_error_deg = 20 }",
            "drive = \"pulse-servo\"\nsteps_per_turn = 12000\nrotor_inertia_kgm2 = 9e-4\n\
             servo = { position_gain_per_s = 100, velocity_gain_nms = 0.9, integral_s = 0.05, limit_nm = 6, following_error_deg = 20 }",
        ],
    ),
    (
        "servos with setpoints and encoders",
        [
            "drive = \"servo\"\nencoder = true\nsteps_per_turn = 4096\ngear = [3, 1]\nrotor_inertia_kgm2 = 1e-4\n\
             servo = { position_gain_per_s = 100, velocity_gain_nms = 0.1, limit_nm = 2 }",
            "drive = \"servo\"\nencoder = true\nsteps_per_turn = 12288\nrotor_inertia_kgm2 = 9e-4\n\
             servo = { position_gain_per_s = 100, velocity_gain_nms = 0.9, limit_nm = 6 }",
        ],
    ),
    (
        "induction motors",
        [
            "drive = \"induction\"\nsteps_per_turn = 2000\ngear = [3, 1]\nrotor_inertia_kgm2 = 1e-4\n\
             induction = { rated_nm = 2, rated_slip_hz = 1.5, breakdown_ratio = 2.5, position_gain_per_s = 20 }",
            "drive = \"induction\"\nsteps_per_turn = 6000\nrotor_inertia_kgm2 = 9e-4\n\
             induction = { rated_nm = 6, rated_slip_hz = 0.5, breakdown_ratio = 2.5, position_gain_per_s = 20 }",
        ],
    ),
];

/// If this fails, a value of the motor's data sheet is converted wrongly to the crank, or a torque wrongly back to the motor.
#[test]
fn motor_behind_a_gear_acts_as_the_converted_motor() {
    for (motors, [behind, on_shaft]) in PAIRS {
        // Induction motors lag by their slip.
        let drift = "drift = { reading_error_deg = 3, tilt_limit_mrad = 20, warp_limit_deg = 20, common_limit_deg = 60 }";
        let [behind, on_shaft] =
            [behind, on_shaft].map(|axes| run(&machine("phased", axes).with(drift)));
        behind.assert_parked();
        // A torque setpoint has an error of three units of 2⁻¹⁶ N·m, three times that at the crank. The drive has 90 N·m/rad.
        let (tolerance, tolerance_nm) = if motors.contains("setpoints") {
            let error_nm = 2.0 * 9.0 / 65_536.0;
            (error_nm / 90.0 / std::f64::consts::TAU, error_nm)
        } else {
            (1e-7, 1e-6)
        };
        for column in ["actual_turns_0", "actual_turns_2", "z_m"] {
            let apart = apart(&behind, &on_shaft, column);
            assert!(apart < tolerance, "{motors}: {column} differs by {apart}");
        }
        for axis in 0..3 {
            let of = |run: &Run, key: &str| run.report["axes"][axis][key].as_f64().unwrap();
            assert_eq!(of(&behind, "steps"), of(&on_shaft, "steps"), "{motors}");
            let [motor, crank] = [&behind, &on_shaft].map(|run| of(run, "torque_worst_nm"));
            assert!(
                (3.0 * motor - crank).abs() < tolerance_nm,
                "{motors}: {motor} N·m of the motor, {crank} at the crank"
            );
            let of = |run: &Run, key: &str| run.report["axes"][axis]["motor"][key].as_f64();
            let [motor, crank] =
                [&behind, &on_shaft].map(|run| of(run, "torque_required_nm").unwrap());
            assert!(
                (3.0 * motor - crank).abs() < 1e-9,
                "{motors}: {motor} N·m required of the motor, {crank} at the crank"
            );
            for key in ["electrical_cycle_deg", "step_rate_max_hz", "inertia_ratio"] {
                let [one, other] = [&behind, &on_shaft].map(|run| of(run, key).unwrap_or_default());
                assert!(
                    (one - other).abs() <= 1e-9 * other,
                    "{motors}: {key} is {one}, and {other} on the shaft"
                );
            }
        }
    }
}

/// If this fails, pull-out torque or speed are not the motor's: a weak motor behind a gear keeps step, or a strong one does not.
#[test]
fn stepper_behind_a_gear_loses_step_as_its_own_curve_says() {
    let motor = |more: &str, pull_out: &str| {
        let axes = format!("{more}pull_out = {pull_out}");
        run(&machine("quasi-static", &axes))
    };
    let used = |run: &Run| run.report["axes"][0]["pull_out_used"].as_f64().unwrap();
    let slips = |run: &Run| run.report["axes"][0]["slipped_cycles"].as_i64().unwrap() != 0;
    let gear = "gear = [57, 11]\n";
    // At the crank: 57/11 of the torque, at 11/57 of the speed.
    let behind = motor(gear, "[[0, 0.22], [57, 0.11]]");
    let on_shaft = motor("", "[[0, 1.14], [11, 0.57]]");
    let (one, other) = (used(&behind), used(&on_shaft));
    // Whole steps place the cranks differently.
    assert!(
        (one - other).abs() < 1e-3 * other && (0.3..1.0).contains(&one),
        "{one}, and {other} on the shaft"
    );
    assert!(!slips(&behind));
    // A tenth of that torque is too little, and beyond its last speed a motor has none.
    assert!(slips(&motor(gear, "[[0, 0.022], [57, 0.011]]")));
    assert!(slips(&motor(gear, "[[0, 0.22], [30, 0.22]]")));
}

/// If this fails, steps of a gear that leaves a fraction accumulate an error, or an encoder's counts do: the cranks depart from their
/// commands, or the drift monitor reports what is not there.
#[test]
fn cranks_behind_uneven_gears_stay_at_their_commands() {
    let gears = "gear = [57, 11]\n[[axis]]\nnumber = 1\ngear = [20, 36]\ntrim_deg = 1\n[[axis]]\nnumber = 2\ngear = [1000, 999]\nreversed = true\n";
    for drive in [
        "drive = \"stepper\"\nsteps_per_turn = 3217\n",
        "drive = \"servo\"\nencoder = true\nsteps_per_turn = 10000\n",
    ] {
        let machine = machine("kinematic", &format!("{drive}{gears}"));
        let run = run(&machine.program([(5.0, 0.6, 8.0)]));
        run.assert_parked();
        for (axis, (motor, crank)) in [(57.0, 11.0), (20.0, 36.0), (1000.0, 999.0)]
            .into_iter()
            .enumerate()
        {
            let report = &run.report["axes"][axis];
            let turns = |key: &str| report[key].as_f64().unwrap();
            let per_turn = if drive.contains("servo") {
                10_000.0
            } else {
                3217.0
            } * motor
                / crank;
            let off = turns("steps") / per_turn - turns("command_turns");
            assert!(
                (-1.01 / per_turn..1e-9).contains(&off),
                "axis {axis}: its steps are {off} turns from its command"
            );
            let off = turns("actual_turns") - turns("command_turns");
            assert!(
                off.abs() < 1.01 / per_turn,
                "axis {axis} is {off} turns from its command"
            );
            assert!(
                turns("phase_error_peak_deg") < 0.25 + 720.0 / per_turn,
                "axis {axis}: {report}"
            );
        }
        assert_eq!(
            run.report["reported_faults"].as_array().unwrap().len(),
            0,
            "{}",
            run.report["reported_faults"]
        );
    }
}

/// If this fails, a lost electrical cycle behind a gear is taken for another angle of the crank.
#[test]
fn lost_electrical_cycle_is_found_at_its_angle_of_the_crank() {
    let lost = "fault = [{ at_s = 1.6, kind = \"lost-steps\", axis = 1, cycles = 1 }]";
    let run = run(&machine("kinematic", "gear = [57, 11]").with(lost));
    let fault = &run.report["reported_faults"][0];
    assert_eq!(fault["kind"], "lost-steps", "{fault}");
    // Four of 200 full steps, behind 57 turns of the motor to 11 of the crank.
    let size_deg = fault["size_deg"].as_f64().unwrap();
    let cycle_deg = 7.2 * 11.0 / 57.0;
    assert!(
        (size_deg.abs() - cycle_deg).abs() < 0.3,
        "{size_deg}° of {cycle_deg}°"
    );
}

/// If this fails, readings of a sound machine are reported as slips and lost steps, as an electrical cycle at the crank is smaller than
/// what two readings may differ by.
#[test]
fn readings_apart_by_more_than_a_geared_cycle_are_no_slips() {
    for axes in [
        "drive = \"stepper\"\nsteps_per_turn = 400\ngear = [20, 1]",
        "drive = \"stepper\"\nsteps_per_turn = 3200\ngear = [10, 1]",
        "drive = \"stepper\"\nsteps_per_turn = 48\ngear = [997, 36]\nencoder = true",
    ] {
        let noisy = machine("kinematic", axes).set("noise.index_deg", 0.08);
        let run = run(&noisy.program([(5.0, 0.6, 10.0)]));
        run.assert_parked();
        let faults = run.report["faults"].as_array().unwrap();
        assert!(faults.is_empty(), "{axes}: {faults:?}");
    }
}
