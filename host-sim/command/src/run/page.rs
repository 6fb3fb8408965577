//! Parts of `scope.svg` beside the rows: the scene, and marks.

use host_sim::report;
use host_sim::scene::Checked;
use host_sim::sim::Outcome;
use host_sim::sim::events::EventKind;
use host_sim::trace::{Moved, ScopeData, ScopeFrame};

/// Returns the frame of the page for a scene.
pub(crate) fn frame(checked: &Checked) -> ScopeFrame {
    let scene = &checked.scene;
    ScopeFrame {
        title: scene.name.clone(),
        subtitle: scene.description.clone(),
        bands_hz: scene
            .limits
            .band
            .iter()
            .map(|band| (band.from_hz, band.to_hz))
            .collect(),
        gravity_mps2: host_sim::design::STANDARD_GRAVITY_MPS2,
        tilt_limit_mrad: checked
            .has_platform()
            .then_some(scene.drift.tilt_limit_mrad),
        moved: match (&checked.plant, &checked.cam) {
            (Some(plant), _) => Moved::Machine(plant.moved_part()),
            (None, Some(_)) => Moved::Pushers,
            (None, None) => Moved::Platform,
        },
        phase_error_limit_deg: None, // limits are on the modes of all phase errors, not on one
    }
}

/// Marks notable events on the page. The states have their own ribbon.
pub(super) fn mark(scope: &mut ScopeData, outcome: &Outcome) {
    let mut slips = vec![0; outcome.statistics.slipped_cycles.len()];
    if outcome
        .statistics
        .correction_deg
        .iter()
        .any(|&deg| deg != 0.0)
    {
        scope.corrected();
    }
    for event in report::notable(&outcome.statistics.events) {
        match &event.what {
            EventKind::BandCrossed { .. } => scope.mark(event.t_s, "band crossed"),
            EventKind::TurnedBackInBand { .. } => scope.mark(event.t_s, "turned back in band"),
            EventKind::HeldAtBand { .. } => scope.mark(event.t_s, "held at band"),
            EventKind::Missed { .. } => scope.mark(event.t_s, "deadlines missed"),
            EventKind::Slipped { axis, .. } => {
                slips[*axis] += 1;
                if slips[*axis] == 1 {
                    scope.mark(event.t_s, &format!("axis {axis} slips"));
                }
            }
            EventKind::Fault { fault, .. } => {
                scope.mark(event.t_s, &format!("fault: {}", fault.kind));
            }
            EventKind::Reported(fault) => {
                scope.mark(event.t_s, &format!("reported: {}", fault.kind));
            }
            EventKind::LetGo
            | EventKind::Commanded(_)
            | EventKind::Input { .. }
            | EventKind::Injected(_) => {
                scope.mark(event.t_s, &report::describe(&event.what));
            }
            EventKind::State(_)
            | EventKind::Corrected { .. }
            | EventKind::Stopped { .. }
            | EventKind::Running { .. }
            | EventKind::Lagged { .. } => {}
        }
    }
}
