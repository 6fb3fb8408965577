//! A run, read back from its files.

use std::path::{Path, PathBuf};

use cophase_core::supervisor::State;
use cophase_scene::file_kind::FileKind;
use cophase_scene::library;
use serde::Serialize;

use super::RunSummary;
use super::error::CompareError;
use super::events::Events;
use super::trace::{STATE, Trace, Values};

/// Files of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Folder or trace, as it was given.
    pub path: PathBuf,
    /// `trace.csv`.
    pub trace: Trace,
    /// `steps.vcd`, if it is there.
    pub steps: Option<PathBuf>,
    /// Events of `report.json`, if it is there.
    pub(super) events: Option<Events>,
}

impl Run {
    /// Reads the folder of a run, or a trace alone.
    ///
    /// # Errors
    /// There is no trace, or a file is not one of a run.
    pub fn read(path: &Path) -> Result<Self, CompareError> {
        let is_folder = path.is_dir();
        let file = |name: &str| Some(path.join(name)).filter(|file| is_folder && file.exists());
        let trace = if is_folder {
            path.join("trace.csv")
        } else {
            path.to_owned()
        };
        if !trace.is_file()
            && let Some(problem) = without_trace(path, &trace)
        {
            return Err(CompareError::new(&trace, problem));
        }
        if let Some(problem) = instead(&trace) {
            return Err(CompareError::new(&trace, problem));
        }
        Ok(Self {
            path: path.to_owned(),
            trace: Trace::read(&trace)?,
            steps: file("steps.vcd"),
            events: file("report.json")
                .map(|file| Events::read(&file))
                .transpose()?,
        })
    }

    /// Creates a run that has a trace only.
    pub fn of_trace(path: PathBuf, trace: Trace) -> Self {
        Self {
            path,
            trace,
            steps: None,
            events: None,
        }
    }

    pub(super) fn summary(&self) -> RunSummary {
        let seconds = |t_ns: i64| t_ns as f64 * 1e-9;
        let times = self.trace.times_ns();
        let end = |t_ns: Option<&i64>| t_ns.map_or(0.0, |t_ns| seconds(*t_ns));
        RunSummary {
            path: self.path.display().to_string(),
            rows: times.len(),
            from_s: end(times.first()),
            to_s: end(times.last()),
            spacing_s: times
                .windows(2)
                .next()
                .map_or(0.0, |pair| seconds(pair[1] - pair[0])),
            starts_s: self.start_of_events().or(self.start_of_rows()).map(seconds),
        }
    }

    /// Returns the time at which it leaves idle, to the tick, ns since power-up.
    fn start_of_events(&self) -> Option<i64> {
        self.events.as_ref()?.start_ns()
    }

    /// Start of its first row that is not idle, ns since power-up.
    fn start_of_rows(&self) -> Option<i64> {
        let Values::Words(states) = self.trace.column(STATE) else {
            return None;
        };
        let row = states
            .iter()
            .position(|state| state != State::Idle.name())?;
        let times = self.trace.times_ns();
        let spacing = times.windows(2).next().map_or(0, |pair| pair[1] - pair[0]);
        Some(times.get(row)? - spacing)
    }
}

/// Returns what is wrong with a place that has no trace: a folder, or the name of a built-in scene.
fn without_trace(path: &Path, trace: &Path) -> Option<String> {
    let shown = path.display();
    if path.is_dir() && !trace.exists() {
        let is_of_run = path.join("report.json").exists();
        return Some(if is_of_run {
            format!(
                "is not there, as {shown} is of a run without it; run it again with csv in --trace"
            )
        } else {
            format!(
                "is not there, so {shown} is not the folder of a run; give one that `cophase run` wrote"
            )
        });
    }
    let name = path.to_str().filter(|_| !path.exists())?;
    library::find(name).map(|_| {
        format!(
            "is the name of a built-in scene, not a run; {}",
            run_first(path)
        )
    })
}

/// Returns what is wrong with a file that is not a table, if its kind is known.
fn instead(path: &Path) -> Option<String> {
    let kind = FileKind::from_path(path)?;
    match kind {
        FileKind::Table => return None,
        FileKind::Scene => {
            return Some(format!("is a scene, not a run; {}", run_first(path)));
        }
        _ => {}
    }
    // The other files of a run are beside its trace.
    let trace = path.with_file_name("trace.csv");
    let fix = if trace.is_file() {
        trace.display().to_string()
    } else {
        "the folder of a run, or its trace.csv".to_owned()
    };
    Some(format!("is {kind} and no trace of a run; give {fix}"))
}

fn run_first(scene: &Path) -> String {
    let scene = scene.display();
    format!("run it first: cophase run {scene} --out DIR, then compare DIR")
}

/// Time from which all times are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// Power-up of each controller.
    #[default]
    PowerUp,
    /// The moment at which each machine leaves idle.
    Start,
}

impl Origin {
    /// Its name, as in "time since …".
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::PowerUp => "power-up",
            Self::Start => "each run left idle",
        }
    }

    /// Origins of two runs, ns since power-up.
    pub(super) fn of(self, runs: [&Run; 2]) -> Result<[i64; 2], CompareError> {
        if self == Self::PowerUp {
            return Ok([0; 2]);
        }
        // Both origins come from the same source, because rows give the moment only to the distance
        // of two rows.
        if let [Some(first), Some(second)] = runs.map(Run::start_of_events) {
            return Ok([first, second]);
        }
        let start = |run: &Run| {
            run.start_of_rows().ok_or_else(|| {
                let problem = "it never leaves idle; leave out --from start";
                CompareError::new(&run.path, problem)
            })
        };
        Ok([start(runs[0])?, start(runs[1])?])
    }
}
