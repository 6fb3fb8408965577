//! Drives that turn their cranks back while they are commanded ahead, and encoders that detect it.

use cophase_core::supervisor::FaultKind;
use cophase_tests::bench_scene;
use host_sim::checked::Checked;
use host_sim::sim::events::EventKind;

use super::samples::observe;

/// Time at which the drive turns back: at the top speed, 12 rev/s.
const AT_S: f64 = 2.6;
const TICK_S: f64 = 5e-4;

const STEPPER: &str = "axes = { pull_out = [[0, 8], [20, 6]], damping_nms = 0.1 }";

const SERVO: &str =
    r#"axes = { drive = "servo", servo = { position_gain_per_s = 100, velocity_gain_nms = 1.0 } }"#;

fn machine(level: &str, drive: &str, speed_hz: f64) -> Checked {
    bench_scene()
        .set("fidelity", level)
        .with(
            r#"
machine = { load_kg = 4 }
limits = { acceleration_hz_per_s = 20, jerk_hz_per_s2 = 200 }
drift = { tilt_limit_mrad = 8 }
axes = { encoder = true, rotor_inertia_kgm2 = 1e-3, friction_nm = 0.2 }
"#,
        )
        .program([(8.0, 1.0, 2.0)])
        .with(drive)
        .with(&format!(
            "fault = [{{ at_s = {AT_S}, kind = \"runaway\", axis = 1, speed_hz = {speed_hz} }}]"
        ))
        .checked()
}

/// If this fails, the loop stops the machine and keeps the drive on. The others then come to rest in phase while this crank turns
/// against them.
#[test]
fn reversed_crank_is_reported_and_its_drive_disabled() {
    for level in ["kinematic", "phased"] {
        for drive in [STEPPER, SERVO] {
            for speed_hz in [-12.0, -3.0, -0.5] {
                let samples = observe(&machine(level, drive, speed_hz));
                let faults: Vec<_> = samples
                    .outcome
                    .record
                    .events
                    .iter()
                    .filter_map(|event| match event.what {
                        EventKind::Fault { fault, .. } => Some((fault.kind, fault.axis)),
                        _ => None,
                    })
                    .collect();
                let case = format!("{level}, {speed_hz} rev/s, {drive}: {faults:?}");
                let last = faults.last().expect("it is reported");
                assert_eq!(*last, (FaultKind::Reversed, Some(1)), "{case}");
                let off = samples
                    .ticks
                    .iter()
                    .find(|sample| sample.tick as f64 * TICK_S > AT_S && !sample.enabled);
                let after_s = off.expect("its drive is off").tick as f64 * TICK_S - AT_S;
                // The crank has gone back by an electrical cycle, 1/50 turn, and two windows of four ticks are over. A rotor swings
                // in its field before it turns with it, ahead too: what it goes back counts from its furthest point ahead.
                let swings_s = if level == "phased" { 0.02 } else { 0.0 };
                let max_s = 0.02 / -speed_hz + 8.0 * TICK_S + swings_s;
                assert!(after_s < max_s, "{after_s} s, {case}");
            }
        }
    }
}
