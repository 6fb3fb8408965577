//! What a panel of this chart is made of.

use crate::chart::axis::Axis;
use crate::chart::ink::{Ink, Stroke};
use crate::chart::picture::{Level, Line};

/// A panel, with all that it is drawn from.
pub(super) struct Shown {
    /// Its name in the data.
    pub(super) key: &'static str,
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) curves: Vec<Curve>,
    pub(super) levels: Vec<Level>,
    /// Message, one sentence; it stands under the picture.
    pub(super) says: String,
}

/// A line whose name is both its entry in the panel's legend and its name in the data.
pub(super) struct Curve {
    /// What it is, and its unit.
    pub(super) name: String,
    pub(super) line: Line,
    /// Points, as they are written.
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

    /// One value, which the panel marks by a [`Level`].
    pub(super) fn level(name: &str, value: f64) -> Self {
        Self {
            name: name.to_owned(),
            line: failing(Vec::new()),
            data: vec![(f64::NAN, value)],
        }
    }
}

/// What was requested.
pub(super) fn requested(points: Vec<(f64, f64)>) -> Line {
    Line {
        stroke: Stroke::Dashed,
        marked: false,
        ..Line::new("", Ink::Grey, points)
    }
}

/// Where it goes wrong.
pub(super) fn failing(points: Vec<(f64, f64)>) -> Line {
    Line {
        marked: false,
        ..Line::new("", Ink::Vermilion, points)
    }
}

/// A second line that is as it should be.
pub(super) fn second(points: Vec<(f64, f64)>) -> Line {
    Line {
        stroke: Stroke::Dashed,
        marked: false,
        ..Line::new("", Ink::Green, points)
    }
}

/// As it should be, or is kept by a guard.
pub(super) fn guarded(points: Vec<(f64, f64)>) -> Line {
    Line {
        marked: false,
        ..Line::new("", Ink::Blue, points)
    }
}
