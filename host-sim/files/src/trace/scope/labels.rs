//! Labels above the ribbon: marks, and states that are too short for their names.
//!
//! *Lanes* are the lines of text, counted from the ribbon upwards. Each label has a line down to its state or mark. The line of a
//! mark crosses all panels.

use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::data::ScopeData;
use super::scale::TimeAxis;
use super::style::{MUTED, VERMILION, WIDTH, at, fits, text_on_white, width};

/// Height of a lane, px.
pub const LANE: f64 = 15.0;
/// Number of lanes. A label that does not fit into them has only its line.
const LANES: usize = 4;
/// Number of lanes for labels of faults, which may go above the others.
const FAULT_LANES: usize = 8;

/// A label above the ribbon, with a line down from it.
struct Label {
    x: f64,
    /// Lane, counted from the bottom; `None` if there is no room for its text.
    lane: Option<usize>,
    text: String,
    is_fault: bool,
    /// A state's line ends in the ribbon, a mark's crosses the panels.
    is_mark: bool,
}

/// All labels, in their lanes.
pub struct Labels {
    all: Vec<Label>,
    /// Number of lanes.
    pub lanes: usize,
}

impl Labels {
    /// Finds the labels of a run, and a lane for each.
    pub fn place(scope: &ScopeData, time: TimeAxis) -> Self {
        let states = scope.timeline.stretches().iter();
        let states = states
            .filter(|s| !fits(s.state, at(time, s.to_s) - at(time, s.from_s)))
            .map(|s| (s.from_s, s.state, s.state.starts_with("fault"), false));
        let marks = scope.timeline.marks();
        let marks = marks
            .iter()
            .map(|m| (m.t_s, m.label.as_str(), m.is_fault, true));
        let mut all: Vec<Label> = states
            .chain(marks)
            .map(|(t_s, text, is_fault, is_mark)| Label {
                x: at(time, t_s),
                lane: None,
                text: text.to_owned(),
                is_fault,
                is_mark,
            })
            .collect();
        // From right to left, each label goes above all labels that it would overlap. So no line down crosses another's
        // text.
        all.sort_by(|a, b| b.x.total_cmp(&a.x));
        let mut lanes = 0;
        for i in 0..all.len() {
            let (placed, rest) = all.split_at_mut(i);
            let label = &mut rest[0];
            let (from, to) = label.extent();
            let below = placed.iter().filter(|other| {
                let (a, b) = other.extent();
                from <= b && a <= to
            });
            let lane = below
                .filter_map(|other| other.lane)
                .max()
                .map_or(0, |lane| lane + 1);
            if lane < LANES || label.is_fault && lane < FAULT_LANES {
                label.lane = Some(lane);
                lanes = lanes.max(lane + 1);
            }
        }
        Self { all, lanes }
    }

    /// Draws the labels upwards from `ribbon_top`, and the lines of marks down to `bottom`.
    pub fn draw(&self, scene: &mut Scene, ribbon_top: f64, bottom: f64) {
        for label in &self.all {
            let top = ribbon_top
                - label
                    .lane
                    .map_or(0.0, |lane| lane as f64 * LANE + LANE - 2.0);
            scene.add(Primitive::Line {
                x1: label.x,
                y1: top,
                x2: label.x,
                y2: if label.is_mark { bottom } else { ribbon_top },
                stroke: label.colour().into(),
                stroke_width: if label.is_fault { 1.2 } else { 0.8 },
                stroke_dasharray: label.is_mark.then(|| "3 3".to_owned()),
            });
        }
        for (label, lane) in self
            .all
            .iter()
            .filter_map(|label| Some((label, label.lane?)))
        {
            let y = ribbon_top - lane as f64 * LANE - 4.0;
            let (x, anchor) = if label.is_to_the_left() {
                (label.x - 4.0, TextAnchor::End)
            } else {
                (label.x + 4.0, TextAnchor::Start)
            };
            text_on_white(scene, (x, y), &label.text, 12, label.colour(), anchor);
        }
    }
}

impl Label {
    const fn colour(&self) -> &'static str {
        if self.is_fault { VERMILION } else { MUTED }
    }

    /// Returns true for a label whose text would run off the page at the right end.
    fn is_to_the_left(&self) -> bool {
        self.x + width(&self.text, 12) + 4.0 > WIDTH - 8.0
    }

    fn extent(&self) -> (f64, f64) {
        let width = width(&self.text, 12) + 8.0;
        if self.is_to_the_left() {
            (self.x - width, self.x)
        } else {
            (self.x, self.x + width)
        }
    }
}
