//! Colours, texts and SVG text of all drawings.

use kuva::backend::svg::SvgBackend;
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

/// Returns a drawing as SVG text. Corners of lines are round.
///
/// The SVG default, a mitre, extends a sharp corner by several line widths. A thick curve would then show peaks that its data do not
/// have.
#[must_use]
pub fn svg(scene: &Scene) -> String {
    let text = SvgBackend::new().render_scene(scene);
    // All elements inherit the property from the root. kuva has no setting for it.
    text.replacen("<svg", "<svg stroke-linejoin=\"round\"", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a curve of width 5 px with noise of 0.3 px shows peaks of several pixels.
    #[test]
    fn corners_of_curves_are_round() {
        let mut scene = Scene::new(10.0, 10.0);
        scene.add(Primitive::PolyLine {
            points: vec![(0.0, 5.0), (5.0, 4.7), (5.1, 5.0)],
            stroke: Color::from(INK),
            stroke_width: 5.0,
            stroke_dasharray: None,
        });
        let text = svg(&scene);
        let (root, elements) = text.split_once('>').unwrap();
        assert!(root.starts_with("<svg ") && root.contains("stroke-linejoin=\"round\""));
        assert!(!elements.contains("linejoin"), "no element has another one");
    }
}
