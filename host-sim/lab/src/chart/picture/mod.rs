//! Picture: a title, panels in a grid, a common legend, and a message below.
//!
//! kuva draws the panels and their axes (`drawing.rs`). A picture has the same bytes each time it is drawn of the same data.

mod drawing;

pub use drawing::render;

use cophase_methods::Scheme;

use super::axis::Axis;
use super::ink::{self, Ink, Stroke};

/// Picture with all its parts.
pub struct Picture {
    /// Title above all panels.
    pub title: String,
    /// Message below the panels, one or two sentences.
    pub says: String,
    /// Number of panels in a row.
    pub columns: usize,
    /// Meaning of a thick line, in brackets in the legend, such as "default".
    pub chosen_is: &'static str,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
}

/// Panel.
pub struct Panel {
    /// Title.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Lines, back to front.
    pub lines: Vec<Line>,
    /// Marked values.
    pub levels: Vec<Level>,
}

/// Line through measured points, of which those within the axes are shown.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name in the legend. Lines with the same name and style share an entry; an empty name has none.
    pub label: String,
    /// Colour.
    pub ink: Ink,
    /// Line between its points.
    pub stroke: Stroke,
    /// True if each point has a mark.
    pub marked: bool,
    /// True for the default, which is thicker and named so in the legend.
    pub chosen: bool,
    /// Points, by x.
    pub points: Vec<(f64, f64)>,
    /// Text at each point; empty, or one for each point.
    pub names: Vec<String>,
}

impl Line {
    /// Creates a line with marks at its points.
    pub fn new(label: impl Into<String>, ink: Ink, points: Vec<(f64, f64)>) -> Self {
        Self {
            label: label.into(),
            ink,
            stroke: Stroke::Solid,
            marked: true,
            chosen: false,
            points,
            names: Vec::new(),
        }
    }

    /// Creates the line of a method, whose style is the same in all charts.
    pub fn of_scheme(scheme: Scheme, points: Vec<(f64, f64)>) -> Self {
        let (ink, stroke) = ink::of_scheme(scheme);
        Self {
            stroke,
            ..Self::new(scheme.facts().name, ink, points)
        }
    }
}

/// Value that is marked across the panel.
pub struct Level {
    /// Axis and value.
    pub at: At,
    /// Meaning of the value.
    pub label: String,
}

impl Level {
    /// Marks a value of the horizontal axis.
    pub fn at_x(value: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        Self {
            at: At::X(value),
            label,
        }
    }

    /// Marks a value of the vertical axis.
    pub fn at_y(value: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        Self {
            at: At::Y(value),
            label,
        }
    }
}

/// Value on one of the axes.
#[derive(Clone, Copy, Debug)]
pub enum At {
    /// Value of the vertical axis, marked by a line from left to right.
    Y(f64),
    /// Value of the horizontal axis, marked by a line from top to bottom.
    X(f64),
}
