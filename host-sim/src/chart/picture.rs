//! A picture of panels side by side, on logarithmic axes, one line a method.

use cophase_methods::Scheme;
use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::annotations::ReferenceLine;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

/// One panel.
pub struct Panel {
    /// What it is of.
    pub title: String,
    /// With its unit.
    pub x_label: &'static str,
    /// With its unit.
    pub y_label: &'static str,
    /// What is shown of either axis.
    pub x: (f64, f64),
    /// What is shown of either axis.
    pub y: (f64, f64),
    /// Lines, back to front.
    pub lines: Vec<Line>,
    /// Levels that mean something, marked across.
    pub levels: Vec<(f64, String)>,
}

/// A line through measured points.
pub struct Line {
    /// Whose it is.
    pub scheme: Scheme,
    /// Points, by x.
    pub points: Vec<(f64, f64)>,
    /// Whether each point is marked.
    pub marked: bool,
}

/// Colours of Okabe and Ito, which the colour-blind tell apart.
const fn colour(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::ExplicitEuler => "#D55E00",
        Scheme::SymplecticEuler => "#E69F00",
        Scheme::VelocityVerlet => "#009E73",
        Scheme::Rk4 => "#0072B2",
        Scheme::ImplicitMidpoint => "#CC79A7",
        Scheme::Sdirk4 => "#56B4E9",
        Scheme::Exact => "#222222",
    }
}

/// Where some lie on others, dashes let both be seen.
const fn is_dashed(scheme: Scheme) -> bool {
    matches!(
        scheme,
        Scheme::VelocityVerlet | Scheme::Sdirk4 | Scheme::Exact
    )
}

const CELL: (f64, f64) = (520.0, 420.0);

/// The picture as SVG text.
pub fn render(title: &str, panels: Vec<Panel>) -> String {
    let columns = panels.len();
    let mut plots = Vec::new();
    let mut layouts = Vec::new();
    let mut shown: Vec<Scheme> = Vec::new();
    for panel in panels {
        for line in &panel.lines {
            if !shown.contains(&line.scheme) {
                shown.push(line.scheme);
            }
        }
        let (panel_plots, layout) = lay_out(panel);
        plots.push(panel_plots);
        layouts.push(layout);
    }
    let legend = shown.into_iter().map(|scheme| LegendEntry {
        label: scheme.facts().name.to_owned(),
        color: colour(scheme).to_owned(),
        shape: LegendShape::Line,
        dasharray: is_dashed(scheme).then(|| "6 4".to_owned()),
    });
    let figure = Figure::new(1, columns)
        .with_title(title)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(CELL.0, CELL.1)
        .with_shared_legend_entries(legend.collect())
        .with_shared_legend_right_top();
    SvgBackend::new().render_scene(&figure.render())
}

fn lay_out(panel: Panel) -> (Vec<Plot>, Layout) {
    let mut plots = Vec::new();
    for line in panel.lines {
        let within = |&(x, y): &(f64, f64)| {
            (panel.x.0..=panel.x.1).contains(&x) && (panel.y.0..=panel.y.1).contains(&y)
        };
        let points: Vec<_> = line.points.iter().copied().filter(within).collect();
        if line.marked {
            let marks = ScatterPlot::new().with_data(points.iter().copied());
            plots.push(Plot::Scatter(
                marks.with_color(colour(line.scheme)).with_size(3.0),
            ));
        }
        let mut drawn = LinePlot::new()
            .with_data(points)
            .with_color(colour(line.scheme))
            .with_stroke_width(1.8);
        if is_dashed(line.scheme) {
            drawn = drawn.with_dashed();
        }
        plots.push(Plot::Line(drawn));
    }
    let mut layout = Layout::new(panel.x, panel.y)
        .with_log_scale()
        .with_x_axis_min(panel.x.0)
        .with_x_axis_max(panel.x.1)
        .with_y_axis_min(panel.y.0)
        .with_y_axis_max(panel.y.1)
        .with_title(panel.title)
        .with_title_size(15)
        .with_x_label(panel.x_label)
        .with_y_label(panel.y_label)
        .with_font_family("sans-serif")
        .with_legend_position(LegendPosition::OutsideRightTop);
    for (level, label) in panel.levels {
        layout = layout.with_reference_line(
            ReferenceLine::horizontal(level)
                .with_color("#888888")
                .with_label(label),
        );
    }
    (plots, layout)
}
