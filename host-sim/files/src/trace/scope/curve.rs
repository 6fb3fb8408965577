//! From buckets to the lines that are drawn.
//!
//! A *run* is a stretch of consecutive buckets with data. Where there is no data, the line is interrupted.
//! Within a run the line goes through both extremes of each bucket, the nearer one first. So a ramp stays a
//! ramp, and a spike shows its full height. A signal that is faster than a bucket becomes a filled block, as on
//! a scope.

use super::envelope::Extent;

/// A line's points: time, value, in the panel's units.
pub type Points = Vec<(f64, f64)>;

/// Lines through both extremes of each bucket, thinned to `tolerance` (see [`thin`]).
pub fn lines(buckets: impl Iterator<Item = (f64, f64, Extent)>, tolerance: f64) -> Vec<Points> {
    let mut lines = Vec::new();
    let mut line = Points::new();
    for (first, last, extent) in buckets {
        if extent.is_empty() {
            lines.push(std::mem::take(&mut line));
            continue;
        }
        let Extent { low, high } = extent;
        if low == high {
            line.push((first, low));
            if last > first {
                line.push((last, low));
            }
            continue;
        }
        let before = line.last().map_or(low, |&(_, value)| value);
        let (near, far) = if (before - low).abs() <= (before - high).abs() {
            (low, high)
        } else {
            (high, low)
        };
        line.push((first, near));
        line.push((last, far));
    }
    lines.push(line);
    lines.retain(|line| !line.is_empty());
    lines.iter_mut().for_each(|line| thin(line, tolerance));
    lines
}

/// The lower and upper outline of each run, point for point at the same times, not thinned.
pub fn outlines(buckets: impl Iterator<Item = (f64, f64, Extent)>) -> Vec<(Points, Points)> {
    let mut runs = vec![(Points::new(), Points::new())];
    for (first, last, extent) in buckets {
        if extent.is_empty() {
            runs.push((Points::new(), Points::new()));
        } else if let Some((lower, upper)) = runs.last_mut() {
            let middle = first.midpoint(last);
            lower.push((middle, extent.low));
            upper.push((middle, extent.high));
        }
    }
    runs.retain(|(lower, _)| lower.len() > 1);
    runs
}

/// Leaves out points that lie within `tolerance` of the line through the remaining ones.
///
/// Swinging door (E. H. Bristol, "Swinging door trending", 1990): two doors begin at the last kept point. With
/// each point, they narrow to the slopes that pass all points so far within the tolerance. When they shut, a
/// point is kept. Each point is visited once, and the first and the last always stay.
pub fn thin(points: &mut Points, tolerance: f64) {
    let Some((&first, rest)) = points.split_first() else {
        return;
    };
    const OPEN: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut kept = vec![first];
    let (mut anchor, mut previous, mut doors) = (first, first, OPEN);
    for &point in rest {
        if !passes(anchor, point, doors) {
            // The last point that passed is the end of one straight piece and the start of the next.
            kept.push(previous);
            (anchor, doors) = (previous, OPEN);
        }
        let run = point.0 - anchor.0;
        if run > 0.0 {
            doors.0 = doors.0.max((point.1 - tolerance - anchor.1) / run);
            doors.1 = doors.1.min((point.1 + tolerance - anchor.1) / run);
        } else {
            // A vertical piece has no slope: shut the doors, so that its upper end is kept too.
            doors = (f64::INFINITY, f64::NEG_INFINITY);
        }
        previous = point;
    }
    if !rest.is_empty() {
        kept.push(previous);
    }
    *points = kept;
}

/// Returns true if the straight line from `anchor` to `point` is between the doors.
fn passes(anchor: (f64, f64), point: (f64, f64), doors: (f64, f64)) -> bool {
    let run = point.0 - anchor.0;
    if run <= 0.0 {
        // A vertical piece passes only as the first one from the anchor.
        return doors == (f64::NEG_INFINITY, f64::INFINITY);
    }
    let slope = (point.1 - anchor.1) / run;
    doors.0 <= slope && slope <= doors.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the value of the line through `points` at `t`, where it is not vertical.
    fn at(points: &Points, t: f64) -> f64 {
        let right = points
            .partition_point(|p| p.0 < t)
            .clamp(1, points.len() - 1);
        let ((t0, y0), (t1, y1)) = (points[right - 1], points[right]);
        y0 + (y1 - y0) * (t - t0) / (t1 - t0)
    }

    #[test]
    fn straight_pieces_keep_their_ends_only() {
        let mut points: Points = (0..=100)
            .map(|i| (f64::from(i), f64::from((i - 50).max(0))))
            .collect();
        thin(&mut points, 1e-9);
        assert_eq!(points, [(0.0, 0.0), (50.0, 0.0), (100.0, 50.0)]);
    }

    #[test]
    fn a_vertical_edge_keeps_both_ends() {
        let edge = vec![(0.0, 0.0), (1.0, 0.0), (1.0, 5.0), (2.0, 5.0)];
        let mut points = edge.clone();
        thin(&mut points, 0.1);
        assert_eq!(points, edge);
    }

    #[test]
    fn a_gap_breaks_the_line() {
        let point = |t: f64, y: f64| (t, t, Extent { low: y, high: y });
        let buckets = [
            point(0.0, 1.0),
            (1.0, 1.0, Extent::EMPTY),
            point(2.0, 1.0),
            point(3.0, 2.0),
        ];
        let lines = lines(buckets.into_iter(), 0.0);
        assert_eq!(lines, [vec![(0.0, 1.0)], vec![(2.0, 1.0), (3.0, 2.0)]]);
    }

    #[test]
    fn a_ramp_in_buckets_is_drawn_as_a_ramp() {
        // Falling, so that the nearer extreme is the upper one.
        let buckets = (0..10).map(|i| {
            let t = f64::from(2 * i);
            (
                t,
                t + 1.0,
                Extent {
                    low: -t - 1.0,
                    high: -t,
                },
            )
        });
        assert_eq!(
            lines(buckets, 1e-9),
            [vec![(0.0, -1.0), (1.0, 0.0), (2.0, -2.0), (19.0, -19.0)]]
        );
    }

    proptest! {
        /// Every point that is left out is within the tolerance of the line that is drawn.
        #[test]
        fn thinning_stays_within_its_tolerance(
            values in prop::collection::vec(-10.0_f64..10.0, 2..200),
            tolerance in 0.01_f64..5.0,
        ) {
            let all: Points = values.iter().enumerate().map(|(i, &y)| (i as f64, y)).collect();
            let mut thinned = all.clone();
            thin(&mut thinned, tolerance);
            prop_assert_eq!(thinned[0], all[0]);
            prop_assert_eq!(thinned.last(), all.last());
            for &(t, y) in &all {
                let off = (at(&thinned, t) - y).abs();
                prop_assert!(off <= tolerance + 1e-9, "{off} at {t}");
            }
        }
    }
}
