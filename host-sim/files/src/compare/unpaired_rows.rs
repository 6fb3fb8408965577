//! Rows of one run before the other begins, or after it ends.
//!
//! If a run is at rest there, it does not differ from one that was recorded for a shorter time. So these rows are compared with the
//! nearest row of the same run that lies within the other run's time.

use serde::Serialize;

use super::column::Tolerances;
use super::difference::difference;
use super::run::Run;
use super::trace::Values;

/// Time that only one of the runs covers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnpairedRows {
    /// Path of that run.
    pub of: String,
    /// First row, s.
    pub from_s: f64,
    /// Last row, s.
    pub to_s: f64,
    /// First time at which the run differs from its state at the edge of the common time, and the column that differs.
    pub changes: Option<(f64, String)>,
}

/// Rows of a trace with their times, ns from the origin.
type Rows<'a> = &'a [(usize, i64)];

/// Returns the times that only one of two runs covers.
pub(super) fn find(
    runs: [&Run; 2],
    rows: [Rows<'_>; 2],
    tolerances: &Tolerances,
) -> Vec<UnpairedRows> {
    let mut found = Vec::new();
    for (own, other) in [(0, 1), (1, 0)] {
        let Some((from_ns, to_ns)) = reach(rows[other]) else {
            continue;
        };
        let first_inside = rows[own].partition_point(|(_, t_ns)| *t_ns < from_ns);
        let first_after = rows[own].partition_point(|(_, t_ns)| *t_ns <= to_ns);
        let inside = |place: Option<usize>| place.and_then(|place| rows[own].get(place));
        let surplus = |rows: Rows<'_>, nearest: Option<&(usize, i64)>| {
            let seconds = |t_ns: i64| t_ns as f64 * 1e-9;
            let &(nearest, _) = nearest?;
            let changes = rows.iter().find_map(|&(row, t_ns)| {
                let column = changed([runs[own], runs[other]], nearest, row, tolerances)?;
                Some((seconds(t_ns), column))
            });
            Some(UnpairedRows {
                of: runs[own].path.display().to_string(),
                from_s: seconds(rows.first()?.1),
                to_s: seconds(rows.last()?.1),
                changes,
            })
        };
        found.extend(surplus(
            &rows[own][..first_inside],
            inside(Some(first_inside)),
        ));
        found.extend(surplus(
            &rows[own][first_after..],
            inside(first_after.checked_sub(1)),
        ));
    }
    found
}

/// Times that a run covers: its rows, extended at both ends by the distance between two rows. The extension is needed because
/// traces with other distances between their rows end at other rows of the same run.
fn reach(rows: Rows<'_>) -> Option<(i64, i64)> {
    let (&(_, first_ns), &(_, last_ns)) = (rows.first()?, rows.last()?);
    let distance = |pair: &[(usize, i64)]| pair[1].1 - pair[0].1;
    let before = rows.windows(2).next().map_or(0, distance);
    let after = rows.windows(2).next_back().map_or(0, distance);
    // One nanosecond less: the next row would be due there.
    Some((first_ns - (before - 1).max(0), last_ns + (after - 1).max(0)))
}

/// First column that differs between two rows of the first run. Only columns for which the other run has values count.
fn changed(
    [run, other]: [&Run; 2],
    first: usize,
    second: usize,
    tolerances: &Tolerances,
) -> Option<String> {
    let is_known = |name: &&str| !matches!(other.trace.column(name), Values::Empty);
    let differs = |name: &&str| match run.trace.column(name) {
        Values::Empty => false,
        Values::Numbers(numbers) => {
            difference(numbers[first], numbers[second]).abs() > tolerances.of(name)
        }
        Values::Words(words) => words[first] != words[second],
    };
    run.trace
        .names()
        .filter(is_known)
        .find(differs)
        .map(str::to_owned)
}
