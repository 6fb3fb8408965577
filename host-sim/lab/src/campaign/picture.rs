//! Picture of a campaign, by kind of fault: the time from the limit to the detection, and the tilt of the platforms.

use cophase_scene::file::FaultName;

use super::shards::Header;
use super::tally::{Group, Tally};
use crate::chart::axis::Axis;
use crate::chart::ink::{Ink, Stroke};
use crate::chart::picture::{self, At, Level, Line, Panel, Picture};

/// Largest number of points of a line. More would not be visible.
const MAX_POINTS: usize = 200;

/// Renders the picture as SVG.
pub fn svg(header: &Header, tally: &Tally) -> String {
    let cases = header.numbers.end - header.numbers.start;
    let all = &tally.all;
    picture::render(Picture {
        title: format!("{cases} faults, and {cases} runs with noise alone"),
        says: format!(
            "Of {} faults that moved a crank beyond its limit {} were detected within one turn and three ticks. {} of {} were named \
             rightly. The largest tilt was {:.2} of its bound. Noise alone tripped {} of {} runs.",
            all.in_time.of,
            all.in_time.hits,
            all.named.hits,
            all.named.of,
            Group::quantile(&all.tilt_over_bound, 1.0).unwrap_or_default(),
            tally.false_trips.hits,
            tally.false_trips.of,
        ),
        columns: 2,
        chosen_is: "",
        panels: [false, true]
            .into_iter()
            .map(|encoder| delays(tally, encoder))
            .chain(
                [false, true]
                    .into_iter()
                    .map(|encoder| tilts(tally, encoder)),
            )
            .collect(),
    })
}

const fn measured_by(encoder: bool) -> &'static str {
    if encoder {
        "encoder and index"
    } else {
        "index alone"
    }
}

fn delays(tally: &Tally, encoder: bool) -> Panel {
    Panel {
        title: format!("Detected after the limit: {}", measured_by(encoder)),
        x: Axis::linear(
            "turns from the limit to three ticks before it is detected",
            -0.2,
            1.2,
        ),
        y: Axis::linear("part of the faults that passed a limit", 0.0, 1.0),
        lines: lines(tally, encoder, |group| &group.turns),
        levels: vec![Level {
            at: At::X(1.0),
            label: "one turn".to_owned(),
        }],
    }
}

fn tilts(tally: &Tally, encoder: bool) -> Panel {
    Panel {
        title: format!("Largest tilt: {}", measured_by(encoder)),
        x: Axis::linear("tilt over its bound", 0.0, 1.2),
        y: Axis::linear("part of the faults", 0.0, 1.0),
        lines: lines(tally, encoder, |group| &group.tilt_over_bound),
        levels: vec![Level {
            at: At::X(1.0),
            label: "bound".to_owned(),
        }],
    }
}

/// Returns a line for each kind that moves a crank.
fn lines(tally: &Tally, encoder: bool, values: fn(&Group) -> &Vec<f64>) -> Vec<Line> {
    tally
        .groups
        .iter()
        .filter(|((_, with), group)| *with == encoder && group.beyond_limit > 0)
        .filter_map(|((kind, _), group)| {
            let (ink, stroke) = style(*kind)?;
            Some(Line {
                marked: false,
                stroke,
                ..Line::new(kind.name(), ink, distribution(values(group)))
            })
        })
        .collect()
}

/// Returns the ink and the stroke of a kind, the same in all panels. None for kinds that move no crank.
const fn style(kind: FaultName) -> Option<(Ink, Stroke)> {
    Some(match kind {
        FaultName::LostSteps => (Ink::Blue, Stroke::Solid),
        FaultName::Slip => (Ink::Orange, Stroke::Solid),
        FaultName::Stuck => (Ink::Vermilion, Stroke::Solid),
        FaultName::Runaway => (Ink::Purple, Stroke::Solid),
        FaultName::Reversed => (Ink::Green, Stroke::Dashed),
        FaultName::SwappedWiring => (Ink::Sky, Stroke::Dashed),
        FaultName::StepFifoUnderrun => (Ink::Black, Stroke::Dotted),
        FaultName::LoadStep => (Ink::Grey, Stroke::Solid),
        FaultName::EnableLoss => (Ink::Black, Stroke::Dashed),
        _ => return None,
    })
}

/// Cumulative distribution: for each value, the fraction of values that do not exceed it.
fn distribution(sorted: &[f64]) -> Vec<(f64, f64)> {
    let step = sorted.len().div_ceil(MAX_POINTS).max(1);
    let part = |i: usize| (i + 1) as f64 / sorted.len() as f64;
    let mut points: Vec<_> = sorted
        .iter()
        .enumerate()
        .filter(|(i, _)| i % step == 0 || i + 1 == sorted.len())
        .map(|(i, &value)| (value, part(i)))
        .collect();
    if let Some(&(min, _)) = points.first() {
        points.insert(0, (min, 0.0));
    }
    points
}
