//! A picture: a title, panels in a grid, one legend for all, and under them what they say.
//!
//! kuva draws the panels and their axes (`drawing.rs`). A picture has the same bytes each time it is drawn of the same data.

mod drawing;

pub use drawing::render;

use cophase_methods::Scheme;

use super::axis::Axis;
use super::ink::{self, Ink, Stroke};

/// All of it.
pub struct Picture {
    /// Above all panels.
    pub title: String,
    /// Under them: the message, in a sentence or two.
    pub says: String,
    /// How many panels stand side by side.
    pub columns: usize,
    /// What a line that is drawn thick is, in the legend's brackets, such as "default".
    pub chosen_is: &'static str,
    /// Row by row.
    pub panels: Vec<Panel>,
}

/// One panel.
pub struct Panel {
    /// What it is of.
    pub title: String,
    /// Below.
    pub x: Axis,
    /// To the left.
    pub y: Axis,
    /// Lines, back to front.
    pub lines: Vec<Line>,
    /// Values that mean something.
    pub levels: Vec<Level>,
}

/// A line through measured points, of which those on the axes are shown.
#[derive(Clone, Debug)]
pub struct Line {
    /// Its name in the legend, where lines of one name and look are one entry; none if it is empty.
    pub label: String,
    /// Its colour.
    pub ink: Ink,
    /// How its points are joined.
    pub stroke: Stroke,
    /// Whether each point is marked.
    pub marked: bool,
    /// Whether it is the one that is taken unless told otherwise: it is drawn thicker, and the legend says so.
    pub chosen: bool,
    /// Points, by x.
    pub points: Vec<(f64, f64)>,
    /// What is written at each point; none, or one a point.
    pub names: Vec<String>,
}

impl Line {
    /// A line with marks at its points.
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

    /// A method's line, which looks the same in all charts.
    pub fn of_scheme(scheme: Scheme, points: Vec<(f64, f64)>) -> Self {
        let (ink, stroke) = ink::of_scheme(scheme);
        Self {
            stroke,
            ..Self::new(scheme.facts().name, ink, points)
        }
    }
}

/// A value that means something, marked through the panel.
pub struct Level {
    /// On which axis, and where.
    pub at: At,
    /// What it means.
    pub label: String,
}

/// A place on one of the axes.
#[derive(Clone, Copy, Debug)]
pub enum At {
    /// A line from left to right.
    Y(f64),
    /// A line from top to bottom.
    X(f64),
}
