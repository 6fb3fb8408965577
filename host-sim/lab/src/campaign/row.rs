//! Row of data for one run.

use cophase_scene::file::{Drive, FaultAt, FaultName, Fidelity, Scene};
use host_sim::sim::Outcome;
use serde::{Deserialize, Serialize};

use super::judge::{Judgement, Verdict};
use super::plan::Case;
use super::watch::{Observation, ReportedFault};

/// Row of one run. Values that do not apply are empty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Number of the case.
    pub number: u64,
    /// True for the clean run of the case, which has no fault.
    pub clean: bool,
    /// Name of the machine.
    pub machine: String,
    /// Number of axes.
    pub axes: usize,
    /// Drive of the axes.
    pub drive: Drive,
    /// True if the axes have encoders.
    pub encoder: bool,
    /// Model level.
    pub model_level: Fidelity,
    /// Control ticks per second.
    pub tick_hz: u32,
    /// True if homing proves the wiring.
    pub proves_wiring: bool,
    /// Kind of the fault.
    pub kind: Option<FaultName>,
    /// Axis of the fault.
    pub axis: Option<usize>,
    /// Time of the fault, s since power-up.
    pub at_s: Option<f64>,
    /// Duration of the fault, s; empty if it is permanent.
    pub for_s: Option<f64>,
    /// Size of the fault, in the unit of its kind.
    pub size: Option<f64>,
    /// State of the machine when the fault came.
    pub state: String,
    /// Speed of the master then, rev/s.
    pub speed_hz: Option<f64>,
    /// Time at which a crank was first beyond its limit, s.
    pub beyond_limit_s: Option<f64>,
    /// Time of the first report, s. The outputs that the loop computed with it are played from then on.
    pub reported_s: Option<f64>,
    /// Time of the detection, s: the machine stopped, its drives went off, or a correction that sufficed began.
    pub detected_s: Option<f64>,
    /// Turns of the master from the fault to three ticks before the first report.
    pub turns_from_fault: Option<f64>,
    /// Turns of the master from the crank passing its limit to three ticks before the detection; below 0 if the detection was earlier.
    pub turns_from_limit: Option<f64>,
    /// True if the fault was detected in time. Empty if no crank passed its limit, or if the machine stood before a turn was over.
    pub in_time: Option<bool>,
    /// Fault that latched.
    pub fault: String,
    /// Axis of that fault.
    pub fault_axis: Option<usize>,
    /// Faults that were reported, as kind@axis.
    pub reported_faults: String,
    /// Verdict on the run.
    pub verdict: Verdict,
    /// Largest tilt while the drives were on, mrad. If they held after a stop, it is the largest since the fault and before the hold.
    pub tilt_mrad: f64,
    /// Largest tilt after the drives were off, mrad; empty if they were not.
    pub tilt_off_mrad: Option<f64>,
    /// Largest tilt that is allowed, mrad.
    pub bound_mrad: f64,
    /// Limit on tilt of the scene, mrad.
    pub limit_mrad: f64,
    /// Largest growth of the tilt after a stop while the drives hold, mrad; empty if they never did.
    pub tilt_hold_mrad: Option<f64>,
    /// Largest growth that is allowed, mrad.
    pub hold_bound_mrad: Option<f64>,
    /// Largest travel of an axis while another had been stopped, turns.
    pub left_running_turns: f64,
    /// True if that travel is more than rounding.
    pub left_running: bool,
    /// State of the machine at the end.
    pub ended: String,
    /// Simulated time, s.
    pub simulated_s: f64,
}

impl Row {
    /// Row of a run.
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
                None => outcome.record.figures.tilt_worst_mrad.unwrap_or(0.0),
            },
            tilt_off_mrad: outcome.record.figures.tilt_worst_off_mrad,
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

    /// Returns true if a crank was beyond its limit.
    pub const fn is_beyond_limit(&self) -> bool {
        self.beyond_limit_s.is_some()
    }

    /// Largest tilt that the bound applies to, mrad. The tilt with the drives on counts always. The tilt with the drives off counts on
    /// model levels where cranks without drives stand. Where torque moves the cranks, no loop controls them then.
    pub fn bounded_tilt_mrad(&self) -> f64 {
        let off_mrad = self
            .tilt_off_mrad
            .filter(|_| !self.model_level.moves_by_torque());
        self.tilt_mrad.max(off_mrad.unwrap_or(0.0))
    }

    /// Returns true if the platform tilted further after a stop than is allowed while the drives hold.
    pub fn tilts_after_stop(&self) -> bool {
        let growth = self.tilt_hold_mrad.zip(self.hold_bound_mrad);
        growth.is_some_and(|(growth_mrad, bound_mrad)| growth_mrad > bound_mrad)
    }

    /// Returns the ratio of the tilt to its bound.
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

/// Returns the number that states the size of a fault.
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
