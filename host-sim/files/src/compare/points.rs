//! Times at which two traces are compared.

use serde::Serialize;

/// Kind of the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Matching {
    /// Times at which both have a row.
    CommonRows,
    /// There is no such time: rows of the first run, between rows of the second.
    BetweenRowsOfSecond,
    /// Rows of the second run, between rows of the first.
    BetweenRowsOfFirst,
}

/// Place in a trace: a row, or a part of the distance from it to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Row, from 0.
    pub row: usize,
    /// Distance beyond it, 0 up to, not including, 1.
    pub beyond: f64,
}

/// Time at which both traces have a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Time, ns from the origin.
    pub t_ns: i64,
    /// Place in each trace.
    pub places: [Place; 2],
}

/// Rows of a trace with their times, ns from the origin.
type Rows<'a> = &'a [(usize, i64)];

/// Finds the points of two traces; none if their times do not overlap.
pub(super) fn find(rows: [Rows<'_>; 2]) -> Option<(Matching, Vec<Point>)> {
    let common = common(rows);
    if !common.is_empty() {
        return Some((Matching::CommonRows, common));
    }
    let [in_first, in_second] = [between(rows[1], rows[0]), between(rows[0], rows[1])];
    // The coarser trace gives the times, so that as little as possible is interpolated.
    let (matching, found, order) = if in_second.len() <= in_first.len() && !in_second.is_empty() {
        (Matching::BetweenRowsOfSecond, in_second, [0, 1])
    } else {
        (Matching::BetweenRowsOfFirst, in_first, [1, 0])
    };
    let points: Vec<_> = found
        .into_iter()
        .map(|(t_ns, places)| Point {
            t_ns,
            places: order.map(|i| places[i]),
        })
        .collect();
    (!points.is_empty()).then_some((matching, points))
}

fn common([first, second]: [Rows<'_>; 2]) -> Vec<Point> {
    let exactly = |row| Place { row, beyond: 0.0 };
    let mut points = Vec::new();
    let mut others = second.iter().peekable();
    for &(row, t_ns) in first {
        while others.next_if(|(_, other_ns)| *other_ns < t_ns).is_some() {}
        if let Some(&(other, _)) = others.next_if(|(_, other_ns)| *other_ns == t_ns) {
            points.push(Point {
                t_ns,
                places: [exactly(row), exactly(other)],
            });
        }
    }
    points
}

/// Rows of `given`, each with the place of its time in `read`.
fn between(given: Rows<'_>, read: Rows<'_>) -> Vec<(i64, [Place; 2])> {
    let inside = |&(row, t_ns): &(usize, i64)| {
        let after = read.partition_point(|(_, other_ns)| *other_ns <= t_ns);
        let (before_row, before_ns) = *read.get(after.checked_sub(1)?)?;
        let &(_, after_ns) = read.get(after)?;
        let beyond = (t_ns - before_ns) as f64 / (after_ns - before_ns) as f64;
        let places = [
            Place { row, beyond: 0.0 },
            Place {
                row: before_row,
                beyond,
            },
        ];
        Some((t_ns, places))
    };
    given.iter().filter_map(inside).collect()
}
