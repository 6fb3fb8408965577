//! Content of the panels: curves, colours and legends.
//!
//! Colours are those of Okabe and Ito, which the colour-blind distinguish. Vermilion is reserved for limits and faults. Where curves
//! are meant to coincide, the requested one is thick and pale, the actual one green, and the commanded one thin and dark, so that all
//! are visible.

use std::f64::consts::TAU;

use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use host_sim::machines::Shown;
use kuva::plot::legend::LegendShape;
use kuva::render::annotations::{ReferenceLine, ShadedRegion};

use super::data::{ScopeData, channel};
use super::draft::{Draft, Panel, Pen};
use super::envelope::Extent;
use super::scale::{TimeAxis, is_in_sight, padded, plain, short};
use super::style::{BLUE, DARK_BLUE, GREEN, ORANGE, PALE_BLUE};

/// Colour of forbidden bands.
pub const BAND: &str = "#E69F00";
/// Colours of the axes, in turn.
pub const AXES: [&str; 6] = [BLUE, ORANGE, GREEN, "#CC79A7", "#56B4E9", "#444444"];
/// Least range of an axis for a magnitude. A platform that hardly moves fills little of it. Other machines may be slow by design.
fn from_rest(scope: &ScopeData) -> Extent {
    Extent {
        low: 0.0,
        high: 2.0 * min(scope),
    }
}

/// Half of the least range of such an axis.
fn min(scope: &ScopeData) -> f64 {
    match scope.frame.shown {
        Shown::Displacement(_) => 1e-9,
        Shown::Tilt | Shown::Acceleration(_) => 0.5,
    }
}

/// Remark about a phase error that remains after its correction.
const STAYS: &str = "A correction moves command and crank alike: it brings the crank back beside the others, and the phase error stays.";

/// Acceleration amplitude in g: requested, commanded and, of a platform, actual.
pub fn acceleration(scope: &ScopeData, time: TimeAxis) -> Panel {
    let per_mps2 = in_g(scope);
    let requested = scope.envelope.total(channel::PROGRAM).times(per_mps2);
    let commanded = scope.envelope.total(channel::COMMAND).times(per_mps2);
    // Accelerations with a panel of their own are in no other.
    let actual = if matches!(scope.frame.shown, Shown::Acceleration(_)) {
        Extent::EMPTY
    } else {
        scope.envelope.total(channel::ACTUAL).times(per_mps2)
    };
    let shown = requested.and(commanded).and(actual).and(from_rest(scope));
    let mut draft = Draft::new(&scope.envelope, time, "amax, g", padded(shown, min(scope)));
    let pen = |colour, width| Pen { colour, width };
    draft.curve(channel::PROGRAM, per_mps2, pen(PALE_BLUE, 5.0));
    if !actual.is_empty() {
        draft.curve(channel::ACTUAL, per_mps2, pen(GREEN, 2.6));
    }
    draft.curve(channel::COMMAND, per_mps2, pen(DARK_BLUE, 1.2));
    draft.entry(LegendShape::Rect, PALE_BLUE, peak("requested", requested));
    draft.entry(LegendShape::Line, DARK_BLUE, peak("commanded", commanded));
    if !actual.is_empty() {
        draft.entry(LegendShape::Line, GREEN, peak("actual", actual));
    }
    draft.done()
}

/// Returns one over the size of a g.
fn in_g(scope: &ScopeData) -> f64 {
    let gravity = scope.frame.gravity_mps2;
    if gravity.is_finite() && gravity > 0.0 {
        1.0 / gravity
    } else {
        1.0 / STANDARD_GRAVITY_MPS2
    }
}

/// Motion of the part that the machine moves: its tilt, its acceleration in g, or its displacement in mm.
pub fn moved(scope: &ScopeData, time: TimeAxis) -> Panel {
    match scope.frame.shown {
        Shown::Tilt => tilt(scope, time),
        Shown::Acceleration(name) => {
            let label = format!("{name}, g");
            range(scope, time, (channel::ACCEL, in_g(scope)), (&label, "mean"))
        }
        Shown::Displacement(name) => {
            let label = format!("{name}, mm");
            range(scope, time, (channel::PLACE, 1e3), (&label, name))
        }
    }
}

/// Returns true if a part pitched by more than a rounding error.
pub fn has_pitch(scope: &ScopeData) -> bool {
    let total = scope.envelope.total(channel::PITCH);
    !total.is_empty() && total.peak() > 1e-6
}

/// Pitch, in mrad, of the part that the machine moves.
pub fn pitch(scope: &ScopeData, time: TimeAxis) -> Panel {
    range(scope, time, (channel::PITCH, 1.0), ("pitch, mrad", "pitch"))
}

/// Draws the range that one scaled channel covers, with the label of the panel and the name of the curve.
fn range(
    scope: &ScopeData,
    time: TimeAxis,
    (channel, scale): (usize, f64),
    (label, name): (&str, &str),
) -> Panel {
    let total = scope.envelope.total(channel).times(scale);
    let mut draft = Draft::new(&scope.envelope, time, label, padded(total, min(scope)));
    let pen = Pen {
        colour: BLUE,
        width: 1.2,
    };
    draft.range(channel, scale, pen);
    draft.entry(LegendShape::Line, BLUE, peak(name, total));
    draft.done()
}

/// Speed of the master shaft in Hz, with the bands in which it must not dwell.
pub fn speed(scope: &ScopeData, time: TimeAxis) -> Panel {
    let per_rad_s = 1.0 / TAU;
    let total = scope.envelope.total(channel::SPEED).times(per_rad_s);
    let top = total.peak();
    let mut shown = total.and(from_rest(scope));
    let bands = scope.frame.bands_hz.iter();
    let bands: Vec<_> = bands
        .filter(|(low, high)| low.is_finite() && high.is_finite() && low < high)
        .map(|&(low, high)| (low, high, top >= 0.7 * low && top > 0.0))
        .collect();
    for &(low, high, is_near) in &bands {
        if is_near {
            // Of a band whose end is far above the data, only a part is shown.
            let high = high.min(low.max(1.5 * top));
            shown = shown.and(Extent { low, high });
        }
    }
    let y = padded(shown, min(scope));
    let mut draft = Draft::new(&scope.envelope, time, "speed, Hz", y);
    draft.entry(LegendShape::Line, DARK_BLUE, peak("shaft", total));
    for (low, high, is_near) in bands {
        let name = format!("avoid {}–{}", plain(low), plain(high));
        if is_near {
            draft.regions.push(
                ShadedRegion::horizontal(low.max(y.0), high.min(y.1))
                    .with_color(BAND)
                    .with_opacity(0.22),
            );
            for edge in [low, high].into_iter().filter(|&edge| edge < y.1) {
                draft.limits.push(
                    ReferenceLine::horizontal(edge)
                        .with_color(BAND)
                        .with_dasharray("1 0"),
                );
            }
            draft.entry(LegendShape::Rect, "#F8E2B5", name);
        } else {
            draft.entry(LegendShape::Rect, "#F8E2B5", format!("{name} (above)"));
        }
    }
    draft.curve(
        channel::SPEED,
        per_rad_s,
        Pen {
            colour: DARK_BLUE,
            width: 1.6,
        },
    );
    draft.done()
}

/// Returns true if a sensor measures the phase error of an axis.
pub fn has_phase_error(scope: &ScopeData) -> bool {
    let channels = channel::PHASE_ERROR..channel::PHASE_ERROR + scope.axes;
    channels
        .into_iter()
        .any(|channel| !scope.envelope.total(channel).is_empty())
}

/// Phase error of each axis in degrees, with its limit. Curves that coincide are drawn one within the other, the first axis widest,
/// and the legend names them. The curve of an axis that nothing measures any more ends with a bar.
pub fn phase_error(scope: &ScopeData, time: TimeAxis) -> Panel {
    let channel = |axis: usize| channel::PHASE_ERROR + axis;
    let totals = (0..scope.axes).map(|axis| scope.envelope.total(channel(axis)));
    let all = totals.fold(Extent::EMPTY, Extent::and);
    let (shown, limit) = with_limit(all, scope.frame.phase_error_limit_deg);
    let y = padded(shown, 0.1);
    // About a pixel.
    let near = (y.1 - y.0) / 150.0;
    let like = |axis: usize, other: usize| {
        scope
            .envelope
            .are_alike(channel(axis), channel(other), near)
    };
    // For each axis, the first axis with which it coincides, or the axis itself if there is none before it.
    let first: Vec<usize> = (0..scope.axes)
        .map(|axis| (0..axis).find(|&other| like(axis, other)).unwrap_or(axis))
        .collect();
    let mut draft = Draft::new(&scope.envelope, time, "phase error, deg", y);
    for axis in 0..scope.axes {
        let colour = AXES[axis % AXES.len()];
        let above = first[axis + 1..]
            .iter()
            .filter(|&&other| other == first[axis]);
        let width = 1.5 + 2.0 * above.count() as f64;
        draft.curve(channel(axis), 1.0, Pen { colour, width });
        let end = draft.end(channel(axis), Pen { colour, width: 1.5 });
        let name = format!("axis {axis}");
        let name = match (end, first[axis]) {
            (Some(end), _) => format!("{name} ends at {}", short(end)),
            (None, own) if own == axis => peak(&name, scope.envelope.total(channel(axis))),
            (None, other) => format!("{name}, as axis {other}"),
        };
        draft.entry(LegendShape::Line, colour, name);
    }
    draft.limit(limit);
    Panel {
        note: scope.is_corrected.then_some(STAYS),
        ..draft.done()
    }
}

/// Tilt along x and y in mrad, with its limit.
fn tilt(scope: &ScopeData, time: TimeAxis) -> Panel {
    let x = scope.envelope.total(channel::TILT_X);
    let y = scope.envelope.total(channel::TILT_Y);
    let (shown, limit) = with_limit(x.and(y), scope.frame.tilt_limit_mrad);
    let mut draft = Draft::new(&scope.envelope, time, "tilt, mrad", padded(shown, 0.1));
    for (channel, colour, name, total) in [
        (channel::TILT_X, BLUE, "x", x),
        (channel::TILT_Y, ORANGE, "y", y),
    ] {
        draft.range(channel, 1.0, Pen { colour, width: 1.2 });
        draft.entry(
            LegendShape::Line,
            colour,
            peak(&format!("along {name}"), total),
        );
    }
    draft.limit(limit);
    draft.done()
}

/// Returns the range for data with a limit, and the limit with true if it is in this range.
fn with_limit(data: Extent, limit: Option<f64>) -> (Extent, Option<(f64, bool)>) {
    let Some(limit) = limit.map(f64::abs).filter(|limit| limit.is_finite()) else {
        return (data, None);
    };
    let is_shown = is_in_sight(limit, data.peak());
    let shown = if is_shown {
        data.and(Extent {
            low: -limit,
            high: limit,
        })
    } else {
        data
    };
    (shown, Some((limit, is_shown)))
}

/// Returns the text of a legend entry with the largest magnitude.
pub fn peak(name: &str, total: Extent) -> String {
    if total.is_empty() {
        format!("{name}, no data")
    } else {
        // A rounding error of zero is not a peak.
        const NOTHING: f64 = 1e-9;
        let peak = total.peak();
        format!(
            "{name}, peak {}",
            short(if peak < NOTHING { 0.0 } else { peak })
        )
    }
}
