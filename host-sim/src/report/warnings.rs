//! What a reader should not overlook: where the simulated machine and its controller disagree, or where
//! the run does not show what was asked.

use cophase_core::supervisor::State;

use crate::scene::Checked;
use crate::scene::file::{FaultAt, FaultName};
use crate::sim::Outcome;

/// Warnings, a sentence each.
pub fn warnings(checked: &Checked, outcome: &Outcome) -> Vec<String> {
    let (scene, seen) = (&checked.scene, &outcome.statistics);
    let mut warnings = Vec::new();
    let unwatched: Vec<String> = (0..scene.axes.count)
        .filter(|&axis| !checked.has_index(axis))
        .map(|axis| axis.to_string())
        .collect();
    if !unwatched.is_empty() {
        warnings.push(format!(
            "Without an index sensor the drift of axis {} is not watched; drift_deg is 0 there for want of a measurement.",
            unwatched.join(", ")
        ));
    }
    if let Some(why) = &outcome.diverged {
        warnings.push(format!(
            "The simulated machine diverged, and the run was ended there: {why}."
        ));
    }
    let undamped = scene.axes.damping_nms == 0.0 && !scene.axes.pull_out.is_empty();
    if undamped && checked.fidelity.moves_by_torque() {
        warnings.push(
            "Steppers without axes.damping_nms swing on for ever: real drives damp them, so give what yours do."
                .to_owned(),
        );
    }
    if outcome.slipped_unseen() {
        warnings.push("A motor slipped, and the controller did not see it.".to_owned());
    }
    let limit_mrad = scene.drift.tilt_limit_mrad;
    if seen.worst_tilt_mrad > limit_mrad {
        warnings.push(format!(
            "The platform tilted by {:.2} mrad, past its limit of {limit_mrad}: an index is heard once a turn, and what \
             moves a crank, or holds it, does so until all stand (docs/faults.md).",
            seen.worst_tilt_mrad
        ));
    }
    let swapped = |fault: &FaultAt| fault.kind == FaultName::SwappedWiring;
    if scene.fault.iter().any(swapped) && outcome.fault.is_none() && outcome.watch.told.is_empty() {
        warnings.push(
            "Lines of two axes were swapped, and the controller did not find out: correction.prove_wiring looks for that."
                .to_owned(),
        );
    }
    if outcome.diverged.is_none() && !matches!(outcome.state, State::Parked | State::Fault) {
        warnings.push(format!(
            "The machine was still in state `{}` when nothing more was to happen; the run was ended there.",
            outcome.state.name()
        ));
    }
    warnings
}
