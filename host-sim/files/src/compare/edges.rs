//! Comparison of the edges of two runs for each wire, over the time that both files show.
//!
//! Rising edges are paired with rising ones and falling edges with falling ones. Each is paired with the nearest edge that
//! follows the previous pair. An edge stays single if its partner has a nearer neighbour.

use serde::Serialize;

use super::error::CompareError;
use super::run::Run;
use super::wire::{Wire, Wires};

/// Comparison of two `steps.vcd`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EdgeComparison {
    /// Start of the time that both show, s.
    pub from_s: f64,
    /// End of that time, s. If there is no such time, the end is not after the start.
    pub to_s: f64,
    /// Tolerance of shifts, ns.
    pub tolerance_ns: f64,
    /// Wires of both files, by name.
    pub wires: Vec<WireDifference>,
    /// Wires that one of the files lacks.
    pub unknown: Vec<String>,
}

/// Edges of a wire.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WireDifference {
    /// Name of the wire.
    pub name: String,
    /// Edges that both have within the tolerance.
    pub equal: usize,
    /// Edges that both have, further apart.
    pub shifted: usize,
    /// Edges of the first run alone.
    pub only_first: usize,
    /// Edges of the second run alone.
    pub only_second: usize,
    /// Largest shift of an edge that both have, second less first, ns.
    #[serde(rename = "largest_shift_ns")]
    pub max_shift_ns: i64,
    /// Time of the first edge that differs, s. If the levels at the start of the window differ, it is that start.
    pub differs_at_s: Option<f64>,
}

impl EdgeComparison {
    /// Sum over all wires.
    pub fn total(&self, count: impl Fn(&WireDifference) -> usize) -> usize {
        self.wires.iter().map(count).sum()
    }

    /// Largest shift of any wire, ns.
    pub fn max_shift_ns(&self) -> i64 {
        let shifts = self.wires.iter().map(|wire| wire.max_shift_ns);
        shifts.max_by_key(|shift| shift.abs()).unwrap_or(0)
    }
}

/// Compares the edges of two runs. `None` if a run has no `steps.vcd`.
pub(super) fn compare(
    runs: [&Run; 2],
    origins: [i64; 2],
    tolerance_ns: f64,
) -> Result<Option<EdgeComparison>, CompareError> {
    let [Some(first), Some(second)] = runs.map(|run| run.steps.as_ref()) else {
        return Ok(None);
    };
    let files = [Wires::read(first)?, Wires::read(second)?];
    let from_ns = (files[0].from_ns - origins[0]).max(files[1].from_ns - origins[1]);
    let to_ns = (files[0].to_ns - origins[0]).min(files[1].to_ns - origins[1]);
    let mut compared = EdgeComparison {
        from_s: from_ns as f64 * 1e-9,
        to_s: to_ns as f64 * 1e-9,
        tolerance_ns,
        wires: Vec::new(),
        unknown: Vec::new(),
    };
    for (name, first) in &files[0].wires {
        let Some(second) = files[1].wires.get(name) else {
            compared.unknown.push(name.clone());
            continue;
        };
        if first.initial.is_none() || second.initial.is_none() {
            compared.unknown.push(name.clone());
        } else if from_ns < to_ns {
            let window = Window {
                from_ns,
                to_ns,
                tolerance_ns,
            };
            compared
                .wires
                .push(window.compare(name, [first, second], origins));
        }
    }
    Ok(Some(compared))
}

/// Time that both files show, ns from the origin.
struct Window {
    from_ns: i64,
    to_ns: i64,
    tolerance_ns: f64,
}

impl Window {
    fn compare(&self, name: &str, wires: [&Wire; 2], origins: [i64; 2]) -> WireDifference {
        let mut difference = WireDifference {
            name: name.to_owned(),
            ..WireDifference::default()
        };
        let levels = [0, 1].map(|i| wires[i].level_before(self.from_ns + origins[i]));
        // An edge exactly at the start is in the window, so the comparison of edges covers it.
        if levels[0] != levels[1] {
            difference.differs_at_s = Some(self.from_ns as f64 * 1e-9);
        }
        for direction in [0, 1] {
            let edges = [0, 1].map(|i| {
                let all = wires[i].edges[direction]
                    .iter()
                    .map(|t_ns| t_ns - origins[i]);
                all.filter(|t_ns| (self.from_ns..=self.to_ns).contains(t_ns))
                    .collect::<Vec<i64>>()
            });
            pair(&edges[0], &edges[1], |first, second| {
                self.take(&mut difference, first, second);
            });
        }
        difference
    }

    /// Adds a pair of edges, or a single edge.
    fn take(&self, difference: &mut WireDifference, first: Option<i64>, second: Option<i64>) {
        let at_ns = match (first, second) {
            (Some(first), Some(second)) => {
                let shift = second - first;
                if shift.abs() > difference.max_shift_ns.abs() {
                    difference.max_shift_ns = shift;
                }
                if shift.abs() as f64 <= self.tolerance_ns {
                    difference.equal += 1;
                    return;
                }
                difference.shifted += 1;
                first.min(second)
            }
            (Some(only), None) | (None, Some(only)) => {
                // Its partner may be shifted out of the window.
                let to_edge = (only - self.from_ns).min(self.to_ns - only);
                if (to_edge as f64) < self.tolerance_ns {
                    return;
                }
                difference.only_first += usize::from(first.is_some());
                difference.only_second += usize::from(second.is_some());
                only
            }
            (None, None) => return,
        };
        let at_s = at_ns as f64 * 1e-9;
        difference.differs_at_s = Some(difference.differs_at_s.map_or(at_s, |s| s.min(at_s)));
    }
}

/// Pairs the times of two ascending lists. Calls `take` for each pair, and for each time that stays single.
pub(super) fn pair(first: &[i64], second: &[i64], mut take: impl FnMut(Option<i64>, Option<i64>)) {
    let (mut i, mut k) = (0, 0);
    while let (Some(&a), Some(&b)) = (first.get(i), second.get(k)) {
        let distance = (b - a).abs();
        let is_nearer = |other: Option<i64>| other.is_some_and(|other| other < distance);
        if is_nearer(first.get(i + 1).map(|next| (b - next).abs())) {
            take(Some(a), None);
            i += 1;
        } else if is_nearer(second.get(k + 1).map(|next| (next - a).abs())) {
            take(None, Some(b));
            k += 1;
        } else {
            take(Some(a), Some(b));
            (i, k) = (i + 1, k + 1);
        }
    }
    first[i..].iter().for_each(|&only| take(Some(only), None));
    second[k..].iter().for_each(|&only| take(None, Some(only)));
}
