//! The stop after a fault is the shortest, on whole machines: two to six axes, steppers, servos and both.
//!
//! [`cophase_tests::watch`] asserts that all axes are in phase, exactly, at every tick of these runs. The permitted
//! duration of a stop is computed here, from the speed and acceleration before it. `firmware/motion/src/shaft/tests/shortest.rs`
//! shows why that is the least.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Run, Stop};
use cophase_tests::scripted::{HZ, ONE_TURN, command, fault};
use cophase_tests::{Tick, Watched, bench_scene, watch};

/// Limits of a fault's stop, rev/s² and rev/s³. They are harder than the usual 40 and 800.
const HARD: (f64, f64) = (160.0, 12_800.0);
pub(super) const USUAL: (f64, f64) = (40.0, 800.0);

pub(super) fn machine(axes: usize, drive: &str, happens: &str) -> Watched {
    let machine = bench_scene()
        .with(
            r#"
control = { park_deg = 33.3, settle_s = 0.02 }
limits = { homing_speed_hz = 4, band = [{ from_hz = 9, to_hz = 11 }] }
"#,
        )
        .set("limits.acceleration_hz_per_s", USUAL.0)
        .set("limits.jerk_hz_per_s2", USUAL.1)
        .set("limits.stop_acceleration_hz_per_s", HARD.0)
        .set("limits.stop_jerk_hz_per_s2", HARD.1)
        .set("axes.count", axes as i64)
        .program([(13.0, 1.5, 1.0)])
        .with(&(command(0.0, "start") + happens));
    let machine = match drive {
        "mixed" => machine
            .set("axes.drive", "servo")
            .axis(1, "drive", "stepper")
            .axis(1, "reversed", true),
        all => machine.set("axes.drive", all),
    };
    watch(&machine.checked())
}

const DRIVES: [&str; 3] = ["stepper", "servo", "mixed"];

fn alarm(at_s: f64, axis: usize) -> String {
    fault("drive-alarm", at_s, &format!("axis = {axis}"))
}

/// The least time to standstill, ticks, from a speed and an acceleration, both per tick.
pub(super) fn min_ticks(limits: (f64, f64), speed: f64, acceleration: f64) -> f64 {
    let (max, jerk) = (
        limits.0 / HZ.powi(2) * ONE_TURN,
        limits.1 / HZ.powi(3) * ONE_TURN,
    );
    let room = speed - acceleration / 2.0 + acceleration.powi(2) / (2.0 * jerk);
    let peak = (jerk * room).sqrt().min(max);
    (acceleration + 2.0 * peak) / jerk + (room - peak * peak / jerk) / peak
}

/// Returns the last tick before a fault latched, and how many ticks longer than the least time the machine moved after
/// it.
fn stop_of(watched: &Watched) -> (Tick, f64) {
    let ticks = &watched.ticks;
    let at = ticks.iter().position(|tick| tick.fault.is_some());
    let at = at.expect("a fault");
    let (last, before) = (ticks[at - 1], ticks[at - 2]);
    let min = min_ticks(HARD, last.speed as f64, (last.speed - before.speed) as f64);
    let moving = ticks[at..].iter().take_while(|tick| tick.speed > 0);
    let count = moving.clone().count();
    for tick in moving {
        assert_eq!((tick.state, tick.drives_enabled), (Stop, true), "{tick:?}");
    }
    for tick in &ticks[at + count..] {
        assert_eq!(tick.speed, 0, "stands for good: {tick:?}");
    }
    let end = watched.last();
    assert_eq!((end.state, end.drives_enabled), (Fault, false));
    (last, count as f64 - min)
}

/// Asserts that a stop takes at most two ticks over the least time. In up to two ticks of that time, speed and then
/// acceleration are already zero.
fn assert_shortest(watched: &Watched, what: &str) -> Tick {
    let (last, over) = stop_of(watched);
    assert!(
        (-2.01..=2.0).contains(&over),
        "{what}: {over} ticks over the least"
    );
    last
}

pub(super) fn each_machine(check: impl Fn(usize, &str)) {
    for axes in 2..=6 {
        for drive in DRIVES {
            check(axes, drive);
        }
    }
}

/// If this fails, a fault at speed leaves some axis turning while others stand, or all turning for too long.
#[test]
fn fault_stops_all_axes_in_the_least_time() {
    each_machine(|axes, drive| {
        for after_s in [0.35, 0.75, 1.95] {
            // Homing takes two turns, at 4 rev/s.
            let at_s = 2.0 / 4.0 + after_s;
            let watched = machine(axes, drive, &alarm(at_s, axes - 1));
            let last = assert_shortest(&watched, &format!("{axes} {drive}s at {at_s} s"));
            assert_eq!(last.state, Run);
            let fault = watched.outcome.fault.expect("a fault");
            assert_eq!(
                (fault.kind, fault.axis),
                (FaultKind::DriveAlarm, Some(axes - 1))
            );
        }
    });
}

/// If this fails, the machine goes through a resonance after a fault in it.
#[test]
fn fault_while_crossing_a_band_stops_in_the_least_time() {
    each_machine(|axes, drive| {
        let plain = machine(axes, drive, "");
        let inside = || plain.ticks.iter().filter(|tick| tick.crossing);
        let count = inside().count();
        for part in [0, count / 4, count / 2, 3 * count / 4] {
            let at_s = inside().nth(part).expect("a band is crossed").start_ns as f64 * 1e-9;
            let watched = machine(axes, drive, &alarm(at_s, 0));
            let last = assert_shortest(&watched, &format!("{axes} {drive}s in a band"));
            assert!(last.crossing || part == 0, "{axes} {drive}s: {last:?}");
        }
    });
}

/// If this fails, a fault before the cranks are homed is ignored, or leads to a stop at an unknown phase.
#[test]
fn fault_during_homing_stops_in_the_least_time() {
    each_machine(|axes, drive| {
        for at_s in [0.04, 0.08, 0.2] {
            let watched = machine(axes, drive, &alarm(at_s, 0));
            let last = assert_shortest(&watched, &format!("{axes} {drive}s aligning"));
            assert_eq!(last.state, Homing, "{axes} {drive}s");
        }
    });
}

/// If this fails, a machine that is parking finishes that first. Or the second of two faults at once restarts the stop,
/// or is reported instead of the first.
#[test]
fn fault_during_a_stop_and_two_at_once_stop_in_the_least_time() {
    each_machine(|axes, drive| {
        let parking = command(1.8, "stop");
        for at_s in [1.801, 1.9, 2.0, 2.2] {
            let watched = machine(axes, drive, &(parking.clone() + &alarm(at_s, 1)));
            let last = assert_shortest(&watched, &format!("{axes} {drive}s parking at {at_s} s"));
            assert_eq!(last.state, Stop, "{axes} {drive}s");
        }
        let one = machine(axes, drive, &alarm(1.8, 0));
        let twice = alarm(1.8, 0) + &alarm(1.8, 1) + &alarm(1.82, 1) + &parking;
        let two = machine(axes, drive, &twice);
        assert_shortest(&two, &format!("{axes} {drive}s twice"));
        let reported = |watched: &Watched| watched.outcome.fault.expect("a fault");
        assert_eq!(reported(&one), reported(&two), "the first is reported");
        let speeds = |watched: &Watched| -> Vec<i64> {
            let stopping = watched.ticks.iter().filter(|tick| tick.state == Stop);
            stopping.map(|tick| tick.speed).collect()
        };
        assert_eq!(
            speeds(&one),
            speeds(&two),
            "{axes} {drive}s: one stop, once"
        );
    });
}
