//! Differences of one column over all points.

use serde::Serialize;

use super::column::{Tolerances, is_held};
use super::points::{Place, Point};
use super::run::Run;
use super::trace::{Values, at};

/// Differences of a column: values of the second run less those of the first, in the column's unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnDifference {
    /// Name of the column.
    pub name: String,
    /// Largest difference that counts as none.
    pub tolerance: f64,
    /// Points at which both runs have a value; 0 if one of them has no values.
    pub compared: usize,
    /// Points at which the values differ by more than the tolerance.
    pub beyond: usize,
    /// Difference of the largest magnitude. `None` for words; infinite if only one of the values is a
    /// number.
    #[serde(rename = "largest")]
    pub max: Option<f64>,
    /// Time of that difference, s.
    #[serde(rename = "largest_at_s")]
    pub max_at_s: Option<f64>,
    /// Root mean square of the differences. `None` for words.
    pub rms: Option<f64>,
    /// First time at which the values differ by more than the tolerance, s.
    pub exceeds_at_s: Option<f64>,
    /// Values of both runs at that time, as text.
    pub values: Option<[String; 2]>,
}

/// Compares all columns.
pub(super) fn columns(
    runs: [&Run; 2],
    points: &[Point],
    tolerances: &Tolerances,
) -> Vec<ColumnDifference> {
    let compared = |name: &str| {
        let tolerance = tolerances.of(name);
        let mut difference = ColumnDifference::new(name, tolerance);
        match runs.map(|run| run.trace.column(name)) {
            [Values::Numbers(first), Values::Numbers(second)] => {
                difference.numbers([first, second], points, is_held(name));
            }
            [Values::Words(first), Values::Words(second)] => {
                difference.words([first, second], points);
            }
            _ => {}
        }
        difference
    };
    runs[0].trace.names().map(compared).collect()
}

/// Difference of two numbers. It is 0 if both are equal or both are NaN, and infinite if only one is NaN.
pub(super) fn difference(first: f64, second: f64) -> f64 {
    if first == second || first.is_nan() && second.is_nan() {
        return 0.0;
    }
    let difference = second - first;
    if difference.is_nan() {
        f64::INFINITY
    } else {
        difference
    }
}

impl ColumnDifference {
    fn new(name: &str, tolerance: f64) -> Self {
        Self {
            name: name.to_owned(),
            tolerance,
            compared: 0,
            beyond: 0,
            max: None,
            max_at_s: None,
            rms: None,
            exceeds_at_s: None,
            values: None,
        }
    }

    fn numbers(&mut self, columns: [&[f64]; 2], points: &[Point], is_held: bool) {
        let mut squares = 0.0;
        let mut max = (0.0_f64, None);
        for point in points {
            let value = |i: usize| at(columns[i], point.places[i], is_held);
            let (first, second) = (value(0), value(1));
            let difference = difference(first, second);
            squares += difference * difference;
            if difference.abs() > max.0.abs() {
                max = (difference, Some(seconds(point)));
            }
            if difference.abs() > self.tolerance {
                self.exceed(point, || [first.to_string(), second.to_string()]);
            }
        }
        self.compared = points.len();
        self.max = Some(max.0);
        self.max_at_s = max.1;
        self.rms = Some((squares / points.len() as f64).sqrt());
    }

    fn words(&mut self, columns: [&[String]; 2], points: &[Point]) {
        for point in points {
            let word = |i: usize| {
                let Place { row, .. } = point.places[i];
                &columns[i][row]
            };
            if word(0) != word(1) {
                self.exceed(point, || [word(0).clone(), word(1).clone()]);
            }
        }
        self.compared = points.len();
    }

    fn exceed(&mut self, point: &Point, values: impl FnOnce() -> [String; 2]) {
        self.beyond += 1;
        if self.exceeds_at_s.is_none() {
            self.exceeds_at_s = Some(seconds(point));
            self.values = Some(values());
        }
    }
}

fn seconds(point: &Point) -> f64 {
    point.t_ns as f64 * 1e-9
}
