//! Elementary functions: error against what they cost on the board.
//!
//! Errors and cycles are those that the emulator counted (`docs/emulated-functions.csv`, which
//! `tests/emulator/functions/measure.mjs` writes). Beside them the data has what a call takes on the machine that draws the
//! chart, where the same crate runs there.

mod host;

use std::fmt::Write;

use super::axis::Axis;
use super::ink::{Ink, Stroke};
use super::picture::{Line, Panel, Picture, render};
use super::yardstick::Yardstick;
use super::{ChartError, Drawn, Progress, Size};

const MEASURED: &str = include_str!("../../../../docs/emulated-functions.csv");
/// As the data calls them, what is called in the controller, and what a panel shows of errors.
const PANELS: [(&str, &str, (f64, f64)); 3] = [
    ("root", "cophase `root`", (1e-10, 1.0)),
    ("sine, cosine", "cophase `sine_cosine`", (1e-10, 1e-2)),
    ("arctangent", "micromath `atan2`", (1e-10, 1e-1)),
];

/// Who offers a function: what a candidate's name begins with, how its points are called, their colour.
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

/// A function as it was measured.
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

    /// The name for its point; the crate is in the legend.
    fn point(&self) -> String {
        let (_, called) = self.name.split_once('`').unwrap_or(("", &self.name));
        let kind = self.format.rsplit([',', ' ']).next().unwrap_or_default();
        let is_plain = matches!(kind, "f32" | "f64" | "I16F16" | "U32F32");
        let called = called.replace('`', "");
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
            .any(|(function, ..)| candidate.function == *function)
    };
    let of = candidates.iter().filter(shown).count() as u64;
    for (done, candidate) in candidates.iter().filter(shown).enumerate() {
        let timing = host::sines_a_call(&candidate.name, &candidate.format, yardstick);
        // Writing to a string does not fail.
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
        .map(|(function, called, _)| beaten(&candidates, function, called))
        .collect();
    let says = format!(
        "{} What errs by nothing at all is not shown. Formats differ, and so do errors that come of them.",
        says.join(" ")
    );
    let panels = PANELS
        .iter()
        .map(|(function, called, errors)| panel(&candidates, function, called, *errors));
    let svg = render(Picture {
        title: "Elementary functions: error against cycles on the board".to_owned(),
        says: says.clone(),
        columns: 3,
        chosen_is: "what the controller calls",
        panels: panels.collect(),
    });
    Ok(Drawn { csv, svg, says })
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

fn panel(candidates: &[Candidate], function: &str, called: &str, errors: (f64, f64)) -> Panel {
    let of_function = || {
        candidates
            .iter()
            .filter(|candidate| candidate.function == function)
    };
    let mut lines: Vec<Line> = Vec::new();
    for candidate in of_function() {
        let (by, ink) = candidate.offered_by();
        let chosen = candidate.name == called;
        let point = (candidate.cycles_mean, candidate.error_max);
        match lines
            .iter_mut()
            .find(|line| line.label == by && line.chosen == chosen)
        {
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
        title: format!("{function}: largest error"),
        x: Axis::log("cycles a call, mean", 10.0, 20_000.0),
        y: Axis::log(
            if function == "root" {
                "relative"
            } else {
                "absolute (rad, where angles)"
            },
            errors.0,
            errors.1,
        ),
        lines,
        levels: Vec::new(),
    }
}

/// Who is both cheaper than what the controller calls, and closer.
fn beaten(candidates: &[Candidate], function: &str, called: &str) -> String {
    let of_function = || {
        candidates
            .iter()
            .filter(|candidate| candidate.function == function)
    };
    let Some(ours) = of_function().find(|candidate| candidate.name == called) else {
        return String::new();
    };
    let better = of_function()
        .filter(|other| other.cycles_mean < ours.cycles_mean && other.error_max < ours.error_max);
    let better: Vec<_> = better.map(|other| other.name.replace('`', "")).collect();
    let called = called.replace('`', "");
    if better.is_empty() {
        format!("Nothing is both faster and closer than {called}.")
    } else {
        format!("Faster and closer than {called}: {}.", better.join(", "))
    }
}
