//! Colours and texts of all drawings.

use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene, TextAnchor};

/// Colour of texts.
pub const INK: &str = "#222222";
/// Colour of secondary elements.
pub const MUTED: &str = "#666666";
/// Colour of limits and faults only.
pub const VERMILION: &str = "#D55E00";

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
