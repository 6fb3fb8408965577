//! Comparison of two runs: the first difference, and the sizes of all.
//!
//! *Run*: a folder with the files of a run, or its `trace.csv` alone. *Point*: a time at which both runs have values. Points
//! are the times at which both traces have a row. Traces without such a time are compared at the rows of the coarser one: there
//! the finer one is interpolated, except for *held* columns, which keep their last value. *Tolerance*: the
//! largest difference that counts as none. The runs *part* at the first difference beyond it.
//!
//! A comparison does not decide which of the runs is right.

mod column;
mod difference;
mod edges;
mod error;
mod events;
mod points;
mod run;
mod text;
mod trace;
mod unpaired_rows;
mod wire;

pub use column::{EDGES, Tolerances};
pub use difference::ColumnDifference;
pub use edges::{EdgeComparison, WireDifference};
pub use error::CompareError;
pub use events::EventDifference;
pub use points::{Matching, Point};
pub use run::{Origin, Run};
pub use text::summary;
pub use trace::{Trace, Values};
pub use unpaired_rows::UnpairedRows;

use serde::Serialize;

use crate::trace::{Overlay, OverlayRow};

/// Result of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The runs, in the order given.
    pub runs: [RunSummary; 2],
    /// Origin of times.
    pub times_from: Origin,
    /// Kind of the points.
    pub matching: Matching,
    /// Number of points.
    pub points: usize,
    /// First point, s.
    pub from_s: f64,
    /// Last point, s.
    pub to_s: f64,
    /// Differences of each column.
    pub columns: Vec<ColumnDifference>,
    /// Rows of one run before the other begins, or after it ends.
    pub surplus: Vec<UnpairedRows>,
    /// Events that differ. `None` if a run has no `report.json`.
    pub events: Option<EventDifference>,
    /// Edges. `None` if a run has no `steps.vcd`.
    pub edges: Option<EdgeComparison>,
    /// First difference; `None` if the runs are equal within the tolerances.
    pub parts: Option<Part>,
}

/// One of the two runs.
#[derive(Clone, Debug, Serialize)]
pub struct RunSummary {
    /// Path, as given.
    pub path: String,
    /// Number of rows of its trace.
    pub rows: usize,
    /// Time of the first row, s.
    pub from_s: f64,
    /// Time of the last row, s.
    pub to_s: f64,
    /// Time between the first two rows, s.
    pub spacing_s: f64,
    /// Time at which it leaves idle, s since power-up; `None` if it never does.
    pub starts_s: Option<f64>,
}

/// First difference beyond its tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Time, s.
    pub at_s: f64,
    /// Column, wire or event.
    pub what: String,
}

/// Compares two runs.
///
/// # Errors
/// The traces have different columns or no time in common, or a tolerance names no column. Or times are counted from the
/// start, and a run never leaves idle.
pub fn compare(
    runs: [&Run; 2],
    origin: Origin,
    tolerances: &Tolerances,
) -> Result<Comparison, CompareError> {
    column::check(runs, tolerances)?;
    let origins = origin.of(runs)?;
    let times = [0, 1].map(|i| runs[i].trace.times_from(origins[i], origin));
    let (matching, points) =
        points::find([&times[0], &times[1]]).ok_or_else(|| no_overlap(runs))?;
    let columns = difference::columns(runs, &points, tolerances);
    let surplus = unpaired_rows::find(runs, [&times[0], &times[1]], tolerances);
    let events = events::compare(runs, origins);
    let edges = edges::compare(runs, origins, tolerances.edges_ns())?;
    let parts = first_part(&columns, &surplus, events.as_ref(), edges.as_ref());
    let ends = |points: &[Point]| {
        let seconds = |point: Option<&Point>| point.map_or(0.0, |point| point.t_ns as f64 * 1e-9);
        (seconds(points.first()), seconds(points.last()))
    };
    let (from_s, to_s) = ends(&points);
    Ok(Comparison {
        runs: [0, 1].map(|i| runs[i].summary()),
        times_from: origin,
        matching,
        points: points.len(),
        from_s,
        to_s,
        columns,
        surplus,
        events,
        edges,
        parts,
    })
}

/// Returns the earliest of all differences beyond their tolerances.
fn first_part(
    columns: &[ColumnDifference],
    surplus: &[UnpairedRows],
    events: Option<&EventDifference>,
    edges: Option<&EdgeComparison>,
) -> Option<Part> {
    let part = |at_s: f64, what: String| Part { at_s, what };
    let columns = columns
        .iter()
        .filter_map(|column| Some(part(column.exceeds_at_s?, column.name.clone())));
    let surplus = surplus.iter().filter_map(|surplus| {
        let (at_s, column) = surplus.changes.as_ref()?;
        Some(part(
            *at_s,
            format!("{column}, which only {} has", surplus.of),
        ))
    });
    let events = events
        .into_iter()
        .filter_map(|events| Some(part(events.at_s?, "events".to_owned())));
    let edges = edges
        .into_iter()
        .flat_map(|edges| &edges.wires)
        .filter_map(|wire| Some(part(wire.differs_at_s?, format!("edges of {}", wire.name))));
    columns
        .chain(surplus)
        .chain(events)
        .chain(edges)
        .min_by(|a, b| a.at_s.total_cmp(&b.at_s))
}

fn no_overlap(runs: [&Run; 2]) -> CompareError {
    let [a, b] = runs.map(Run::summary);
    CompareError::new(
        &runs[1].path,
        format!(
            "its rows, {} to {} s, have no time in common with those of {}, {} to {} s; give two runs that overlap, \
             or --from start",
            b.from_s, b.to_s, a.path, a.from_s, a.to_s
        ),
    )
}

/// Draws two runs over each other, with their difference below.
///
/// # Errors
/// Those of [`compare`].
pub fn draw(
    runs: [&Run; 2],
    origin: Origin,
    comparison: &Comparison,
) -> Result<String, CompareError> {
    let origins = origin.of(runs)?;
    let times = [0, 1].map(|i| runs[i].trace.times_from(origins[i], origin));
    let (_, points) = points::find([&times[0], &times[1]]).ok_or_else(|| no_overlap(runs))?;
    let names = [&comparison.runs[0].path, &comparison.runs[1].path];
    let title = match &comparison.parts {
        Some(part) => format!("Two runs that part at {:.4} s: {}", part.at_s, part.what),
        None => "Two runs, equal within the tolerances".to_owned(),
    };
    let mut overlay = Overlay::new(title, origin.name(), names, runs[0].trace.axes());
    for point in &points {
        let rows = [0, 1].map(|i| {
            let value = |name: &str| runs[i].trace.value(name, point.places[i]);
            OverlayRow {
                amax_requested_mps2: value("amax_requested_mps2"),
                amax_commanded_mps2: value("amax_commanded_mps2"),
                amax_actual_mps2: value("amax_actual_mps2"),
                command_turns: (0..runs[i].trace.axes())
                    .map(|axis| value(&format!("command_turns_{axis}")))
                    .collect(),
                actual_turns: (0..runs[i].trace.axes())
                    .map(|axis| value(&format!("actual_turns_{axis}")))
                    .collect(),
            }
        });
        overlay.push(point.t_ns as f64 * 1e-9, &rows);
    }
    Ok(overlay.render())
}
