//! Drawing of a mechanism to scale: lines, pins and labels in the mechanism's own unit, with y upwards.

use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};

use crate::ink::{INK, text};

const WIDTH: f64 = 900.0;
/// Space around the mechanism, px; the title stands in the upper one.
const MARGIN: f64 = 70.0;

/// Colours of a first and a second position.
pub(super) const FIRST: &str = "#0072B2";
pub(super) const SECOND: &str = "#009E73";

/// A place, in the mechanism's unit.
pub(super) type Place = [f64; 2];

/// A drawing that is being made.
pub(super) struct Drawing {
    scene: Scene,
    scale: f64,
    /// Lower left corner of what is drawn.
    low: Place,
    height: f64,
}

impl Drawing {
    /// For a mechanism between two corners.
    pub(super) fn new(title: &str, low: Place, high: Place) -> Self {
        let scale = (WIDTH - 2.0 * MARGIN) / (high[0] - low[0]);
        let height = scale * (high[1] - low[1]) + 2.0 * MARGIN;
        let mut scene = Scene::new(WIDTH, height);
        scene.font_family = Some("sans-serif".to_owned());
        scene.background_color = Some("#ffffff".to_owned());
        let mut drawing = Self {
            scene,
            scale,
            low,
            height,
        };
        text(&mut drawing.scene, (MARGIN, 36.0), title, 22, INK);
        drawing
    }

    fn at(&self, place: Place) -> (f64, f64) {
        (
            MARGIN + self.scale * (place[0] - self.low[0]),
            self.height - MARGIN - self.scale * (place[1] - self.low[1]),
        )
    }

    /// A polyline; dashed for what is no part of the machine.
    pub(super) fn line(&mut self, places: &[Place], colour: &str, width: f64, is_dashed: bool) {
        let points = places.iter().map(|&place| self.at(place)).collect();
        self.scene.add(Primitive::PolyLine {
            points,
            stroke: Color::from(colour),
            stroke_width: width,
            stroke_dasharray: is_dashed.then(|| "6 5".to_owned()),
        });
    }

    /// An arc around a centre, from one angle to another, rad.
    pub(super) fn arc(&mut self, centre: Place, radius: f64, (from, to): (f64, f64), colour: &str) {
        const PIECES: u32 = 90;
        let places: Vec<Place> = (0..=PIECES)
            .map(|i| {
                let angle = from + (to - from) * f64::from(i) / f64::from(PIECES);
                [
                    centre[0] + radius * angle.cos(),
                    centre[1] + radius * angle.sin(),
                ]
            })
            .collect();
        self.line(&places, colour, 1.2, true);
    }

    /// A joint.
    pub(super) fn pin(&mut self, place: Place, colour: &str) {
        let (cx, cy) = self.at(place);
        self.scene.add(Primitive::Circle {
            cx,
            cy,
            r: 5.0,
            fill: Color::from("#ffffff"),
            fill_opacity: None,
            stroke: Some(Color::from(colour)),
            stroke_width: Some(2.0),
        });
    }

    /// A label beside a place, so many px to the right and upwards.
    pub(super) fn label(
        &mut self,
        place: Place,
        (right, up): (f64, f64),
        content: &str,
        colour: &str,
    ) {
        let (x, y) = self.at(place);
        text(&mut self.scene, (x + right, y - up), content, 14, colour);
    }

    /// The drawing as SVG text.
    pub(super) fn render(self) -> String {
        SvgBackend::new().render_scene(&self.scene)
    }
}
