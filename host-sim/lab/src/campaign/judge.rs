//! Holds a run against what the campaign claims.
//!
//! A crank past a limit is *detected* when the machine is brought to where it does no harm, for a reason that has to do with that
//! crank ([`detection`]). That something else was told before, which the loop goes on from, is no detection: nobody need be there
//! to read it. Nor is a stop for another crank's sake, as the next machine would not stop for that; unless torque dragged that one along.

use cophase_core::supervisor::reaction::Reaction;
use cophase_core::supervisor::{FaultKind, State};

use host_sim::axes::{Axes, per_axis};
use host_sim::scene::file::{AxisApart, FaultAt, FaultName, Scene};

use super::bound;
use super::geometry::Geometry;
use super::names::{self, Circumstances};
use super::plan::faults::driven;
use super::plan::machines::Driven;
use super::watch::{Seen, Telling, Told};

/// What a crank is from where it was told to be for rounding: a step either way. More than this, it was moved.
const ROUNDING_STEPS: f64 = 2.0;

/// What a faulty run comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Told, and rightly.
    Right,
    /// Told, and wrongly.
    Misnamed,
    /// Not told, though the kind is one that must be; or neither stopped for nor mended, though a crank was past its limit.
    Missed,
    /// Nothing was told, and nothing had to be: no crank was past its limit.
    Within,
    /// The machine did not move when it came, or not for long enough after it; or, in a clean run, motors lost steps of
    /// themselves, so that it was none.
    Moot,
    /// A clean run in which nothing was told.
    Clean,
    /// Something was told before anything was wrong.
    FalseTrip,
    /// The machine's equations came to an end.
    Diverged,
}

/// The judgement of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Rightly told or not.
    pub verdict: Verdict,
    /// Whether it was detected within one turn and two ticks of a crank passing its limit; none where no crank did, or where the
    /// machine stood before the turn was over, and not for another crank's sake.
    pub in_time: Option<bool>,
    /// Turns of the master from the crank passing its limit to two ticks before it was detected; below 0, it was before.
    pub turns: Option<f64>,
    /// When it was detected, s since power-up.
    pub detected_s: Option<f64>,
    /// Most that the platform may tilt, mrad.
    pub bound_mrad: f64,
    /// An axis was left running.
    pub left_running: bool,
}

/// Judges a run by what was seen in it, and by whether its machine's equations came to an end or a motor slipped of itself.
pub fn judge(
    scene: &Scene,
    geometry: Option<&Geometry>,
    seen: &Seen,
    (diverged, slipped): (bool, bool),
) -> Judgement {
    let bound_mrad = geometry.map_or(0.0, |geometry| {
        bound::tilt_mrad(scene, geometry, seen.out.as_ref())
    });
    let steps = f64::from(scene.axes.steps_per_turn);
    let verdict = match scene.fault.first() {
        _ if diverged => Verdict::Diverged,
        None if slipped => Verdict::Moot,
        _ if !seen.early.is_empty() => Verdict::FalseTrip,
        None => Verdict::Clean,
        Some(fault) => verdict(scene, fault, seen),
    };
    let fault = scene.fault.first();
    let detected = fault.and_then(|fault| detection(scene, fault, seen));
    let turns = detected.zip(seen.past);
    Judgement {
        verdict,
        in_time: in_time(detected, seen),
        turns: turns.map(|(detected, past)| detected.turns - past.turns),
        detected_s: detected.map(|detected| detected.place.t_s),
        bound_mrad,
        left_running: seen.left_running_turns * steps > ROUNDING_STEPS,
    }
}

/// What the loop told of a fault that counts as its detection: the first that made it stop, or disable the drives, on the axis that
/// it befell, on one whose crank it moved as well, or on none. If cranks that had been past their limits were within them again by then,
/// or at the end where nothing did, and never past them for longer than a turn, the first that had it trim that axis: what is trimmed
/// away in time need not stop a machine, and what goes on past its limit must.
pub fn detection<'a>(scene: &Scene, fault: &FaultAt, seen: &'a Seen) -> Option<&'a Telling> {
    let of_it = |telling: &&Telling| {
        telling.told.axis.is_none() || telling.is_moved || is_of(scene, fault, &telling.told)
    };
    let tellings = || seen.tellings.iter().filter(of_it);
    let stop = tellings().find(|telling| telling.done >= Reaction::Stop);
    let is_back = match (stop, seen.past) {
        (Some(stop), Some(past)) => !stop.is_past && past.moment < stop.place.moment,
        (Some(_), None) => false,
        (None, _) => !seen.is_past,
    };
    // For longer than a turn nothing may be past its limit, corrected or not.
    let mended = scene.correction.part > 0.0 && is_back && seen.stay_turns <= 1.0;
    let counts = |telling: &&Telling| {
        telling.done >= Reaction::Stop || mended && telling.done == Reaction::Correct
    };
    tellings().find(counts)
}

/// See [`Judgement::in_time`].
fn in_time(detected: Option<&Telling>, seen: &Seen) -> Option<bool> {
    let past = seen.past?;
    match detected {
        Some(detected) => Some(detected.turns - past.turns <= 1.0),
        None if seen.fault.is_some() => Some(false),
        None => (seen.end?.turns - past.turns > 1.0).then_some(false),
    }
}

/// Whether what was told is of an axis that it may be of.
fn is_of(scene: &Scene, fault: &FaultAt, told: &Told) -> bool {
    let axes = [fault.axis, fault.with];
    // Two cranks that seem far out, each its own way, make the third look so as well.
    // And of two cranks nobody knows which is out.
    let any = told.kind == FaultKind::TooFarOut
        && (fault.kind == FaultName::SwappedWiring || scene.axes.count == 2);
    any || !names::has_axis(fault.kind) || (told.axis.is_some() && axes.contains(&told.axis))
}

fn verdict(scene: &Scene, fault: &FaultAt, seen: &Seen) -> Verdict {
    let Some((injected, end)) = seen.injected.zip(seen.end) else {
        return Verdict::Moot;
    };
    let stood = !matches!(injected.state, State::Align | State::Run | State::Stop);
    let from_power_up = matches!(fault.kind, FaultName::SwappedWiring | FaultName::Reversed);
    if stood && !from_power_up && seen.tellings.is_empty() && seen.past.is_none() {
        return Verdict::Moot;
    }
    if seen.tellings.is_empty() {
        let had_time = end.turns - injected.turns > names::turns_to_tell(fault);
        // An extra pulse before the first is the first, if nothing tells otherwise; what it would have moved is looked at again.
        let may_be_first = fault.kind == FaultName::IndexExtra && injected.state == State::Align;
        let is_in_place = seen.extra.is_some_and(|extra| extra.is_in_place);
        let must = names::must_be_told(fault.kind) && !may_be_first && !is_in_place;
        return match (seen.past.map(|_| in_time(None, seen)), must) {
            (Some(Some(_)), _) => Verdict::Missed,
            (Some(None), _) => Verdict::Moot,
            (None, true) if had_time => Verdict::Missed,
            (None, true) => Verdict::Moot,
            (None, false) => Verdict::Within,
        };
    }
    let too_late = in_time(detection(scene, fault, seen), seen) == Some(false);
    if too_late && seen.fault.is_none() {
        return Verdict::Missed;
    }
    let accepted = names::accepted(
        fault,
        Circumstances {
            has_encoder: scene.axes.encoder,
            is_stepper: driven(scene, fault.axis.unwrap_or_default()) != Driven::Servo,
            in_align: injected.state == State::Align || stood,
            is_past: seen.past.is_some(),
            opposed: differs(scene, fault, |apart| f64::from(u8::from(apart.reversed))),
            stood_first: !seen.passed_after,
            flags_apart: differs(scene, fault, |apart| apart.index_deg.unwrap_or_default()),
        },
    );
    let is_right = |told: &Told| accepted.contains(&told.kind) && is_of(scene, fault, told);
    // What latched is what counts, as it was called at last; where nothing did, all that was told.
    let right = match &seen.fault {
        Some(told) => is_right(told),
        None => !seen.incidents.is_empty() && seen.incidents.iter().all(is_right),
    };
    if right {
        Verdict::Right
    } else {
        Verdict::Misnamed
    }
}

/// Whether the two axes of a swap differ in something that each has apart.
fn differs(scene: &Scene, fault: &FaultAt, what: fn(&AxisApart) -> f64) -> bool {
    let of = |axis: Option<usize>| scene.apart(axis?).map(what);
    of(fault.axis) != of(fault.with)
}

/// Of which axes the cranks must stop, and not only the commands: those that their drives move as told. A crank that slips is not
/// moved by its drive, one that stands for a while is not either, and one that torque moves swings on.
pub fn cranks_that_count(scene: &Scene) -> Axes<bool> {
    let astray = |axis: usize| {
        scene.fault.first().is_some_and(|fault| {
            matches!(fault.kind, FaultName::Slip | FaultName::Stuck) && fault.axis == Some(axis)
        })
    };
    per_axis(scene.axes.count, |axis| {
        !scene.fidelity.moves_by_torque() && !astray(axis)
    })
}

#[cfg(test)]
mod tests;
