//! Conversion of a picture to SVG with kuva.

use host_sim::style::svg;
use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::scatter::ScatterPlot;
use kuva::plot::{LabelStyle, LinePlot, LineStyle};
use kuva::render::annotations::ReferenceLine;
use kuva::render::color::Color;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, TextAnchor};
use kuva::render::render_utils::wrap_text;

use super::{At, Line, Panel, Picture};
use crate::chart::axis::Axis;
use crate::chart::ink::Stroke;

const CELL: (f64, f64) = (500.0, 410.0);
/// Margins of a panel's axes, px, for the label and its ticks, and for half the width of a tick.
const MARGINS: (f64, f64) = (74.0, 20.0);
const FONT: &str = "sans-serif";
const SAYS_SIZE: u32 = 15;
/// Approximate width of a letter, relative to its size. The viewer's font is unknown.
const LETTER: f64 = 0.53;

/// Returns the picture as SVG text.
pub fn render(picture: Picture) -> String {
    let legend = legend(&picture);
    let columns = picture.columns.min(picture.panels.len()).max(1);
    let rows = picture.panels.len().div_ceil(columns);
    let (plots, layouts): (Vec<_>, Vec<_>) = picture.panels.into_iter().map(lay_out).unzip();
    let figure = Figure::new(rows, columns)
        .with_title(picture.title)
        .with_structure((0..plots.len()).map(|panel| vec![panel]).collect())
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(CELL.0, CELL.1)
        .with_shared_legend_entries(legend)
        .with_shared_legend_right_top();
    let mut scene = figure.render();
    number_clips(&mut scene);
    say(&mut scene, &picture.says);
    svg(&scene)
}

/// Returns an entry for each name, in the order of the panels.
fn legend(picture: &Picture) -> Vec<LegendEntry> {
    let lines = || picture.panels.iter().flat_map(|panel| &panel.lines);
    let mut shown: Vec<&Line> = Vec::new();
    for line in lines().filter(|line| !line.label.is_empty()) {
        if !shown.iter().any(|other| other.label == line.label) {
            shown.push(line);
        }
    }
    let entry = |line: &Line| {
        let (chosen, not): (Vec<_>, Vec<_>) = lines()
            .filter(|other| other.label == line.label)
            .partition(|other| other.chosen);
        let what = picture.chosen_is;
        let appearance = if line.stroke == Stroke::None {
            "large"
        } else {
            "thick"
        };
        LegendEntry {
            label: match (chosen.is_empty(), not.is_empty()) {
                (true, _) => line.label.clone(),
                (false, true) => format!("{} ({what})", line.label),
                (false, false) => format!("{} ({what} where {appearance})", line.label),
            },
            color: line.ink.hex().to_owned(),
            shape: match line.stroke {
                Stroke::None => LegendShape::Circle,
                _ => LegendShape::Line,
            },
            dasharray: line.stroke.dashes().map(str::to_owned),
        }
    };
    shown.into_iter().map(entry).collect()
}

fn lay_out(panel: Panel) -> (Vec<Plot>, Layout) {
    let Panel {
        title,
        x,
        y,
        lines,
        levels,
    } = panel;
    let mut plots = Vec::new();
    for line in &lines {
        plots.extend(draw(line, &x, &y));
    }
    plots.extend(names(&lines, &x, &y));
    if plots.is_empty() {
        // kuva draws no axes for an empty panel.
        plots.push(Plot::Line(LinePlot::new()));
    }
    let mut layout = Layout::new(x.range(), y.range())
        .with_title(title)
        .with_title_size(15)
        // Otherwise kuva leaves room for the lifted numbers of a logarithmic axis.
        .with_force_margins(MARGINS.0, MARGINS.1)
        .with_font_family(FONT);
    layout = x.lay_out_x(layout);
    layout = y.lay_out_y(layout);
    for level in levels {
        let line = match level.at {
            At::Y(value) => ReferenceLine::horizontal(y.place(value)),
            At::X(value) => ReferenceLine::vertical(x.place(value)),
        };
        let line = line.with_color("#666666").with_label(level.label);
        layout = layout.with_reference_line(line);
    }
    (plots, layout)
}

/// Returns the marks of a line, and the line above them.
fn draw(line: &Line, x: &Axis, y: &Axis) -> Vec<Plot> {
    // A line beyond the axes continues to the edge, where kuva clips it.
    let drawn = |&&(at, value): &&(f64, f64)| x.can_show(at) && y.can_show(value);
    let place = |&(at, value): &(f64, f64)| (x.place(at), y.place(value));
    let mut plots = Vec::new();
    if line.marked {
        let size = if line.chosen { 4.2 } else { 3.0 };
        let marks = ScatterPlot::new()
            .with_data(line.points.iter().filter(drawn).map(place))
            .with_color(line.ink.hex())
            .with_size(size);
        plots.push(Plot::Scatter(marks));
    }
    if line.stroke != Stroke::None {
        let mut joined = LinePlot::new()
            .with_data(line.points.iter().filter(drawn).map(place))
            .with_color(line.ink.hex())
            .with_stroke_width(if line.chosen { 3.6 } else { 1.7 });
        if let Some(dashes) = line.stroke.dashes() {
            joined = joined.with_line_style(LineStyle::Custom(dashes.to_owned()));
        }
        plots.push(Plot::Line(joined));
    }
    plots
}

/// Returns the names of the points of all lines, in one plot, so that they do not overlap.
fn names(lines: &[Line], x: &Axis, y: &Axis) -> Option<Plot> {
    let named = lines
        .iter()
        .flat_map(|line| line.points.iter().zip(&line.names));
    let shown = named.filter(|((at, value), _)| x.can_show(*at) && y.can_show(*value));
    let (points, names): (Vec<_>, Vec<_>) = shown
        .map(|((at, value), name)| ((x.place(*at), y.place(*value)), name.clone()))
        .unzip();
    let plot = ScatterPlot::new()
        .with_data(points)
        .with_size(4.0)
        .with_marker_opacity(0.0)
        .with_labels(names.clone())
        .with_label_style(LabelStyle::Repel);
    (!names.is_empty()).then_some(Plot::Scatter(plot))
}

/// Numbers the clip paths from the beginning of the picture, so that the same data give the same bytes. kuva numbers them
/// across the whole process.
fn number_clips(scene: &mut Scene) {
    let mut clips = 0;
    for element in &mut scene.elements {
        if let Primitive::ClipStart { id, .. } = element {
            let ours = format!("panel-{clips}");
            clips += 1;
            let (theirs, renamed) = (format!("id=\"{id}\""), format!("id=\"{ours}\""));
            for def in &mut scene.defs {
                *def = def.replace(&theirs, &renamed);
            }
            *id = ours;
        }
    }
}

/// Writes the message under the picture, in as many lines as it needs.
fn say(scene: &mut Scene, says: &str) {
    let margin = 24.0;
    let size = f64::from(SAYS_SIZE);
    let letters = (scene.width - 2.0 * margin) / (LETTER * size);
    let lines = wrap_text(says, letters as usize);
    for line in lines {
        scene.add(Primitive::Text {
            x: margin,
            y: scene.height + size,
            content: line,
            size: SAYS_SIZE,
            anchor: TextAnchor::Start,
            rotate: None,
            bold: false,
            color: Some(Color::from("#222222")),
        });
        scene.height += 1.4 * size;
    }
    scene.height += margin / 2.0;
}
