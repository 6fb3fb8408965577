//! Effect of a scene's `[[fault]]` and `[noise]` on drives, cranks and sensors, without the controller's reaction.
//!
//! Each effect is tested on a *kinematic* machine, whose cranks are where their fields are, to the last digit. A *phased*
//! machine, whose cranks swing, is tested too where it gives another result. The loop is not tested here: other tests check its
//! reports and its stops. The faults therefore come early in a long turn at a low speed, and limits are wide.

mod coasting;
mod drives;
mod noise;
mod observation;
mod reversal;
mod samples;
mod sensors;
mod servos;

use cophase_core::supervisor::FaultKind;
use cophase_tests::{SceneBuilder, bench_scene};
use host_sim::checked::Checked;
use host_sim::sim::events::EventKind;
pub(crate) use samples::{Samples, observe};

/// Three steppers, 50 electrical cycles to a turn. Homing starts at 0.02 s, at 5 rev/s, and a turn is 400 ticks of 0.5 ms.
pub(crate) fn kinematic() -> SceneBuilder {
    bench_scene()
        .with(
            r#"
fidelity = "kinematic"
control = { settle_s = 0.02 }
limits = { speed_hz = 12, acceleration_hz_per_s = 200, jerk_hz_per_s2 = 20000, homing_speed_hz = 5 }
drift = { tilt_limit_mrad = 100, warp_limit_deg = 90, common_limit_deg = 90 }
[axes]
steps_per_turn = 12800
rotor_inertia_kgm2 = 1e-3
damping_nms = 0.4
pull_out = [[0, 20.0], [60, 20.0]]
encoder = true
"#,
        )
        .program([(2.5, 0.1, 1.0)])
}

/// Time of the faults: in the first turn, before any index pulse is detected and evaluated.
const AT_S: f64 = 0.12;
/// The same time as a tick.
pub(crate) const AT_TICK: u64 = 240;
const TICK_S: f64 = 5e-4;

fn phased() -> SceneBuilder {
    kinematic().set("fidelity", "phased")
}

/// The same machine without encoders for the loop. The loop does not detect at once that a motor turns other than commanded, and
/// continues.
fn unread(machine: &SceneBuilder) -> SceneBuilder {
    machine.clone().set("axes.encoder", false)
}

/// The machine with a fault at a time: TOML of its other keys.
fn faulty(machine: &SceneBuilder, at_s: f64, fault: &str) -> Checked {
    let fault = format!("[[fault]]\nat_s = {at_s}\n{fault}");
    machine.clone().with(&fault).checked()
}

pub(crate) fn with(machine: &SceneBuilder, fault: &str) -> Samples {
    observe(&faulty(machine, AT_S, fault))
}

/// Returns the tick of the first event that `is` selects. The event was detected at the tick's beginning.
fn event_tick(samples: &Samples, is: fn(&EventKind) -> bool) -> Option<u64> {
    let mut events = samples.outcome.record.events.iter();
    let event = events.find(|event| is(&event.what))?;
    Some((event.t_s / TICK_S).round() as u64)
}

/// Returns the tick of the first fault that was injected.
#[track_caller]
fn began(samples: &Samples) -> u64 {
    event_tick(samples, |what| matches!(what, EventKind::Injected(_))).expect("a fault was put in")
}

/// Returns the time at which the first fault latched. A tick plays the output that was computed at the deadline before.
fn latched_in(samples: &Samples) -> Option<u64> {
    let played = event_tick(samples, |what| matches!(what, EventKind::Fault { .. }))?;
    Some(played - 1)
}

/// Returns true if the loop latched a fault that can be reported to it at once.
pub(crate) fn latched(samples: &Samples, kind: FaultKind) -> bool {
    let mut events = samples.outcome.record.events.iter();
    let first = events.find_map(|event| match event.what {
        EventKind::Fault { fault, .. } => Some(fault.kind),
        _ => None,
    });
    first == Some(kind)
}
