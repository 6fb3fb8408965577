//! Colours, texts and places on the page.

use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::scale::TimeAxis;
pub use host_sim::style::{INK, MUTED, VERMILION, svg, text, text_anchored};

/// Colours of curves.
pub const PALE_BLUE: &str = "#A6D0EC";
/// Colour of curves.
pub const DARK_BLUE: &str = "#0B2F5B";
/// Colour of curves.
pub const BLUE: &str = "#0072B2";
/// Colour of curves.
pub const ORANGE: &str = "#E69F00";
/// Colour of curves.
pub const GREEN: &str = "#009E73";

/// The page's width, px.
pub const WIDTH: f64 = 1200.0;
/// Left margin beside the panels, px.
pub const LEFT: f64 = 78.0;
/// Right margin beside the panels, px.
pub const RIGHT: f64 = 182.0;
const PLOT_WIDTH: f64 = WIDTH - LEFT - RIGHT;

/// Returns the position of a time on the page, px from the left.
pub fn at(time: TimeAxis, t_s: f64) -> f64 {
    LEFT + PLOT_WIDTH * time.fraction(t_s)
}

/// Returns the approximate width of a text, px; the viewer's font is not known here.
pub fn width(text: &str, size: u32) -> f64 {
    0.58 * f64::from(size) * text.chars().count() as f64
}

/// Writes a text on a white background, for places where lines pass behind it.
pub fn text_on_white(
    scene: &mut Scene,
    (x, y): (f64, f64),
    content: &str,
    size: u32,
    colour: &str,
    anchor: TextAnchor,
) {
    let width = width(content, size);
    let left = match anchor {
        TextAnchor::Start => x,
        TextAnchor::Middle => x - 0.5 * width,
        TextAnchor::End => x - width,
    };
    scene.add(Primitive::Rect {
        x: left,
        y: y - f64::from(size) + 1.0,
        width,
        height: f64::from(size) + 2.0,
        fill: "#ffffff".into(),
        stroke: None,
        stroke_width: None,
        opacity: None,
    });
    text_anchored(scene, (x, y), content, size, colour, anchor);
}

/// Returns true if a text of the ribbon's size fits a width in px.
pub fn fits(text: &str, room: f64) -> bool {
    width(text, 12) + 6.0 <= room
}
