//! Drawing of a mechanism to scale: lines, pins and labels in the mechanism's own unit, with y upwards.

use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};

use crate::ink::{INK, MUTED, text};

const WIDTH: f64 = 900.0;
/// Space around the mechanism, px; the title stands in the upper one.
const MARGIN: f64 = 70.0;

/// Width of a spring to either side, and length of an arrow's head, px.
const SPRING_PX: f64 = 8.0;
const ARROW_PX: f64 = 12.0;

/// Colours of a first and a second position.
pub const FIRST: &str = "#0072B2";
pub const SECOND: &str = "#009E73";

/// A place, in the mechanism's unit.
pub type Place = [f64; 2];

/// A drawing that is being made.
pub struct Drawing {
    scene: Scene,
    scale: f64,
    /// Lower left corner of what is drawn.
    low: Place,
    height: f64,
}

impl Drawing {
    /// For a mechanism between two corners.
    pub fn new(title: &str, low: Place, high: Place) -> Self {
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
    pub fn line(&mut self, places: &[Place], colour: &str, width: f64, is_dashed: bool) {
        let points = places.iter().map(|&place| self.at(place)).collect();
        self.scene.add(Primitive::PolyLine {
            points,
            stroke: Color::from(colour),
            stroke_width: width,
            stroke_dasharray: is_dashed.then(|| "6 5".to_owned()),
        });
    }

    /// An arc around a centre, from one angle to another, rad.
    pub fn arc(&mut self, centre: Place, radius: f64, (from, to): (f64, f64), colour: &str) {
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
    pub fn pin(&mut self, place: Place, colour: &str) {
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

    /// A closed outline.
    pub fn outline(&mut self, places: &[Place], colour: &str, width: f64) {
        let mut closed = places.to_vec();
        closed.extend(places.first());
        self.line(&closed, colour, width, false);
    }

    /// A rectangle between two corners.
    pub fn rectangle(&mut self, low: Place, high: Place, colour: &str) {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        self.outline(&corners, colour, 2.0);
    }

    /// A spring between two places, in so many px to either side.
    pub fn spring(&mut self, from: Place, to: Place, colour: &str) {
        const TURNS: u32 = 6;
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        let side = SPRING_PX / self.scale / length;
        let mut places = vec![from];
        for i in 0..2 * TURNS {
            let part = (f64::from(i) + 1.0) / f64::from(2 * TURNS + 1);
            let out = if i % 2 == 0 { side } else { -side };
            places.push([
                from[0] + part * along[0] - out * along[1],
                from[1] + part * along[1] + out * along[0],
            ]);
        }
        places.push(to);
        self.line(&places, colour, 1.5, false);
    }

    /// An arrow to a place.
    pub fn arrow(&mut self, from: Place, to: Place, colour: &str) {
        self.line(&[from, to], colour, 2.0, false);
        let angle = (to[1] - from[1]).atan2(to[0] - from[0]);
        let head = ARROW_PX / self.scale;
        let barb = |turn: f64| {
            let angle = angle + turn;
            [to[0] - head * angle.cos(), to[1] - head * angle.sin()]
        };
        self.line(&[barb(0.4), to, barb(-0.4)], colour, 2.0, false);
    }

    /// The ground: a line with strokes below it, px.
    pub fn ground(&mut self, from: Place, to: Place) {
        self.line(&[from, to], INK, 1.5, false);
        let stroke = ARROW_PX / self.scale;
        let count = ((to[0] - from[0]) / stroke).floor().max(1.0) as u32;
        for i in 1..=count {
            let x = from[0] + (to[0] - from[0]) * f64::from(i) / f64::from(count);
            self.line(
                &[[x, from[1]], [x - 0.7 * stroke, from[1] - 0.7 * stroke]],
                MUTED,
                1.0,
                false,
            );
        }
    }

    /// A label beside a place, so many px to the right and upwards.
    pub fn label(&mut self, place: Place, (right, up): (f64, f64), content: &str, colour: &str) {
        let (x, y) = self.at(place);
        text(&mut self.scene, (x + right, y - up), content, 14, colour);
    }

    /// The drawing as SVG text.
    pub fn render(self) -> String {
        SvgBackend::new().render_scene(&self.scene)
    }
}
