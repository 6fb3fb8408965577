//! Events of two reports: states and faults, which every controller reports.
//!
//! Other events are the simulator's. They follow from the signals, which the columns compare.

use std::path::Path;

use cophase_core::supervisor::State;
use cophase_scene::input_file::{self, MAX_TABLE_BYTES};
use host_sim::sim::events::EventKind;
use serde::{Deserialize, Serialize};

use super::error::CompareError;
use super::run::Run;
use crate::report::describe;

/// Events of a `report.json`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Events {
    list: Vec<Event>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Event {
    t_s: f64,
    what: String,
}

#[derive(Deserialize)]
struct Report {
    events: Vec<Event>,
}

impl Event {
    fn t_ns(&self) -> i64 {
        (self.t_s * 1e9).round() as i64
    }

    /// Returns its description without the part after a semicolon, which only the simulator adds.
    fn words(&self) -> &str {
        self.what
            .split_once(';')
            .map_or(&self.what, |(words, _)| words)
    }

    fn is_of_every_controller(&self) -> bool {
        let state = |state: &State| describe(&EventKind::State(*state)) == self.words();
        let starts = [
            "fault: ",
            "reported: ",
            "refused: ",
            "running the program",
            "going on",
        ];
        State::ALL.iter().any(state) || starts.iter().any(|start| self.what.starts_with(start))
    }
}

impl Events {
    pub(super) fn read(path: &Path) -> Result<Self, CompareError> {
        let wrong = |problem: String| CompareError::new(path, problem);
        let text = input_file::read(path, MAX_TABLE_BYTES).map_err(|e| {
            wrong(format!(
                "{e}; give the folder of a run, or its trace.csv alone"
            ))
        })?;
        let report: Report = serde_json::from_slice(&text).map_err(|e| {
            wrong(format!(
                "{e}; write the run again, or give its trace.csv alone"
            ))
        })?;
        let list = report.events.into_iter();
        Ok(Self {
            list: list.filter(Event::is_of_every_controller).collect(),
        })
    }

    /// Returns the time at which homing first began: the machine then leaves idle.
    pub(super) fn start_ns(&self) -> Option<i64> {
        let homing = describe(&EventKind::State(State::Homing));
        let first = self.list.iter().find(|event| event.what == homing)?;
        Some(first.t_ns())
    }
}

/// Events that differ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventDifference {
    /// Events that both have, at the same times.
    pub equal: usize,
    /// Events of the first run after those.
    pub first_has: usize,
    /// Events of the second run after those.
    pub second_has: usize,
    /// Time of the first one that differs, s.
    pub at_s: Option<f64>,
    /// That event of each run, with its time.
    pub events: [Option<String>; 2],
}

/// Compares the events of two runs. `None` if a run has no report.
pub(super) fn compare(runs: [&Run; 2], origins: [i64; 2]) -> Option<EventDifference> {
    let of = |i: usize| {
        let all = runs[i].events.as_ref()?.list.iter();
        let from_origin = all.map(|event| (event.t_ns() - origins[i], event.words()));
        // Before the start, the machine is idle.
        Some(
            from_origin
                .filter(|(t_ns, _)| *t_ns >= 0)
                .collect::<Vec<_>>(),
        )
    };
    let (first, second) = (of(0)?, of(1)?);
    let equal = first
        .iter()
        .zip(&second)
        .take_while(|(a, b)| a == b)
        .count();
    let next = [first.get(equal), second.get(equal)];
    let seconds = |t_ns: i64| t_ns as f64 * 1e-9;
    Some(EventDifference {
        equal,
        first_has: first.len() - equal,
        second_has: second.len() - equal,
        at_s: next
            .into_iter()
            .flatten()
            .map(|(t_ns, _)| *t_ns)
            .min()
            .map(seconds),
        events: next
            .map(|event| event.map(|(t_ns, what)| format!("{:.4} s {what}", seconds(*t_ns)))),
    })
}
