//! A run as a row of data.

use serde::{Deserialize, Serialize};

use super::judge::{Judgement, Verdict};
use super::plan::Case;
use super::watch::{Observation, ReportedFault};
use host_sim::scene::file::{Drive, FaultAt, FaultName, Fidelity, Scene};
use host_sim::sim::Outcome;

/// One run. What does not apply is empty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// The case's number.
    pub number: u64,
    /// Whether it is the case's clean run: the same, without its fault.
    pub clean: bool,
    /// What the machine is called.
    pub machine: String,
    /// How many axes it has.
    pub axes: usize,
    /// How they are driven.
    pub drive: Drive,
    /// Whether they have encoders.
    pub encoder: bool,
    /// The model level of the ladder.
    pub model_level: Fidelity,
    /// Control ticks a second.
    pub tick_hz: u32,
    /// Whether homing proves the wiring.
    pub proves_wiring: bool,
    /// What goes wrong.
    pub kind: Option<FaultName>,
    /// On which axis.
    pub axis: Option<usize>,
    /// When, s.
    pub at_s: Option<f64>,
    /// For how long, s; empty for good.
    pub for_s: Option<f64>,
    /// How much, in the kind's own unit.
    pub size: Option<f64>,
    /// What the machine was doing then.
    pub state: String,
    /// Its speed then, rev/s.
    pub speed_hz: Option<f64>,
    /// When a crank was beyond its limit, s.
    pub beyond_limit_s: Option<f64>,
    /// When anything was first reported, s: from then on what the loop made of it was played.
    pub reported_s: Option<f64>,
    /// When the outputs responded to it: the machine stopped, its drives went off, or a correction that sufficed began.
    pub detected_s: Option<f64>,
    /// Turns of the master from the fault to N + 5 ticks before anything was reported.
    pub turns_from_fault: Option<f64>,
    /// … and from the crank passing its limit to N + 5 ticks before that was detected; below 0, it was before.
    pub turns_from_limit: Option<f64>,
    /// Whether it was detected in time; empty where no crank passed its limit, or the machine stood before a turn was over.
    pub in_time: Option<bool>,
    /// The fault that latched.
    pub fault: String,
    /// Of which axis.
    pub fault_axis: Option<usize>,
    /// All faults that were reported, as kind@axis.
    pub reported_faults: String,
    /// How it is judged.
    pub verdict: Verdict,
    /// Largest tilt while the drives were on, mrad; where they held after a stop, that since the fault and before the hold.
    pub tilt_mrad: f64,
    /// Largest tilt after they were off, if they were.
    pub tilt_off_mrad: Option<f64>,
    /// Most that it may be, mrad.
    pub bound_mrad: f64,
    /// The limit that is watched, mrad.
    pub limit_mrad: f64,
    /// Largest growth of the tilt after a stop while the drives hold, mrad; empty if they never did.
    pub tilt_hold_mrad: Option<f64>,
    /// Most that it may be.
    pub hold_bound_mrad: Option<f64>,
    /// The most that an axis was moved while another had been stopped, turns.
    pub left_running_turns: f64,
    /// Whether that is more than rounding.
    pub left_running: bool,
    /// What the machine was doing at the end.
    pub ended: String,
    /// Simulated time, s.
    pub simulated_s: f64,
}

impl Row {
    /// Of a run.
    pub fn new(
        case: &Case,
        clean: bool,
        observation: &Observation,
        judgement: &Judgement,
        outcome: &Outcome,
    ) -> Self {
        let scene: &Scene = &case.scene;
        let fault = (!clean).then(|| case.fault());
        let injected = observation.injected.as_ref();
        let reported = observation.first_reported();
        Self {
            number: case.number,
            clean,
            machine: case.machine.clone(),
            axes: scene.axes.count,
            drive: scene.axes.drive,
            encoder: scene.axes.encoder,
            model_level: scene.fidelity,
            tick_hz: scene.control.tick_hz,
            proves_wiring: scene.correction.prove_wiring,
            kind: fault.map(|fault| fault.kind),
            axis: fault.and_then(|fault| fault.axis),
            at_s: fault.map(|fault| fault.at_s),
            for_s: fault.and_then(|fault| fault.for_s),
            size: fault.and_then(size),
            state: injected.map_or("", |place| place.state.name()).to_owned(),
            speed_hz: injected.map(|place| place.speed_hz),
            beyond_limit_s: observation.beyond_limit.as_ref().map(|place| place.t_s),
            reported_s: reported.map(|fault_event| fault_event.place.t_s),
            detected_s: judgement.detected_s,
            turns_from_fault: reported
                .zip(injected)
                .map(|(fault_event, injected)| fault_event.turns - injected.turns),
            turns_from_limit: judgement.turns,
            in_time: judgement.in_time,
            fault: observation
                .fault
                .map_or("", |reported| reported.kind.name())
                .to_owned(),
            fault_axis: observation.fault.and_then(|reported| reported.axis),
            reported_faults: observation
                .early
                .iter()
                .filter(|_| observation.reported_faults.is_empty())
                .chain(&observation.reported_faults)
                .map(named)
                .collect::<Vec<_>>()
                .join(" "),
            verdict: judgement.verdict,
            tilt_mrad: match observation.hold.growth_mrad {
                Some(_) => observation.hold.before_mrad,
                None => outcome.statistics.worst_tilt_mrad,
            },
            tilt_off_mrad: outcome.statistics.coast.worst_tilt_mrad,
            bound_mrad: judgement.bound_mrad,
            limit_mrad: scene.drift.tilt_limit_mrad,
            tilt_hold_mrad: observation.hold.growth_mrad,
            hold_bound_mrad: judgement.hold_bound_mrad,
            left_running_turns: observation.left_running_turns,
            left_running: judgement.left_running,
            ended: outcome.state.name().to_owned(),
            simulated_s: outcome.simulated_s(),
        }
    }

    /// Whether a crank was beyond its limit.
    pub const fn is_beyond_limit(&self) -> bool {
        self.beyond_limit_s.is_some()
    }

    /// Largest tilt that the bound is on: while the drives were on, and on model levels where cranks without drives stand, after that. Where
    /// torque moves the cranks, no loop decides where they go without.
    pub fn bounded_tilt_mrad(&self) -> f64 {
        let off_mrad = self
            .tilt_off_mrad
            .filter(|_| !self.model_level.moves_by_torque());
        self.tilt_mrad.max(off_mrad.unwrap_or(0.0))
    }

    /// True if the platform tilted further after a stop than it may while the drives hold.
    pub fn tilts_after_stop(&self) -> bool {
        let growth = self.tilt_hold_mrad.zip(self.hold_bound_mrad);
        growth.is_some_and(|(growth_mrad, bound_mrad)| growth_mrad > bound_mrad)
    }

    /// Tilt, as a part of what it may be.
    pub fn tilt_over_bound(&self) -> f64 {
        self.bounded_tilt_mrad() / self.bound_mrad
    }
}

fn named(reported: &ReportedFault) -> String {
    match reported.axis {
        Some(axis) => format!("{}@{axis}", reported.kind.name()),
        None => reported.kind.name().to_owned(),
    }
}

/// The one number that says how much.
fn size(fault: &FaultAt) -> Option<f64> {
    let whole = |count: i64| count as f64;
    fault
        .cycles
        .map(whole)
        .or(fault.rate_deg_per_s)
        .or(fault.speed_hz)
        .or(fault.count.map(f64::from))
        .or(fault.counts.map(whole))
        .or(fault.torque_nm)
}
