//! Root at amax = 0: the speed of an amplitude is proportional to its root, whose slope is infinite at rest.
//!
//! Failure: a program that rises linearly from 0 requires an unbounded acceleration at its start. Guard: the master's limits
//! determine how fast the shaft follows. Its lag is reported, and is no fault.

use cophase_core::supervisor::State;

use super::panel::{Curve, Shown, guarded, requested};
use super::runs::{began_s, run, speed_for_hz};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::picture::Level;
use host_sim::sim::Outcome;
use host_sim::sim::events::EventKind;

/// Linear ramp from rest.
pub const SCENE: &str = r#"
name = "root"
fidelity = "kinematic"
[machine]
crank_radius_mm = 10
lambda = 0.25
load_kg = 8
[control]
settle_s = 0.02
[limits]
speed_hz = 40
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 6000
[axes]
count = 3
drive = "stepper"
steps_per_turn = 3200
index = false
[[program]]
amax_g = 40
ramp_s = 1
shape = "linear"
[[program]]
amax_g = 5
ramp_s = 1
"#;

/// Limit of the shaft's acceleration in [`SCENE`], rev/s².
pub const LIMIT_HZ_PER_S: f64 = 60.0;
const TICK_S: f64 = 500e-6;
const SHOWN_S: f64 = 0.4;

/// Measured results.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Time since the program began, s, required speed by the root, and commanded speed, rev/s, up to the end of the rise.
    pub speeds: Vec<(f64, f64, f64)>,
    /// End of the run.
    pub outcome: Outcome,
}

impl Facts {
    /// Returns the greatest required acceleration by the root, from tick to tick, rev/s².
    pub fn requested_hz_per_s(&self) -> f64 {
        self.steepest(|speeds| speeds.1)
    }

    /// Returns the greatest commanded acceleration, rev/s².
    pub fn commanded_hz_per_s(&self) -> f64 {
        self.steepest(|speeds| speeds.2)
    }

    fn steepest(&self, of: fn(&(f64, f64, f64)) -> f64) -> f64 {
        let pairs = self.speeds.windows(2);
        let slopes = pairs.map(|pair| (of(&pair[1]) - of(&pair[0])).abs() / TICK_S);
        slopes.fold(0.0, f64::max)
    }

    /// Returns the time for which the shaft was behind the program, s, as in the report.
    pub fn behind_s(&self) -> Option<f64> {
        self.outcome
            .record
            .events
            .iter()
            .find_map(|event| match event.what {
                EventKind::Lagged { for_s, .. } => Some(for_s),
                _ => None,
            })
    }
}

/// Runs the scene.
///
/// # Errors
/// The scene does not run.
pub fn measure() -> Result<Facts, ChartError> {
    let mut samples = Vec::new();
    let outcome = run(SCENE, &mut |now| {
        if now.state == State::Run {
            let requested_hz = speed_for_hz(now.requested_mps2, 0.010, 0.25);
            samples.push((now.t_s, requested_hz, now.speed_hz));
        }
    })?;
    let began_s = began_s(&outcome).unwrap_or(0.0);
    // The requested speed of a tick is that at its end; the program begins at rest.
    let after = samples
        .into_iter()
        .map(|(t_s, requested, actual)| (t_s + TICK_S - began_s, requested, actual));
    let speeds = std::iter::once((0.0, 0.0, 0.0)).chain(after);
    let speeds = speeds.filter(|(t_s, ..)| *t_s < 1.0).collect();
    Ok(Facts { speeds, outcome })
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let facts = measure()?;
    let points = |of: fn(&(f64, f64, f64)) -> f64| -> Vec<(f64, f64)> {
        let first = facts.speeds.iter().filter(|speeds| speeds.0 < SHOWN_S);
        first
            .step_by(8)
            .map(|speeds| (speeds.0, of(speeds)))
            .collect()
    };
    let caught_s = facts.behind_s().unwrap_or(0.0);
    Ok(Shown {
        key: "root",
        title: "Root at amax = 0: an even ramp from rest".to_owned(),
        x: Axis::linear("time since the program began, s", 0.0, SHOWN_S),
        y: Axis::linear("speed of the shaft, rev/s", 0.0, 20.0),
        curves: vec![
            Curve::new(
                "requested by the root, rev/s",
                requested(points(|speeds| speeds.1)),
            ),
            Curve::new("commanded, rev/s", guarded(points(|speeds| speeds.2))),
        ],
        levels: vec![Level::at_x(caught_s, "caught up")],
        says: format!(
            "The root asks for {:.0} times the acceleration that is allowed; the shaft keeps its limit and has caught up \
             after {caught_s:.2} s.",
            facts.requested_hz_per_s() / LIMIT_HZ_PER_S
        ),
    })
}
