//! Columns: their units, their default tolerances, and whether they are held.
//!
//! The name of a column ends with its unit. The columns of an axis also end with the number of the axis. The default tolerance is
//! ten units of the last place that `trace.csv` has for the unit. Integers and words must be equal.

use cophase_scene::load;

use super::error::CompareError;
use super::run::Run;
use super::trace::Trace;
use crate::trace::decimals;

/// Name under which the tolerance of edges is given, ns.
pub const EDGES: &str = "edges_ns";

/// Endings of names, and the decimals that a column of the unit has.
const UNITS: [(&str, u32); 6] = [
    ("_mps2", decimals::ACCELERATION),
    ("_rad_s", decimals::SPEED),
    ("_turns", decimals::TURNS),
    ("_deg", decimals::DEGREES),
    ("_mrad", decimals::TILT),
    ("_m", decimals::HEIGHT),
];

/// Tolerances that differ from the default ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tolerances(Vec<(String, f64)>);

impl Tolerances {
    /// Tolerances of columns, in the unit of each. The name of a column of axes without the number of an axis applies to all axes.
    /// [`EDGES`] is for edges. A later tolerance replaces an earlier one.
    pub fn new(given: impl IntoIterator<Item = (String, f64)>) -> Self {
        Self(given.into_iter().collect())
    }

    /// Tolerance of a column.
    pub fn of(&self, column: &str) -> f64 {
        let given = self.0.iter().rev().find(|(name, _)| names(name, column));
        given.map_or_else(|| default_tolerance(column), |(_, tolerance)| *tolerance)
    }

    /// Tolerance of edges, ns.
    pub fn edges_ns(&self) -> f64 {
        self.of(EDGES)
    }
}

/// Name of a column without the number of its axis.
fn without_axis(column: &str) -> &str {
    match column.rsplit_once('_') {
        Some((name, axis)) if axis.parse::<u8>().is_ok() => name,
        _ => column,
    }
}

fn names(given: &str, column: &str) -> bool {
    given == column || given == without_axis(column)
}

fn default_tolerance(column: &str) -> f64 {
    let name = without_axis(column);
    let unit = UNITS.iter().find(|(ending, _)| name.ends_with(ending));
    unit.map_or(0.0, |(_, decimals)| 10.0 * 0.1_f64.powi(*decimals as i32))
}

/// True if a column keeps its value until the next row, so that nothing is interpolated between two rows.
pub(super) fn is_held(column: &str) -> bool {
    let name = without_axis(column);
    ["phase_error_deg", "amax_actual_mps2"].contains(&name) || default_tolerance(column) == 0.0
}

/// Checks that two traces have the same columns, and that every tolerance names one of these.
pub(super) fn check(runs: [&Run; 2], tolerances: &Tolerances) -> Result<(), CompareError> {
    let [first, second] = runs.map(|run| &run.trace);
    let axes = runs.map(|run| run.trace.axes());
    if axes[0] != axes[1] {
        return Err(CompareError::new(
            &runs[1].path,
            format!(
                "it has {} axes, and {} has {}; compare runs of machines with equally many",
                axes[1],
                runs[0].path.display(),
                axes[0]
            ),
        ));
    }
    for (run, trace, other, with) in [
        (runs[1], second, first, runs[0]),
        (runs[0], first, second, runs[1]),
    ] {
        if let Some(missing) = missing(trace, other) {
            return Err(CompareError::new(
                &run.path,
                format!(
                    "column {missing} of {} is missing; write both with the same version of `cophase`",
                    with.path.display()
                ),
            ));
        }
    }
    let mut known: Vec<&str> = first.names().collect();
    known.extend(first.names().map(without_axis));
    known.push(EDGES);
    for (name, tolerance) in &tolerances.0 {
        if !known.contains(&name.as_str()) {
            let meant = load::nearest(name, &known).map(|near| format!("; did you mean `{near}`?"));
            return Err(CompareError::for_argument(
                format!("--tolerance {name}"),
                format!(
                    "the traces have no such column{}",
                    meant
                        .as_deref()
                        .unwrap_or("; the header of trace.csv has their names")
                ),
            ));
        }
        if tolerance.is_nan() || *tolerance < 0.0 {
            return Err(CompareError::for_argument(
                format!("--tolerance {name}"),
                format!("{tolerance} is below zero; give 0 or more"),
            ));
        }
    }
    Ok(())
}

/// First column of `other` that `trace` does not have.
fn missing<'a>(trace: &Trace, other: &'a Trace) -> Option<&'a str> {
    other
        .names()
        .find(|name| !trace.names().any(|known| known == *name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_given_tolerance_overrides_that_of_the_unit() {
        let given = Tolerances::new([("command_turns".to_owned(), 0.5), ("z_m".to_owned(), 1.0)]);
        for (column, expected) in [
            ("accel_mps2", 1e-3),
            ("omega_rad_s", 1e-5),
            ("phase_turns", 1e-8),
            ("command_turns_3", 0.5),
            ("actual_turns_3", 1e-8),
            ("phase_error_deg_0", 1e-4),
            ("tilt_x_mrad", 1e-4),
            ("z_m", 1.0),
            ("steps_5", 0.0),
            ("state_code", 0.0),
            (EDGES, 0.0),
        ] {
            let tolerance = given.of(column);
            assert!(
                (tolerance - expected).abs() <= 1e-12 * expected,
                "{column}: {tolerance}"
            );
        }
    }

    #[test]
    fn integers_and_measured_angles_are_held() {
        for column in [
            "steps_0",
            "state_code",
            "phase_error_deg_2",
            "amax_actual_mps2",
            "state",
        ] {
            assert!(is_held(column), "{column}");
        }
        for column in ["command_turns_0", "tilt_x_mrad", "z_m", "warp_deg"] {
            assert!(!is_held(column), "{column}");
        }
    }
}
