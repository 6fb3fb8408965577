//! Setpoints of servo drives, compared with the phase that they come from and with the mechanics of the machine.

use cophase_core::units::{Phase, Turns};
use cophase_scene::units::{speed_hz, turns};
use cophase_tests::{bench_scene, built_in_scene};
use host_sim::sim::{Moment, Observer, simulate};

const AXES: usize = 6;
const HZ: u32 = 2000;

/// Compares the setpoints in every tick.
struct Compare {
    rotor_inertia_kgm2: f64,
    reversed: usize,
    worst_nm: f64,
    peak_nm: f64,
    ticks: u64,
}

impl Observer for Compare {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let omega = speed_hz(telemetry.motion.speed, HZ) * std::f64::consts::TAU;
        let acceleration =
            speed_hz(telemetry.motion.acceleration, HZ) * f64::from(HZ) * std::f64::consts::TAU;
        let alpha = turns(telemetry.phase.within_turn()) * std::f64::consts::TAU;
        // The reference is independent of the core: floating point, and the exact kinematics that `design` uses.
        let share_nm = moment
            .machine
            .follower()
            .load_at(alpha)
            .torque_nm(omega, acceleration)
            / AXES as f64;
        let expected_nm = share_nm + self.rotor_inertia_kgm2 * acceleration;
        for (axis, setpoint) in moment.played.setpoints.iter().enumerate() {
            let sign = if axis == self.reversed { -1 } else { 1 };
            let position = setpoint.position.since(Phase::ZERO) * Turns::from_num(sign);
            assert_eq!(
                position,
                telemetry.axis_phase(axis).since(Phase::ZERO),
                "axis {axis}"
            );
            assert_eq!(
                setpoint.velocity * Turns::from_num(sign),
                telemetry.motion.speed,
                "axis {axis}"
            );
            let actual_nm = setpoint.torque.to_num::<f64>() * f64::from(sign);
            self.worst_nm = self.worst_nm.max((actual_nm - expected_nm).abs());
            self.peak_nm = self.peak_nm.max(expected_nm.abs());
        }
        self.ticks += 1;
    }
}

/// If this fails, drives push against the platform, or a reversed drive pushes against the others.
#[test]
fn setpoints_match_the_torque_and_motion_of_the_machine() {
    let checked = built_in_scene("patent-1")
        .axis(4, "reversed", true)
        .checked();
    let mut compare = Compare {
        rotor_inertia_kgm2: checked.scene.axes.rotor_inertia_kgm2,
        reversed: 4,
        worst_nm: 0.0,
        peak_nm: 0.0,
        ticks: 0,
    };
    simulate(&checked, &mut compare, |_, _| {}).expect("a checked scene runs");
    assert!(compare.ticks > 30_000);
    // The published example: 224 N·m for all six motors, 37 for each.
    assert!(
        (36.0..40.0).contains(&compare.peak_nm),
        "{} N·m",
        compare.peak_nm
    );
    assert!(
        compare.worst_nm < 2e-5 * compare.peak_nm,
        "off by {:e} N·m",
        compare.worst_nm
    );
}

/// If this fails, a servo gets the torque of a gentler stop, or of an overflowed number, when a fault requires the hardest
/// stop. That stop may be ten times as hard as any other ramp.
#[test]
fn torque_setpoints_match_the_machine_in_a_fault_stop() {
    // After two turns of homing, and the ramp.
    let alarm = "fault = [{ at_s = 3, kind = \"drive-alarm\", axis = 0 }]";
    let checked = bench_scene()
        .with(r#"
machine = { load_kg = 20 }
limits = { speed_hz = 40, jerk_hz_per_s2 = 4000, stop_acceleration_hz_per_s = 1000, stop_jerk_hz_per_s2 = 100000 }
axes = { count = 6, drive = "servo", steps_per_turn = 4096, rotor_inertia_kgm2 = 0.001 }
"#)
        .axis(4, "reversed", true)
        .program([(40.0, 1.0, 2.0)])
        .with(alarm)
        .checked();
    let mut compare = Compare {
        rotor_inertia_kgm2: checked.scene.axes.rotor_inertia_kgm2,
        reversed: 4,
        worst_nm: 0.0,
        peak_nm: 0.0,
        ticks: 0,
    };
    let outcome = simulate(&checked, &mut compare, |_, _| {}).expect("a checked scene runs");
    assert!(outcome.fault.is_some());
    // The rotor alone takes J α = 0.001 · 2π · 1000 = 6.3 N·m.
    assert!(compare.peak_nm > 6.3, "{} N·m", compare.peak_nm);
    assert!(
        compare.worst_nm < 2e-5 * compare.peak_nm + 3.0 / 65_536.0,
        "off by {:e} of {} N·m",
        compare.worst_nm,
        compare.peak_nm
    );
}
