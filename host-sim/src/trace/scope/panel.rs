//! The four panels: what each one shows, in which colours, with which legend.
//!
//! Colours are those of Okabe and Ito, which the colour-blind tell apart; vermilion is kept for limits and
//! faults. Where two curves are meant to coincide, the one asked for is thick and pale, the one got
//! thin and dark, so that both are seen.

use std::f64::consts::TAU;

use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::plot::{BandPlot, LinePlot};
use kuva::render::annotations::{ReferenceLine, ShadedRegion};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use super::envelope::Extent;
use super::scale::{TimeAxis, is_in_sight, padded, short};
use super::{ScopeData, channel, curve};

/// Limits and faults.
pub const VERMILION: &str = "#D55E00";
const PALE_BLUE: &str = "#A6D0EC";
const DARK_BLUE: &str = "#0B2F5B";
const BAND: &str = "#E69F00";
const BLUE: &str = "#0072B2";
const ORANGE: &str = "#E69F00";
/// One an axis, in turn.
const AXES: [&str; 6] = [BLUE, ORANGE, "#009E73", "#CC79A7", "#56B4E9", "#444444"];
const STANDARD_GRAVITY_MPS2: f64 = 9.80665;

/// One panel, ready to be laid out: kuva's plots, and the layout without its place on the page.
pub struct Panel {
    /// Curves, the back ones first.
    pub plots: Vec<Plot>,
    /// Axes, limits, legend.
    pub layout: Layout,
}

/// A panel that is being put together.
struct Draft<'a> {
    scope: &'a ScopeData,
    time: TimeAxis,
    y: (f64, f64),
    label: &'static str,
    plots: Vec<Plot>,
    legend: Vec<LegendEntry>,
    limits: Vec<ReferenceLine>,
    regions: Vec<ShadedRegion>,
}

/// How a curve looks.
#[derive(Clone, Copy)]
struct Pen {
    colour: &'static str,
    width: f64,
}

/// Acceleration asked for and got, in g.
pub fn acceleration(scope: &ScopeData, time: TimeAxis) -> Panel {
    let gravity = scope.frame.gravity_mps2;
    let per_mps2 = if gravity.is_finite() && gravity > 0.0 {
        1.0 / gravity
    } else {
        1.0 / STANDARD_GRAVITY_MPS2
    };
    let asked = scope.envelope.total(channel::PROGRAM).times(per_mps2);
    let got = scope.envelope.total(channel::COMMAND).times(per_mps2);
    let mut draft = Draft::new(scope, time, "amax, g", padded(asked.and(got), 0.5));
    let pen = |colour, width| Pen { colour, width };
    draft.curve(channel::PROGRAM, per_mps2, pen(PALE_BLUE, 5.0));
    draft.curve(channel::COMMAND, per_mps2, pen(DARK_BLUE, 1.4));
    draft.entry(
        LegendShape::Rect,
        PALE_BLUE,
        format!("asked, peak {}", short(asked.peak())),
    );
    draft.entry(
        LegendShape::Line,
        DARK_BLUE,
        format!("got, peak {}", short(got.peak())),
    );
    draft.done()
}

/// Speed of the master shaft in Hz, with the bands it should not dwell in.
pub fn speed(scope: &ScopeData, time: TimeAxis) -> Panel {
    let per_rad_s = 1.0 / TAU;
    let total = scope.envelope.total(channel::SPEED).times(per_rad_s);
    let peak = total.peak();
    let mut shown = total;
    let bands = scope.frame.bands_hz.iter();
    let bands: Vec<_> = bands
        .filter(|(low, high)| low.is_finite() && high.is_finite() && low < high)
        .map(|&(low, high)| (low, high, peak >= 0.7 * low && peak > 0.0))
        .collect();
    for &(low, high, is_near) in &bands {
        if is_near {
            shown = shown.and(Extent { low, high });
        }
    }
    let mut draft = Draft::new(scope, time, "speed, Hz", padded(shown, 0.5));
    draft.entry(
        LegendShape::Line,
        DARK_BLUE,
        format!("shaft, peak {}", short(peak)),
    );
    for (low, high, is_near) in bands {
        let name = format!("avoid {}–{}", plain(low), plain(high));
        if is_near {
            draft.regions.push(
                ShadedRegion::horizontal(low, high)
                    .with_color(BAND)
                    .with_opacity(0.22),
            );
            for edge in [low, high] {
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

/// Drift of each axis in degrees, with its limit.
pub fn drift(scope: &ScopeData, time: TimeAxis) -> Panel {
    let totals = (0..scope.axes).map(|i| scope.envelope.total(channel::DRIFT + i));
    let all = totals.fold(Extent::EMPTY, Extent::and);
    let (shown, limit) = with_limit(all, scope.frame.drift_limit_deg);
    let mut draft = Draft::new(scope, time, "drift, deg", padded(shown, 0.1));
    for i in 0..scope.axes {
        let colour = AXES[i % AXES.len()];
        let peak = scope.envelope.total(channel::DRIFT + i).peak();
        draft.curve(channel::DRIFT + i, 1.0, Pen { colour, width: 1.5 });
        draft.entry(
            LegendShape::Line,
            colour,
            format!("axis {i}, peak {}", short(peak)),
        );
    }
    draft.limit(limit);
    draft.done()
}

/// Tilt about x and y in mrad, with its limit.
pub fn tilt(scope: &ScopeData, time: TimeAxis) -> Panel {
    let x = scope.envelope.total(channel::TILT_X);
    let y = scope.envelope.total(channel::TILT_Y);
    let (shown, limit) = with_limit(x.and(y), scope.frame.tilt_limit_mrad);
    let mut draft = Draft::new(scope, time, "tilt, mrad", padded(shown, 0.1));
    for (channel, colour, name, total) in [
        (channel::TILT_X, BLUE, "x", x),
        (channel::TILT_Y, ORANGE, "y", y),
    ] {
        draft.range(channel, Pen { colour, width: 1.2 });
        draft.entry(
            LegendShape::Line,
            colour,
            format!("about {name}, peak {}", short(total.peak())),
        );
    }
    draft.limit(limit);
    draft.done()
}

/// What to show of data with a limit, and the limit with whether it is in sight.
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

/// A number as it was given, for bands and limits.
fn plain(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    format!("{rounded}")
}

impl<'a> Draft<'a> {
    fn new(scope: &'a ScopeData, time: TimeAxis, label: &'static str, y: (f64, f64)) -> Self {
        Self {
            scope,
            time,
            y,
            label,
            plots: Vec::new(),
            legend: Vec::new(),
            limits: Vec::new(),
            regions: Vec::new(),
        }
    }

    /// One channel's buckets in the panel's units.
    fn buckets(
        &self,
        channel: usize,
        factor: f64,
    ) -> impl Iterator<Item = (f64, f64, Extent)> + 'a {
        let per_second = self.time.per_second;
        let buckets = self.scope.envelope.channel(channel);
        buckets.map(move |(first, last, extent)| {
            (first * per_second, last * per_second, extent.times(factor))
        })
    }

    /// A line through the extremes of all buckets.
    fn curve(&mut self, channel: usize, factor: f64, pen: Pen) {
        // About a tenth of a pixel.
        let tolerance = (self.y.1 - self.y.0) / 1500.0;
        for points in curve::lines(self.buckets(channel, factor), tolerance) {
            self.line(points, pen);
        }
    }

    /// A see-through area between outlines, where a line would be a block that hides what is behind it.
    fn range(&mut self, channel: usize, pen: Pen) {
        let span = self.y.1 - self.y.0;
        let (sum, count) = self
            .buckets(channel, 1.0)
            .filter(|(_, _, extent)| !extent.is_empty())
            .fold((0.0, 0.0), |(sum, count), (_, _, e)| {
                (sum + (e.high - e.low), count + 1.0)
            });
        let is_thick = self.scope.envelope.is_folded() && sum > 0.01 * span * count;
        if !is_thick {
            return self.curve(channel, 1.0, pen);
        }
        for (mut lower, mut upper) in curve::outlines(self.buckets(channel, 1.0)) {
            let times = lower.iter().map(|p| p.0);
            let band = BandPlot::new(times, lower.iter().map(|p| p.1), upper.iter().map(|p| p.1));
            self.plots
                .push(Plot::Band(band.with_color(pen.colour).with_opacity(0.3)));
            for outline in [&mut lower, &mut upper] {
                curve::thin(outline, span / 1500.0);
                self.line(std::mem::take(outline), Pen { width: 0.8, ..pen });
            }
        }
    }

    fn line(&mut self, mut points: curve::Points, pen: Pen) {
        if let [(t, value)] = points[..] {
            // A single row would not be seen.
            points.push((t + (self.time.to - self.time.from) / 200.0, value));
        }
        let line = LinePlot::new().with_data(points);
        self.plots.push(Plot::Line(
            line.with_color(pen.colour).with_stroke_width(pen.width),
        ));
    }

    fn entry(&mut self, shape: LegendShape, colour: &str, label: String) {
        self.legend.push(LegendEntry {
            label,
            color: colour.to_owned(),
            shape,
            dasharray: None,
        });
    }

    fn limit(&mut self, limit: Option<(f64, bool)>) {
        let Some((limit, is_shown)) = limit else {
            return;
        };
        let name = format!("limit ±{}", plain(limit));
        if is_shown {
            for level in [-limit, limit] {
                self.limits.push(
                    ReferenceLine::horizontal(level)
                        .with_color(VERMILION)
                        .with_stroke_width(1.2),
                );
            }
            self.entry(LegendShape::Line, VERMILION, name);
        } else {
            self.entry(LegendShape::Line, VERMILION, format!("{name} (beyond)"));
        }
        if let Some(entry) = self.legend.last_mut() {
            entry.dasharray = Some("6 4".to_owned());
        }
    }

    fn done(mut self) -> Panel {
        if self.plots.is_empty() {
            // kuva draws no axes around nothing.
            self.plots.push(Plot::Line(LinePlot::new()));
        }
        let mut layout = Layout::new((self.time.from, self.time.to), self.y)
            .with_x_axis_min(self.time.from)
            .with_x_axis_max(self.time.to)
            .with_y_axis_min(self.y.0)
            .with_y_axis_max(self.y.1)
            .with_y_label(self.label)
            .with_legend_entries(self.legend)
            .with_legend_position(LegendPosition::OutsideRightTop)
            .with_legend_box(false);
        layout.reference_lines = self.limits;
        layout.shaded_regions = self.regions;
        Panel {
            plots: self.plots,
            layout,
        }
    }
}
