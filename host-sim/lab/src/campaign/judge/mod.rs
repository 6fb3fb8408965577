//! Compares a run with the claims of the campaign.
//!
//! The truth comes from the simulated machine and the scene, and the response from the outputs of the controller. `docs/campaign.md` has
//! the definitions. Of the controller's reports, only the names are judged.

use cophase_core::supervisor::{FaultKind, State};
use cophase_scene::file::{AxisOverrides, FaultAt, FaultName, Scene};
use host_sim::axes::{Axes, per_axis};
use host_sim::checked::Checked;
use host_sim::drives::DriveModel;

use super::bound;
use super::geometry::Geometry;
use super::hold;
use super::names::{self, Circumstances};
use super::response::Responded;
use super::watch::{Observation, ReportedFault};

/// Largest travel that may be rounding, steps: one step in either direction. Any longer travel is motion.
const ROUNDING_STEPS: f64 = 2.0;

/// Verdict on a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The fault was reported with a right name.
    Right,
    /// The fault was reported or stopped the machine, but without a right name.
    Misnamed,
    /// The fault was not reported although its kind must be. Or it was neither stopped nor corrected although a crank was beyond its limit.
    Missed,
    /// The fault was not detected in time, and [no monitor can](Observation::is_hidden) by these sensors.
    NotDecidable,
    /// Nothing was reported, and nothing had to be: no crank was beyond its limit.
    Within,
    /// The machine did not move when the fault came, or not for long enough after it. Or motors lost steps by themselves in a clean run, so
    /// that the run was not clean.
    Moot,
    /// Nothing was reported in a clean run.
    Clean,
    /// Something was reported, or the machine stopped, before anything was wrong.
    FalseTrip,
    /// The simulation of the machine diverged.
    Diverged,
}

/// Judgement of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Verdict on the run.
    pub verdict: Verdict,
    /// True if the fault was detected before cranks had stayed beyond a limit for longer than is allowed. None if no crank passed a limit,
    /// if nothing was detected and no crank stayed for so long, or if the verdict is [`Verdict::NotDecidable`].
    pub in_time: Option<bool>,
    /// Turns of the master from the crank passing its limit to three ticks before the detection; below 0 if the detection was earlier.
    pub turns: Option<f64>,
    /// Time of the detection, s since power-up.
    pub detected_s: Option<f64>,
    /// Largest tilt of the platform that is allowed, mrad.
    pub bound_mrad: f64,
    /// Largest further tilt after a stop that is allowed while the drives hold, mrad. None if they never held.
    pub hold_bound_mrad: Option<f64>,
    /// True if an axis was left running.
    pub left_running: bool,
}

/// Judges a run from its record. `diverged` is true if its simulation diverged, and `slipped` if a motor slipped by itself.
pub fn judge(
    scene: &Scene,
    geometry: Option<&Geometry>,
    observation: &Observation,
    (diverged, slipped): (bool, bool),
) -> Judgement {
    let bound_mrad = geometry.map_or(0.0, |geometry| {
        bound::tilt_mrad(scene, geometry, observation.out.as_ref())
    });
    let steps = scene.resolved(0).steps_per_crank_turn();
    let detected = detection(observation);
    let in_time = in_time(detected, observation);
    let is_hidden = detected.map_or(observation.is_hidden, |detected| detected.is_hidden);
    let is_decidable = in_time != Some(false) || !is_hidden;
    let verdict = match scene.fault.first() {
        _ if diverged => Verdict::Diverged,
        None if slipped => Verdict::Moot,
        _ if !observation.early.is_empty() || observation.stopped_early => Verdict::FalseTrip,
        None => Verdict::Clean,
        Some(_) if !is_decidable => Verdict::NotDecidable,
        Some(fault) => verdict(scene, fault, observation),
    };
    let hold_bound_mrad = (observation.hold.rest_s.zip(geometry))
        .map(|(rest_s, geometry)| hold::allowed_mrad(scene, geometry, rest_s));
    let turns = detected.zip(observation.beyond_limit);
    Judgement {
        verdict,
        in_time: in_time.filter(|_| is_decidable),
        turns: turns.map(|(detected, beyond_limit)| detected.turns - beyond_limit.turns),
        detected_s: detected.map(|detected| detected.place.t_s),
        bound_mrad,
        hold_bound_mrad,
        left_running: observation.left_running_turns * steps > ROUNDING_STEPS,
    }
}

/// Returns the response that counts as the detection of the fault. This is the first in which the machine stops or its drives go off, or a
/// correction before that, if it suffices.
///
/// A correction suffices if two things hold. The cranks never stay beyond their limits for longer than is allowed. They are within them at
/// the end of the run, or at the stop if there is one.
pub fn detection(observation: &Observation) -> Option<&Responded> {
    let stopped = observation.stopped.as_ref();
    let is_back = match (stopped, observation.beyond_limit) {
        (Some(stopped), Some(beyond_limit)) => {
            !stopped.is_beyond_limit && beyond_limit.moment < stopped.place.moment
        }
        (Some(_), None) => false,
        (None, _) => !observation.is_beyond_limit,
    };
    let suffices = is_back && observation.stay_turns <= observation.may_stay_turns;
    let corrected = observation.corrected.as_ref().filter(|_| suffices);
    match (corrected, stopped) {
        (Some(corrected), Some(stopped)) if stopped.place.moment <= corrected.place.moment => {
            Some(stopped)
        }
        (corrected, stopped) => corrected.or(stopped),
    }
}

/// Returns [`Judgement::in_time`].
fn in_time(detected: Option<&Responded>, observation: &Observation) -> Option<bool> {
    observation.beyond_limit?;
    match detected {
        Some(detected) => Some(detected.stay_turns <= observation.may_stay_turns),
        None => (observation.stay_turns > observation.may_stay_turns).then_some(false),
    }
}

/// Returns true if a report names an axis that may be right.
fn is_of(scene: &Scene, fault: &FaultAt, reported: &ReportedFault) -> bool {
    let axes = [fault.axis, fault.with];
    // Two cranks that seem far off, in opposite directions, make the third one seem far off as well. Of two cranks, the sensors cannot show
    // which one is off.
    let any = reported.kind == FaultKind::HomingRangeExceeded
        && (fault.kind == FaultName::SwappedWiring || scene.axes.count == 2);
    any || !names::has_axis(fault.kind)
        || (reported.axis.is_some() && axes.contains(&reported.axis))
}

fn verdict(scene: &Scene, fault: &FaultAt, observation: &Observation) -> Verdict {
    let Some((injected, end)) = observation.injected.zip(observation.end) else {
        return Verdict::Moot;
    };
    let stood = !matches!(injected.state, State::Homing | State::Run | State::Stop);
    let from_power_up = matches!(fault.kind, FaultName::SwappedWiring | FaultName::Reversed);
    if stood
        && !from_power_up
        && observation.fault_events.is_empty()
        && observation.beyond_limit.is_none()
    {
        return Verdict::Moot;
    }
    if observation.fault_events.is_empty() {
        let had_time = end.turns - injected.turns > names::turns_to_report(fault);
        // In homing, a first pulse at the place where the crank was left does not count.
        let may_be_first = fault.kind == FaultName::IndexExtra && injected.state == State::Homing;
        let is_harmless = observation.extra.is_some_and(|extra| extra.is_harmless);
        let must = names::must_be_reported(fault.kind) && !may_be_first && !is_harmless;
        if observation.stopped.is_some() {
            // The machine stopped without a name for the fault.
            return Verdict::Misnamed;
        }
        return match (
            observation.beyond_limit.map(|_| in_time(None, observation)),
            must,
        ) {
            (Some(Some(_)), _) => Verdict::Missed,
            (Some(None), _) => Verdict::Moot,
            (None, true) if had_time => Verdict::Missed,
            (None, true) => Verdict::Moot,
            (None, false) => Verdict::Within,
        };
    }
    let too_late = in_time(detection(observation), observation) == Some(false);
    if too_late && observation.stopped.is_none() {
        return Verdict::Missed;
    }
    let accepted = names::accepted(
        fault,
        Circumstances {
            has_encoder: scene.axes.encoder,
            is_stepper: scene
                .resolved(fault.axis.unwrap_or_default())
                .drive
                .kind()
                .is_open_loop(),
            watches_following_error: watches_following_error(scene, fault),
            in_homing: injected.state == State::Homing || stood,
            is_beyond_limit: observation.beyond_limit.is_some(),
            opposed: differs(scene, fault, |apart| f64::from(u8::from(apart.reversed))),
            stood_first: !observation.passed_after,
            flags_apart: differs(scene, fault, |own| own.index_deg.unwrap_or_default()),
        },
    );
    let is_right = |reported: &ReportedFault| {
        accepted.contains(&reported.kind) && is_of(scene, fault, reported)
    };
    // The latched fault counts, with its final name. If nothing latched, all reported faults count.
    let right = match &observation.fault {
        Some(reported) => is_right(reported),
        None => {
            !observation.reported_faults.is_empty()
                && observation.reported_faults.iter().all(is_right)
        }
    };
    if right {
        Verdict::Right
    } else {
        Verdict::Misnamed
    }
}

/// Returns true if the drive of a fault's axis raises its alarm when its motor does not follow.
fn watches_following_error(scene: &Scene, fault: &FaultAt) -> bool {
    let drive = scene.resolved(fault.axis.unwrap_or_default()).drive;
    (DriveModel::for_drive(drive).window_deg)(&scene.axes).is_some()
}

/// Returns true if the two axes of a swap differ in one of their own settings.
fn differs(scene: &Scene, fault: &FaultAt, what: fn(&AxisOverrides) -> f64) -> bool {
    let own = |axis: usize| scene.axis.iter().find(|own| own.number == axis);
    let of = |axis: Option<usize>| own(axis?).map(what);
    of(fault.axis) != of(fault.with)
}

/// Returns the axes whose cranks must stop, and not only their commands: those whose drives move the cranks as commanded. A drive does not
/// move a crank that slips or is stuck, and a crank that torque moves swings on.
pub fn cranks_that_count(checked: &Checked) -> Axes<bool> {
    let scene = &checked.scene;
    let is_faulted = |axis: usize| {
        scene.fault.first().is_some_and(|fault| {
            matches!(fault.kind, FaultName::Slip | FaultName::Stuck) && fault.axis == Some(axis)
        })
    };
    per_axis(scene.axes.count, |axis| {
        !checked.moves_by_torque() && !is_faulted(axis)
    })
}

#[cfg(test)]
mod tests;
