//! Marks of `scope.svg`.

use host_sim::sim::RunRecord;
use host_sim::sim::events::{Event, EventKind};

use super::describe;
use crate::trace::ScopeData;

/// Marks events of a run on the page. The states have their own ribbon.
pub fn mark<'a>(
    scope: &mut ScopeData,
    record: &RunRecord,
    events: impl IntoIterator<Item = &'a Event>,
) {
    let mut slips = vec![0; record.axes.len()];
    if record.axes.iter().any(|axis| axis.correction_deg != 0.0) {
        scope.corrected();
    }
    for event in events {
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
                scope.mark(event.t_s, &describe(&event.what));
            }
            EventKind::State(_)
            | EventKind::Corrected { .. }
            | EventKind::Stopped { .. }
            | EventKind::Running { .. }
            | EventKind::Lagged { .. } => {}
        }
    }
}
