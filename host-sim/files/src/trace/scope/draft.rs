//! Builder of a panel: curves from the envelope, limits, a legend, and suitable value axes.

use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::plot::{BandPlot, LinePlot};
use kuva::render::annotations::{ReferenceLine, ShadedRegion};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use super::curve;
use super::envelope::{Envelope, Extent};
use super::scale::{TimeAxis, plain};
use super::style::VERMILION;

/// One panel, ready for the page: kuva's plots, and the layout without its place on the page.
pub struct Panel {
    /// Curves, in drawing order. Later ones cover earlier ones.
    pub plots: Vec<Plot>,
    /// Axes, limits, legend.
    pub layout: Layout,
    /// A short remark below the panel.
    pub note: Option<&'static str>,
}

/// Builder of a panel.
pub struct Draft<'a> {
    envelope: &'a Envelope,
    time: TimeAxis,
    y: (f64, f64),
    label: String,
    plots: Vec<Plot>,
    legend: Vec<LegendEntry>,
    /// Horizontal lines.
    pub limits: Vec<ReferenceLine>,
    /// Shaded stretches of the value axis.
    pub regions: Vec<ShadedRegion>,
}

/// Style of a curve.
#[derive(Clone, Copy)]
pub struct Pen {
    /// Colour as `#rrggbb`.
    pub colour: &'static str,
    /// Pixels.
    pub width: f64,
}

impl<'a> Draft<'a> {
    /// Creates a panel with a value axis: its label, start and end.
    pub fn new(
        envelope: &'a Envelope,
        time: TimeAxis,
        label: impl Into<String>,
        y: (f64, f64),
    ) -> Self {
        Self {
            envelope,
            time,
            y,
            label: label.into(),
            plots: Vec::new(),
            legend: Vec::new(),
            limits: Vec::new(),
            regions: Vec::new(),
        }
    }

    /// Buckets of one channel in the panel's units.
    fn buckets(
        &self,
        channel: usize,
        factor: f64,
    ) -> impl Iterator<Item = (f64, f64, Extent)> + 'a {
        let per_second = self.time.per_second;
        let buckets = self.envelope.channel(channel);
        buckets.map(move |(first, last, extent)| {
            (first * per_second, last * per_second, extent.times(factor))
        })
    }

    /// Draws a line through the extremes of all buckets.
    pub fn curve(&mut self, channel: usize, factor: f64, pen: Pen) {
        // About a tenth of a pixel.
        let tolerance = (self.y.1 - self.y.0) / 1500.0;
        for points in curve::lines(self.buckets(channel, factor), tolerance) {
            self.line(points, pen);
        }
    }

    /// Draws a bar across the end of a curve whose data end before the run, in the unit of the channel. Returns the time of that end, in
    /// the unit of the time axis; `None` if the data last to the end, or if there are none.
    pub fn end(&mut self, channel: usize, pen: Pen) -> Option<f64> {
        let data = |(_, last, extent): (f64, f64, Extent)| {
            (!extent.is_empty()).then(|| (last, extent.low.midpoint(extent.high)))
        };
        let buckets: Vec<_> = self.buckets(channel, 1.0).map(data).collect();
        let (last, before) = buckets.split_last()?;
        if last.is_some() {
            return None;
        }
        let (end, value) = before.iter().rev().find_map(|data| *data)?;
        let reach = (self.y.1 - self.y.0) / 15.0;
        self.line(vec![(end, value - reach), (end, value + reach)], pen);
        Some(end)
    }

    /// Draws a translucent area between outlines where a line would be a solid block that hides what is
    /// behind it.
    pub fn range(&mut self, channel: usize, factor: f64, pen: Pen) {
        let span = self.y.1 - self.y.0;
        let (sum, count) = self
            .buckets(channel, factor)
            .filter(|(_, _, extent)| !extent.is_empty())
            .fold((0.0, 0.0), |(sum, count), (_, _, e)| {
                (sum + (e.high - e.low), count + 1.0)
            });
        let is_thick = self.envelope.is_folded() && sum > 0.01 * span * count;
        if !is_thick {
            return self.curve(channel, factor, pen);
        }
        for (mut lower, mut upper) in curve::outlines(self.buckets(channel, factor)) {
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
            // A line with a single point would not be visible.
            let reach = (self.time.to - self.time.from) / 400.0;
            points = vec![(t - reach, value), (t + reach, value)];
        }
        let line = LinePlot::new().with_data(points);
        self.plots.push(Plot::Line(
            line.with_color(pen.colour).with_stroke_width(pen.width),
        ));
    }

    /// Adds a line to the legend.
    pub fn entry(&mut self, shape: LegendShape, colour: &str, label: String) {
        self.legend.push(LegendEntry {
            label,
            color: colour.to_owned(),
            shape,
            dasharray: None,
        });
    }

    /// Draws a limit in both directions if it is in sight, and names it in the legend.
    pub fn limit(&mut self, limit: Option<(f64, bool)>) {
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

    /// Returns the panel.
    pub fn done(mut self) -> Panel {
        if self.plots.is_empty() {
            // kuva draws no axes without a plot.
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
            note: None,
        }
    }
}
