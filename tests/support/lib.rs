//! Helpers of the tests that cross crates: running a scene, and reading its files.
//!
//! Other code reads the files than writes them: [`Trace`] uses the `csv` crate's reader, [`Edges`] the
//! `vcd` crate's, and the report `serde_json`. [`watch`] keeps the loop's own values, tick by tick and
//! to the bit, for checks that need more digits than a file has.
#![forbid(unsafe_code)]

mod bench;
mod edges;
pub mod scripted;
mod trace;
mod watch;

pub use bench::{SceneBuilder, bench_scene, built_in_scene};
pub use edges::{Edges, Wire};
pub use trace::Trace;
pub use watch::{Tick, Watched, watch};

use std::io::Cursor;

use cophase_files::report::Report;
use cophase_files::trace::{Every, Format, Recorder, ScopeData, ScopeFrame, Window};
use cophase_scene::{library, load};
use host_sim::checked::Checked;
use host_sim::sim::{Outcome, simulate};

/// A scene from its text.
///
/// # Panics
/// If the text is no scene, with the message that a user would get.
pub fn scene(text: &str) -> Checked {
    let scene = load::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    Checked::new(scene).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A built-in scene.
///
/// # Panics
/// If there is none of that name.
pub fn built_in(name: &str) -> Checked {
    let built_in = library::find(name).unwrap_or_else(|| panic!("no built-in scene `{name}`"));
    scene(built_in.text)
}

/// A run with its results, in memory.
#[derive(Clone, Debug)]
pub struct Run {
    /// End of the run.
    pub outcome: Outcome,
    /// `trace.csv`.
    pub csv: Vec<u8>,
    /// `steps.vcd`.
    pub vcd: Vec<u8>,
    /// `scope.svg`, without marks.
    pub svg: String,
    /// `report.json`.
    pub report: serde_json::Value,
}

impl Run {
    /// `trace.csv`, read.
    pub fn trace(&self) -> Trace {
        Trace::read(&self.csv)
    }

    /// `steps.vcd`, read.
    pub fn edges(&self) -> Edges {
        Edges::read(&self.vcd)
    }

    /// `report.json` without the fields that may differ between two runs of a scene, and, if
    /// `any_written`, between two ways to write one.
    pub fn lasting_report(&self, any_written: bool) -> serde_json::Value {
        let mut report = self.report.clone();
        let object = report.as_object_mut().expect("a report is an object");
        assert!(object.remove("speed").is_some(), "the report has a `speed`");
        if any_written {
            assert!(
                object.remove("written").is_some(),
                "the report says what was written"
            );
        }
        report
    }

    /// Kinds of the report's faults, in their order.
    pub fn fault_kinds(&self) -> Vec<&str> {
        let faults = self.report["faults"].as_array().expect("a list of faults");
        let kinds = faults.iter().map(|fault| fault["kind"].as_str());
        kinds
            .map(|kind| kind.expect("a fault has a kind"))
            .collect()
    }

    /// One of the report's figures of machines other than platforms, if it has a value.
    pub fn figure(&self, key: &str) -> Option<f64> {
        self.report["machine_figures"][key].as_f64()
    }

    /// Asserts that the run ended parked.
    ///
    /// # Panics
    /// If it did not, with its events.
    #[track_caller]
    pub fn assert_parked(&self) {
        let ended = &self.report["ended"]["state"];
        assert_eq!(ended, "parked", "{}", self.report["events"]);
    }

    /// Time spans, s, of the report's events whose words contain `what`. Each event states its
    /// duration.
    pub fn spans(&self, what: &str) -> Vec<(f64, f64)> {
        let events = self.report["events"].as_array().expect("a list of events");
        let about = events.iter().filter(|event| {
            event["what"]
                .as_str()
                .is_some_and(|words| words.contains(what))
        });
        about
            .map(|event| {
                let from_s = event["t_s"].as_f64().expect("an event has a time");
                let words = event["what"].as_str().unwrap_or_default();
                let seconds = words
                    .split(' ')
                    .zip(words.split(' ').skip(1))
                    .find(|(_, unit)| unit.trim_end_matches([',', ':']) == "s")
                    .and_then(|(number, _)| number.parse::<f64>().ok())
                    .unwrap_or_else(|| panic!("no duration in `{words}`"));
                (from_s, from_s + seconds)
            })
            .collect()
    }
}

/// Runs a scene and records it as `cophase run` does, into memory.
///
/// # Panics
/// If it cannot be recorded.
pub fn record(checked: &Checked, every: Every, window: Window) -> Run {
    let (mut csv, mut vcd) = (Cursor::new(Vec::new()), Cursor::new(Vec::new()));
    let files = [(Format::Csv, &mut csv), (Format::Vcd, &mut vcd)];
    let scope = ScopeData::new(checked.scene.axes.count, ScopeFrame::for_scene(checked));
    let mut recorder = Recorder::new(checked, files, None, every, window, scope)
        .expect("a header can be written to memory");
    let outcome = simulate(checked, &mut recorder, |_, _| {}).expect("a checked scene runs");
    let (written, scope) = recorder.finish().expect("memory takes it all");
    let report = Report::new(checked, &outcome, Some(written), 1.0);
    let report = serde_json::to_value(report).expect("a report is JSON");
    Run {
        outcome,
        csv: csv.into_inner(),
        vcd: vcd.into_inner(),
        svg: scope.render(),
        report,
    }
}
