//! `compare.svg`: two runs over each other, and their difference below.
//!
//! The first run is drawn wide and pale, the second one thin and dark on top of it. So equal curves appear as a dark line
//! within a pale one.

use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use kuva::plot::legend::LegendShape;
use kuva::render::render::Scene;

use super::draft::{Draft, Panel, Pen};
use super::envelope::{Envelope, Extent, PAGE_BUCKETS};
use super::page::{FONT, GAP, TIME_AXIS, embed};
use super::panel::{AXES, peak};
use super::scale::{TimeAxis, padded};
use super::style::{BLUE, DARK_BLUE, GREEN, INK, LEFT, MUTED, PALE_BLUE, WIDTH, svg, text};

/// Values of a run at one time; NaN for a value that is not known.
#[derive(Clone, Debug, Default)]
pub struct OverlayRow {
    /// Requested amax, m/s².
    pub amax_requested_mps2: f64,
    /// Commanded amax, m/s².
    pub amax_commanded_mps2: f64,
    /// Actual amax, m/s².
    pub amax_actual_mps2: f64,
    /// Commanded phase of each axis, turns.
    pub command_turns: Vec<f64>,
    /// True phase of each axis, turns.
    pub actual_turns: Vec<f64>,
}

/// Signals of amplitude, in the order of their channels: requested, commanded, actual.
const SIGNALS: [&str; 3] = ["requested", "commanded", "actual"];
/// Colours of the first and of the second run, for each signal.
const PENS: [(&str, &str); 3] = [
    (PALE_BLUE, BLUE),
    ("#B9BFC7", DARK_BLUE),
    ("#A8DCCB", GREEN),
];
/// Colours of the differences.
const DIFFERENCES: [&str; 3] = [BLUE, DARK_BLUE, GREEN];
/// Channels: three signals of each run, their differences, then the differences of the axes' commanded and actual phases.
const SECOND: usize = SIGNALS.len();
const DIFFERENCE: usize = 2 * SIGNALS.len();
const PHASES: usize = 3 * SIGNALS.len();

const TOP: f64 = 72.0;

/// Collects two runs and draws them.
#[derive(Clone, Debug)]
pub struct Overlay {
    title: String,
    origin: &'static str,
    names: [String; 2],
    axes: usize,
    envelope: Envelope,
    values: Vec<f64>,
}

impl Overlay {
    /// Empty page for two runs of a machine with `axes` axes, whose times are counted since `origin`.
    pub fn new(title: String, origin: &'static str, names: [&String; 2], axes: usize) -> Self {
        let channels = PHASES + 2 * axes;
        Self {
            title,
            origin,
            names: names.map(String::clone),
            axes,
            envelope: Envelope::new(channels, PAGE_BUCKETS),
            values: vec![f64::NAN; channels],
        }
    }

    /// Adds the values of both runs at a time, s. Times must increase.
    pub fn push(&mut self, t_s: f64, rows: &[OverlayRow; 2]) {
        let axes = self.axes;
        for (i, row) in rows.iter().enumerate() {
            let signals = [
                row.amax_requested_mps2,
                row.amax_commanded_mps2,
                row.amax_actual_mps2,
            ];
            for (signal, mps2) in signals.into_iter().enumerate() {
                self.values[i * SECOND + signal] = mps2 / STANDARD_GRAVITY_MPS2;
            }
        }
        for signal in 0..SIGNALS.len() {
            self.values[DIFFERENCE + signal] = self.values[SECOND + signal] - self.values[signal];
        }
        let [first, second] = rows;
        let differences = |a: &[f64], b: &[f64], into: &mut [f64]| {
            for ((into, a), b) in into.iter_mut().zip(a).zip(b) {
                *into = (b - a) * 360.0;
            }
        };
        let (commanded, actual) = self.values[PHASES..].split_at_mut(axes);
        differences(&first.command_turns, &second.command_turns, commanded);
        differences(&first.actual_turns, &second.actual_turns, actual);
        self.envelope.push(t_s, &self.values);
    }

    /// Returns the page as SVG text.
    pub fn render(&self) -> String {
        let time = TimeAxis::new(self.envelope.span());
        let mut panels = vec![
            (self.amplitudes_of_both(time), 240.0),
            (self.differences_of_amplitude(time), 150.0),
            (self.phases(time, PHASES, "commanded B-A, deg"), 150.0),
        ];
        let has_actual =
            (0..self.axes).any(|axis| !self.envelope.total(PHASES + self.axes + axis).is_empty());
        if has_actual {
            let actual = self.phases(time, PHASES + self.axes, "actual B-A, deg");
            panels.push((actual, 150.0));
        }
        let plots: f64 = panels.iter().map(|(_, height)| height + GAP).sum();
        let mut scene = Scene::new(WIDTH, TOP + plots - GAP + TIME_AXIS);
        scene.font_family = Some(FONT.to_owned());
        text(&mut scene, (LEFT, 34.0), &self.title, 22, INK);
        let [first, second] = &self.names;
        let names = format!("A (pale): {first}   B (dark): {second}");
        text(&mut scene, (LEFT, 56.0), &names, 13, MUTED);
        let count = panels.len();
        let mut top = TOP;
        for (i, (panel, height)) in panels.into_iter().enumerate() {
            let is_last = i + 1 == count;
            let label = is_last.then(|| format!("time since {}, {}", self.origin, time.unit));
            embed(&mut scene, panel, i, top, height, label);
            top += height + GAP;
        }
        svg(&scene)
    }

    fn amplitudes_of_both(&self, time: TimeAxis) -> Panel {
        let all = (0..DIFFERENCE).map(|channel| self.envelope.total(channel));
        let shown = all.fold(
            Extent {
                low: 0.0,
                high: 0.0,
            },
            Extent::and,
        );
        let mut draft = Draft::new(&self.envelope, time, "amax, g", padded(shown, 1e-3));
        for (signal, (pale, dark)) in PENS.into_iter().enumerate() {
            for (run, channel, colour, width) in
                [("A", signal, pale, 5.0), ("B", SECOND + signal, dark, 1.2)]
            {
                let total = self.envelope.total(channel);
                if total.is_empty() {
                    continue;
                }
                draft.curve(channel, 1.0, Pen { colour, width });
                let name = format!("{run} {}", SIGNALS[signal]);
                draft.entry(LegendShape::Line, colour, peak(&name, total));
            }
        }
        draft.done()
    }

    fn differences_of_amplitude(&self, time: TimeAxis) -> Panel {
        let channels = || DIFFERENCE..PHASES;
        let colours = DIFFERENCES.into_iter().zip(SIGNALS);
        self.panel(
            time,
            "amax B-A, g",
            channels(),
            colours.map(|(colour, name)| (colour, name.to_owned())),
        )
    }

    fn phases(&self, time: TimeAxis, from: usize, label: &'static str) -> Panel {
        let colours = AXES.into_iter().cycle().enumerate();
        let colours = colours.map(|(axis, colour)| (colour, format!("axis {axis}")));
        self.panel(time, label, from..from + self.axes, colours)
    }

    fn panel(
        &self,
        time: TimeAxis,
        label: &'static str,
        channels: std::ops::Range<usize>,
        pens: impl Iterator<Item = (&'static str, String)>,
    ) -> Panel {
        let all = channels.clone().map(|channel| self.envelope.total(channel));
        let shown = all.fold(Extent::EMPTY, Extent::and);
        let mut draft = Draft::new(&self.envelope, time, label, padded(shown, 1e-9));
        for (channel, (colour, name)) in channels.zip(pens) {
            let total = self.envelope.total(channel);
            if !total.is_empty() {
                draft.curve(channel, 1.0, Pen { colour, width: 1.4 });
                draft.entry(LegendShape::Line, colour, peak(&name, total));
            }
        }
        draft.done()
    }
}
