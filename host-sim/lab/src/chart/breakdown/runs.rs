//! Runs of the panels' scenes, with an observer, and messages of refused scenes.

use std::f64::consts::TAU;

use cophase_core::supervisor::State;
use cophase_core::units::MAX_AXES;
use cophase_scene::units::turns;
use cophase_scene::{SceneError, library, load};
use host_sim::checked::Checked;
use host_sim::sim::events::EventKind;
use host_sim::sim::{Moment, Observer, Outcome, simulate};

use crate::chart::ChartError;

/// Scene of three steppers of 1000 N·m/rad under 8 kg, up to 15 g.
const THREE_STEPPERS: &str = r#"
name = "three steppers"
fidelity = "phased"
[machine]
crank_radius_mm = 10
lambda = 0.25
load_kg = 8
mount_radius_mm = 200
[limits]
speed_hz = 30
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 1200
homing_speed_hz = 5
[axes]
count = 3
drive = "stepper"
steps_per_turn = 12800
rotor_inertia_kgm2 = 1e-3
damping_nms = 0.2
pull_out = [[0, 20.0], [60, 20.0]]
[[program]]
amax_g = 15
ramp_s = 0.5
hold_s = 0.5
"#;

/// Returns the scene of three steppers on a model level, with parts of its text replaced.
pub fn three_steppers(model_level: &str, changes: &[(&str, &str)]) -> String {
    let on_level = [("\"phased\"", &*format!("\"{model_level}\""))];
    changed(THREE_STEPPERS, &[&on_level, changes].concat())
}

/// Returns a built-in scene with parts of its text replaced.
///
/// # Errors
/// There is no such scene.
pub fn built_in(name: &str, changes: &[(&str, &str)]) -> Result<String, ChartError> {
    let lacking = || ChartError(format!("no built-in scene `{name}`"));
    let scene = library::find(name).ok_or_else(lacking)?;
    Ok(changed(scene.text, changes))
}

fn changed(text: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(text.to_owned(), |text, (from, to)| {
        debug_assert!(text.contains(from), "{from} is not in the scene");
        text.replacen(from, to, 1)
    })
}

/// Observed values of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Now {
    /// Start of the tick, s since power-up.
    pub t_s: f64,
    /// State of the supervisor.
    pub state: State,
    /// Amplitude that the program requests, m/s².
    pub requested_mps2: f64,
    /// Commanded speed of the shaft, rev/s.
    pub speed_hz: f64,
    /// Lead of each crank over its command, turns; 0 for axes that do not exist.
    pub ahead_turns: [f64; MAX_AXES],
}

/// Observer for all panels. The simulator is compiled once for each type of observer.
struct Eyes<'a>(&'a mut dyn FnMut(&Now));

impl Observer for Eyes<'_> {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let mut ahead_turns = [0.0; MAX_AXES];
        let axes = moment.actual_turns.iter().zip(moment.command_turns);
        for (ahead, (actual, command)) in ahead_turns.iter_mut().zip(axes) {
            *ahead = actual - command;
        }
        let tick_s = (moment.end_ns - moment.start_ns) as f64 * 1e-9;
        (self.0)(&Now {
            t_s: moment.start_ns as f64 * 1e-9,
            state: telemetry.state,
            requested_mps2: telemetry.amax_requested.to_num(),
            speed_hz: turns(telemetry.motion.speed) / tick_s,
            ahead_turns,
        });
    }
}

/// Reads a scene from its text.
///
/// # Errors
/// The scene has an error.
pub fn check(text: &str) -> Result<Checked, SceneError> {
    Checked::new(load::parse(text)?)
}

/// Returns the message of a scene that is refused; `None` if it is not.
pub fn refusal(text: &str) -> Option<String> {
    check(text).err().map(|error| error.to_string())
}

/// Runs a scene.
///
/// # Errors
/// The scene is refused.
pub fn run(text: &str, see: &mut dyn FnMut(&Now)) -> Result<Outcome, ChartError> {
    let checked = check(text)?;
    let mut eyes = Eyes(see);
    Ok(simulate(&checked, &mut eyes, |_, _| {})?)
}

/// Returns the time at which a motor first lost a cycle, s.
pub fn first_slip_s(outcome: &Outcome) -> Option<f64> {
    let slip = |what: &EventKind| matches!(what, EventKind::Slipped { .. });
    first(outcome, slip)
}

/// Returns the time at which the fault latched, s.
pub fn fault_s(outcome: &Outcome) -> Option<f64> {
    first(outcome, |what| matches!(what, EventKind::Fault { .. }))
}

/// Returns the time at which the program began, s.
pub fn began_s(outcome: &Outcome) -> Option<f64> {
    first(outcome, |what| matches!(what, EventKind::Running { .. }))
}

fn first(outcome: &Outcome, is: impl Fn(&EventKind) -> bool) -> Option<f64> {
    let events = &outcome.record.events;
    events
        .iter()
        .find(|event| is(&event.what))
        .map(|event| event.t_s)
}

/// Returns the speed at which a crank of a radius and λ reaches an amplitude, rev/s.
pub fn speed_for_hz(amax_mps2: f64, crank_radius_m: f64, lambda: f64) -> f64 {
    (amax_mps2 / (crank_radius_m * (1.0 + lambda))).sqrt() / TAU
}
