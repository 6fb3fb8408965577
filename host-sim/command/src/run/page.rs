//! Marks of `scope.svg`.

use cophase_files::report;
use cophase_files::trace::ScopeData;
use host_sim::sim::Outcome;
use host_sim::sim::events::EventKind;

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
            EventKind::Refused(refused) => {
                scope.mark(event.t_s, &format!("refused: {}", refused.command.name()));
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
