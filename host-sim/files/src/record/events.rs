//! Conversion of the events that a controller reported into those of a run.

use cophase_core::supervisor::{Fault, State};
use cophase_link::message::{Event as Reported, EventRecord};
use host_sim::sim::events::{Event, EventKind};

use super::played_ns;

/// Converts events. For each start of the program, `runs` has the tick and the number of program ticks that had elapsed.
pub(super) fn events(records: &[EventRecord], runs: &[(u32, u32)], tick_ns: u64) -> Vec<Event> {
    let mut events = Vec::new();
    let (mut missed, mut latched) = (0, None);
    for record in records {
        let t_s = played_ns(record.tick, tick_ns) as f64 * 1e-9;
        let mut note = |what| events.push(Event { t_s, what });
        match record.event {
            Reported::State(state) => {
                let Some(&state) = State::ALL.get(usize::from(state)) else {
                    continue;
                };
                note(state_event(state, record.tick, runs, tick_ns));
                if state == State::Idle {
                    latched = None;
                }
            }
            Reported::Fault(fault) => {
                let Some(fault) = fault.fault() else { continue };
                note(EventKind::Reported(fault));
                if latched != Some(fault) {
                    latched = Some(fault);
                    note(latched_event(fault));
                }
            }
            Reported::Reported(fault) => {
                if let Some(fault) = fault.fault() {
                    note(EventKind::Reported(fault));
                }
            }
            Reported::Refused(refused) => {
                if let Some(refused) = refused.command() {
                    note(EventKind::Refused(refused));
                }
            }
            Reported::Missed(all) => {
                note(EventKind::Missed {
                    deadlines: all.saturating_sub(missed),
                });
                missed = all;
            }
            // Late deadlines and lost events. The report has the number of late deadlines.
            _ => {}
        }
    }
    events
}

fn state_event(state: State, tick: u32, runs: &[(u32, u32)], tick_ns: u64) -> EventKind {
    let from = runs.iter().find(|(from, _)| *from == tick);
    match from {
        // At this point, the first tick of the program has elapsed.
        Some((_, over)) if state == State::Run => EventKind::Running {
            from_s: f64::from(over.saturating_sub(1)) * tick_ns as f64 * 1e-9,
        },
        _ => EventKind::State(state),
    }
}

/// The events do not contain the direction of a tilt, so it is left out.
const fn latched_event(fault: Fault) -> EventKind {
    EventKind::Fault {
        fault,
        leading_deg: None,
    }
}
