//! Colours, texts and places on the page.

use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::scale::TimeAxis;

/// The page's width, px.
pub const WIDTH: f64 = 1200.0;
/// Margins beside the panels, px.
pub const LEFT: f64 = 78.0;
/// See there.
pub const RIGHT: f64 = 182.0;
const PLOT_WIDTH: f64 = WIDTH - LEFT - RIGHT;

/// Colour of texts.
pub const INK: &str = "#222222";
/// Of what should not draw the eye.
pub const MUTED: &str = "#666666";
/// Limits and faults, and nothing else.
pub const VERMILION: &str = "#D55E00";

/// Where a time is on the page, px from the left.
pub fn at(time: TimeAxis, t_s: f64) -> f64 {
    LEFT + PLOT_WIDTH * time.fraction(t_s)
}

/// About how wide a text is, px; the viewer's font is not known here.
pub fn width(text: &str, size: u32) -> f64 {
    0.58 * f64::from(size) * text.chars().count() as f64
}

/// Whether a text of the ribbon's size goes into so many pixels.
pub fn fits(text: &str, room: f64) -> bool {
    width(text, 12) + 6.0 <= room
}

/// Writes a text that begins at a place.
pub fn text(scene: &mut Scene, place: (f64, f64), content: &str, size: u32, colour: &str) {
    text_anchored(scene, place, content, size, colour, TextAnchor::Start);
}

/// Writes a text whose beginning, middle or end is at a place.
pub fn text_anchored(
    scene: &mut Scene,
    (x, y): (f64, f64),
    content: &str,
    size: u32,
    colour: &str,
    anchor: TextAnchor,
) {
    scene.add(Primitive::Text {
        x,
        y,
        // Control characters are not allowed in XML.
        content: content
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect(),
        size,
        anchor,
        rotate: None,
        bold: size > 20,
        color: Some(Color::from(colour)),
    });
}
