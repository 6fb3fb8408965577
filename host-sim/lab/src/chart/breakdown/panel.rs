//! Panels of this chart.

use crate::chart::axis::Axis;
use crate::chart::ink::{Ink, Stroke};
use crate::chart::picture::{Level, Line};

/// Panel with its data.
pub(super) struct Shown {
    /// Name in the data.
    pub(super) key: &'static str,
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) curves: Vec<Curve>,
    pub(super) levels: Vec<Level>,
    /// Message below the picture, one sentence.
    pub(super) says: String,
}

/// Line. Its name is both its entry in the panel's legend and its name in the data.
pub(super) struct Curve {
    /// Quantity and unit.
    pub(super) name: String,
    pub(super) line: Line,
    /// Points, as in the data.
    pub(super) data: Vec<(f64, f64)>,
}

impl Curve {
    pub(super) fn new(name: impl Into<String>, line: Line) -> Self {
        let name = name.into();
        Self {
            data: line.points.clone(),
            line: Line {
                label: name.clone(),
                ..line
            },
            name,
        }
    }

    /// Creates a single value, which the panel marks by a [`Level`].
    pub(super) fn level(name: &str, value: f64) -> Self {
        Self {
            name: name.to_owned(),
            line: failing(Vec::new()),
            data: vec![(f64::NAN, value)],
        }
    }
}

/// Line of the requested values.
pub(super) fn requested(points: Vec<(f64, f64)>) -> Line {
    Line {
        stroke: Stroke::Dashed,
        marked: false,
        ..Line::new("", Ink::Grey, points)
    }
}

/// Line of the failure.
pub(super) fn failing(points: Vec<(f64, f64)>) -> Line {
    Line {
        marked: false,
        ..Line::new("", Ink::Vermilion, points)
    }
}

/// Second line of correct behaviour.
pub(super) fn second(points: Vec<(f64, f64)>) -> Line {
    Line {
        stroke: Stroke::Dashed,
        marked: false,
        ..Line::new("", Ink::Green, points)
    }
}

/// Line of correct behaviour, or of that with a guard.
pub(super) fn guarded(points: Vec<(f64, f64)>) -> Line {
    Line {
        marked: false,
        ..Line::new("", Ink::Blue, points)
    }
}
