//! The page: title, marks, the ribbon of states, and the panels under it, all on one time axis.
//!
//! kuva draws each panel. This module stacks them on kuva's scene.

use kuva::render::layout::Layout;
use kuva::render::render::{Primitive, Scene, TextAnchor, render_multiple};
use kuva::render::theme::Theme;

use super::data::ScopeData;
use super::draft::Panel;
use super::labels::{LANE, Labels};
use super::panel;
use super::scale::TimeAxis;
use super::style::{
    INK, LEFT, MUTED, RIGHT, VERMILION, WIDTH, at, fits, svg, text, text_anchored, text_on_white,
    width,
};

const LANES_TOP: f64 = 72.0;
const RIBBON: f64 = 20.0;
/// Distance of a legend's texts from the plot, and their margin on the right, px.
const LEGEND: f64 = 40.0;
pub const GAP: f64 = 14.0;
pub const TIME_AXIS: f64 = 50.0;
pub const FONT: &str = "sans-serif";

type MakePanel = fn(&ScopeData, TimeAxis) -> Panel;

/// Panels from top to bottom: the function that draws each, and the height of its plot area.
fn panels(scope: &ScopeData) -> Vec<(MakePanel, f64)> {
    let mut panels: Vec<(MakePanel, f64)> = vec![
        (panel::acceleration, 190.0),
        (panel::speed, 150.0),
        (panel::moved, 150.0),
    ];
    if panel::has_phase_error(scope) {
        panels.insert(2, (panel::phase_error, 170.0));
    }
    if panel::has_pitch(scope) {
        panels.push((panel::pitch, 120.0));
    }
    panels
}

impl ScopeData {
    /// The page, as SVG text.
    pub fn render(&self) -> String {
        page(self)
    }
}

fn page(scope: &ScopeData) -> String {
    let time = TimeAxis::new(scope.envelope.span());
    let labels = Labels::place(scope, time);
    let ribbon_top = LANES_TOP + labels.lanes as f64 * LANE;
    let panels_top = ribbon_top + RIBBON + 8.0;
    let panels = panels(scope);
    let count = panels.len();
    let plots: f64 = panels.iter().map(|(_, height)| height + GAP).sum();
    let height = panels_top + plots - GAP + TIME_AXIS;

    let mut scene = Scene::new(WIDTH, height);
    scene.font_family = Some(FONT.to_owned());
    heading(&mut scene, scope);
    labels.draw(&mut scene, ribbon_top, height - TIME_AXIS);
    ribbon(&mut scene, scope, time, ribbon_top);
    let mut top = panels_top;
    for (i, (make, plot_height)) in panels.into_iter().enumerate() {
        let panel = make(scope, time);
        let is_last = i + 1 == count;
        embed(
            &mut scene,
            panel,
            i,
            top,
            plot_height,
            is_last.then(|| format!("time since power-up, {}", time.unit)),
        );
        top += plot_height + GAP;
    }
    svg(&scene)
}

fn heading(scene: &mut Scene, scope: &ScopeData) {
    let missing = scope.timeline.missing();
    let mut subtitle = scope.frame.subtitle.clone();
    if missing > 0 {
        subtitle += &format!(" (marks not shown: {missing})");
    }
    text(scene, (LEFT, 34.0), &scope.frame.title, 22, INK);
    text(scene, (LEFT, 56.0), &subtitle, 13, MUTED);
}

/// Puts a panel's scene on the page, with its plot area at `top`. If it has a label, it gets the time axis.
pub fn embed(
    page: &mut Scene,
    panel: Panel,
    number: usize,
    top: f64,
    plot_height: f64,
    time_label: Option<String>,
) {
    let bottom = if time_label.is_some() { TIME_AXIS } else { 1.0 };
    let Panel {
        plots,
        layout,
        note,
    } = panel;
    // A page is as wide as its longest legend.
    let entries = layout.legend_entries.iter().flatten();
    let longest = entries
        .map(|entry| width(&entry.label, 12))
        .fold(0.0, f64::max);
    let extra = (LEGEND + longest - RIGHT).max(0.0).ceil();
    page.width = page.width.max(WIDTH + extra);
    let mut layout: Layout = layout
        .with_width(WIDTH + extra)
        .with_height(plot_height + bottom)
        .with_force_margins(LEFT, RIGHT + extra)
        .with_force_margins_y(0.0, bottom)
        .with_theme(Theme {
            grid_color: "#e6e6e6".into(),
            axis_color: "#888888".into(),
            tick_color: "#888888".into(),
            text_color: INK.into(),
            ..Theme::light()
        })
        .with_box_axes()
        .with_font_family(FONT)
        .with_label_size(13)
        .with_tick_size(11)
        .with_body_size(12);
    match time_label {
        Some(label) => layout = layout.with_x_label(label),
        None => layout.suppress_x_ticks = true,
    }
    let drawn = render_multiple(plots, layout);

    // kuva numbers clip paths across the whole process. Here they are numbered by panel, so that the same run
    // gives the same bytes.
    let mut elements = drawn.elements;
    let mut defs = drawn.defs;
    let mut clips = 0;
    for element in &mut elements {
        if let Primitive::ClipStart { id, .. } = element {
            let ours = format!("panel-{number}-{clips}");
            clips += 1;
            for def in &mut defs {
                *def = def.replace(&format!("id=\"{id}\""), &format!("id=\"{ours}\""));
            }
            *id = ours;
        }
    }
    page.defs.append(&mut defs);
    page.add(Primitive::GroupStart {
        transform: Some(format!("translate(0,{top})")),
        title: None,
        extra_attrs: None,
    });
    page.elements.append(&mut elements);
    page.add(Primitive::GroupEnd);
    if let Some(note) = note {
        text_on_white(
            page,
            (LEFT, top + plot_height + GAP - 3.0),
            note,
            11,
            MUTED,
            TextAnchor::Start,
        );
    }
}

/// Draws the states as a band of named stretches. A name that does not fit is among the labels above.
fn ribbon(scene: &mut Scene, scope: &ScopeData, time: TimeAxis, top: f64) {
    text_anchored(
        scene,
        (LEFT - 8.0, top + 14.0),
        "state",
        12,
        INK,
        TextAnchor::End,
    );
    for stretch in scope.timeline.stretches() {
        let (from, to) = (at(time, stretch.from_s), at(time, stretch.to_s));
        let (fill, ink) = state_colours(stretch.state);
        scene.add(Primitive::Rect {
            x: from,
            y: top,
            // Even the shortest state is visible as a line.
            width: (to - from).max(1.0),
            height: RIBBON,
            fill: fill.into(),
            stroke: None,
            stroke_width: None,
            opacity: None,
        });
        if fits(stretch.state, to - from) {
            let middle = (f64::midpoint(from, to), top + 14.0);
            text_anchored(scene, middle, stretch.state, 12, ink, TextAnchor::Middle);
        }
    }
}

/// Fill and text of a state.
fn state_colours(state: &str) -> (&'static str, &'static str) {
    match state {
        "homing" => ("#BFE0F5", INK),
        "run" => ("#A8DCCB", INK),
        "stop" => ("#F6D58E", INK),
        "parked" => ("#CFCFDA", INK),
        _ if state.starts_with("fault") => (VERMILION, "#ffffff"),
        _ => ("#E4E4E4", INK),
    }
}
