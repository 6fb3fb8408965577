//! Elementary functions: error against cost on the board.
//!
//! The emulator measured errors and cycles (`docs/emulated-functions.csv`, which `tests/emulator/functions/measure.mjs` writes). The
//! data also has the duration of a call on the machine that draws the chart, if the same crate runs there.

mod host;

use std::fmt::Write;

use super::axis::Axis;
use super::ink::{Ink, Stroke};
use super::picture::{Line, Panel, Picture, render};
use super::yardstick::Yardstick;
use super::{ChartError, Drawn, Progress, Size};

const MEASURED: &str = include_str!("../../../../../docs/emulated-functions.csv");
/// Panel of a function.
struct Shown {
    /// Name in the data.
    function: &'static str,
    /// Function that the controller calls.
    called: &'static str,
    /// Range of errors.
    errors: (f64, f64),
    /// Kind of error.
    axis: &'static str,
}

const PANELS: [Shown; 3] = [
    Shown {
        function: "root",
        called: "cophase `root`",
        errors: (1e-10, 10.0),
        axis: "largest error, relative",
    },
    Shown {
        function: "sine, cosine",
        called: "cophase `sine_cosine`",
        errors: (1e-10, 1e-2),
        axis: "largest error of either",
    },
    Shown {
        function: "arctangent",
        called: "micromath `atan2`",
        errors: (1e-10, 10.0),
        axis: "largest error, rad",
    },
];

/// Sources of functions: the start of a candidate's name, the name of its points, and their colour.
const OFFERED: [(&str, &str, Ink); 8] = [
    ("cophase", "cophase", Ink::Blue),
    ("micromath", "micromath", Ink::Orange),
    ("libm", "libm", Ink::Vermilion),
    ("idsp", "idsp", Ink::Green),
    ("cordic", "cordic", Ink::Purple),
    ("table", "table", Ink::Black),
    ("the same", "table", Ink::Black),
    ("", "core, fixed, fixed_analytics, fixed-sqrt", Ink::Sky),
];

/// Measured function.
struct Candidate {
    name: String,
    function: String,
    format: String,
    error_rms: String,
    error_max: f64,
    cycles_mean: f64,
    cycles_max: String,
    bytes: String,
}

impl Candidate {
    fn offered_by(&self) -> (&'static str, Ink) {
        let by = OFFERED
            .iter()
            .find(|(begins, ..)| self.name.starts_with(begins));
        by.map_or(("", Ink::Grey), |(_, by, ink)| (by, *ink))
    }

    /// Returns the name of its point; the crate is in the legend.
    fn point(&self) -> String {
        // Some crates share a colour, so their points have full names.
        let is_shared = self.offered_by().1 == Ink::Sky;
        let (_, called) = match self.name.split_once('`') {
            Some(named) if !is_shared => named,
            _ => ("", self.name.as_str()),
        };
        let kind = self.format.rsplit([',', ' ']).next().unwrap_or_default();
        let is_plain = matches!(kind, "f32" | "f64" | "I16F16" | "U32F32");
        let called = called.replace('`', "");
        let called = called
            .replace("the same, products in", "linear,")
            .replace("straight lines", "linear");
        if is_plain {
            format!("{called} {kind}")
        } else {
            called
        }
    }
}

/// Makes the chart.
pub fn draw(_: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let candidates = read()?;
    let yardstick = Yardstick::measure();
    let mut csv =
        "function,candidate,format,error_rms,error_max,cycles_mean,cycles_max,bytes,timing\n"
            .to_owned();
    let shown = |candidate: &&Candidate| {
        PANELS
            .iter()
            .any(|panel| candidate.function == panel.function)
    };
    let of = candidates.iter().filter(shown).count() as u64;
    for (done, candidate) in candidates.iter().filter(shown).enumerate() {
        let timing = host::sines_a_call(&candidate.name, &candidate.format, yardstick);
        // Writing to a string cannot fail.
        let _ = writeln!(
            csv,
            "\"{}\",\"{}\",\"{}\",{},{:e},{},{},{},{}",
            candidate.function,
            candidate.name,
            candidate.format,
            candidate.error_rms,
            candidate.error_max,
            candidate.cycles_mean,
            candidate.cycles_max,
            candidate.bytes,
            timing.map_or_else(String::new, |sines| format!("{sines:.2}")),
        );
        progress(done as u64 + 1, of);
    }
    let says: Vec<String> = PANELS
        .iter()
        .map(|shown| beaten(&candidates, shown))
        .collect();
    let says = format!(
        "{} What errs by nothing at all is not shown. Formats differ, and so do errors that come of them.",
        says.join(" ")
    );
    let panels = PANELS.iter().map(|shown| panel(&candidates, shown));
    let svg = render(Picture {
        title: "Elementary functions: error against cycles on the board".to_owned(),
        says: says.clone(),
        columns: 3,
        chosen_is: "called by the controller",
        panels: panels.collect(),
    });
    Ok(Drawn::one(csv, svg, says))
}

fn read() -> Result<Vec<Candidate>, ChartError> {
    let wrong =
        |error: &dyn std::fmt::Display| ChartError(format!("docs/emulated-functions.csv: {error}"));
    let mut reader = csv::Reader::from_reader(MEASURED.as_bytes());
    let header = reader.headers().map_err(|error| wrong(&error))?.clone();
    let mut candidates = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| wrong(&error))?;
        let text = |key: &str| {
            let column = header.iter().position(|name| name == key);
            let cell = column.and_then(|column| record.get(column));
            cell.map(str::to_owned)
                .ok_or_else(|| wrong(&format!("there is no column {key}")))
        };
        let number = |key: &str| text(key)?.parse::<f64>().map_err(|error| wrong(&error));
        candidates.push(Candidate {
            name: text("candidate")?,
            function: text("function")?,
            format: text("format")?,
            error_rms: text("error_rms")?,
            error_max: number("error_max")?,
            cycles_mean: number("cycles_mean")?,
            cycles_max: text("cycles_max")?,
            bytes: text("bytes")?,
        });
    }
    Ok(candidates)
}

fn panel(candidates: &[Candidate], shown: &Shown) -> Panel {
    let mut lines: Vec<Line> = Vec::new();
    for candidate in candidates
        .iter()
        .filter(|candidate| candidate.function == shown.function)
    {
        let (by, ink) = candidate.offered_by();
        let chosen = candidate.name == shown.called;
        let point = (candidate.cycles_mean, candidate.error_max);
        let of_kind = |line: &&mut Line| line.label == by && line.chosen == chosen;
        match lines.iter_mut().find(of_kind) {
            Some(line) => {
                line.points.push(point);
                line.names.push(candidate.point());
            }
            None => lines.push(Line {
                stroke: Stroke::None,
                chosen,
                names: vec![candidate.point()],
                ..Line::new(by, ink, vec![point])
            }),
        }
    }
    Panel {
        title: shown.function.to_owned(),
        x: Axis::log("cycles a call, mean", 10.0, 100_000.0),
        y: Axis::log(shown.axis, shown.errors.0, shown.errors.1),
        lines,
        levels: Vec::new(),
    }
}

/// Returns the candidates that are both faster and more accurate than the controller's function.
fn beaten(candidates: &[Candidate], shown: &Shown) -> String {
    let of_function = || {
        candidates
            .iter()
            .filter(|candidate| candidate.function == shown.function)
    };
    let Some(called) = of_function().find(|candidate| candidate.name == shown.called) else {
        return String::new();
    };
    let better = of_function().filter(|other| {
        let is_other = other.offered_by() != called.offered_by();
        is_other && other.cycles_mean < called.cycles_mean && other.error_max < called.error_max
    });
    let better: Vec<_> = better.map(|other| other.name.replace('`', "")).collect();
    let name = called.name.replace('`', "");
    if better.is_empty() {
        format!("Nothing of others is both faster and closer than {name}.")
    } else {
        format!("Both faster and closer than {name}: {}.", better.join("; "))
    }
}
