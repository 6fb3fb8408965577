//! Drawing of a mechanism to scale: lines, pins and labels in the mechanism's own unit, with y upwards.
//!
//! A *view* is a part of the sheet with a scale of its own. A drawing has one that fills the sheet, or several side by side.

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};

use crate::style::{INK, MUTED, svg, text, text_anchored};

/// Width of the sheet, px.
pub const WIDTH: f64 = 900.0;
/// Space around the mechanism, px. The title is in the upper one.
const MARGIN: f64 = 70.0;

/// Width of a spring to either side, and length of an arrow's head, px.
const SPRING_PX: f64 = 8.0;
const ARROW_PX: f64 = 12.0;

/// Colours of a first and a second position.
pub const FIRST: &str = "#0072B2";
pub const SECOND: &str = "#009E73";

/// A place, in the mechanism's unit.
pub type Place = [f64; 2];

/// A part of the sheet with a scale of its own.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Pixels to the mechanism's unit.
    pub scale: f64,
    /// A place of the mechanism.
    pub of: Place,
    /// Position of that place on the sheet, px from its upper left corner.
    pub at: (f64, f64),
}

/// Drawing under construction.
pub struct Drawing {
    scene: Scene,
    view: View,
}

impl Drawing {
    /// Creates a drawing for a mechanism between two corners.
    pub fn new(title: &str, low: Place, high: Place) -> Self {
        let scale = (WIDTH - 2.0 * MARGIN) / (high[0] - low[0]);
        let height = scale * (high[1] - low[1]) + 2.0 * MARGIN;
        let mut drawing = Self::sheet(height);
        drawing.set_view(View {
            scale,
            of: low,
            at: (MARGIN, height - MARGIN),
        });
        text(&mut drawing.scene, (MARGIN, 36.0), title, 22, INK);
        drawing
    }

    /// Creates an empty sheet of a height, px. Its view has one pixel per unit, from the upper left corner.
    pub fn sheet(height: f64) -> Self {
        let mut scene = Scene::new(WIDTH, height);
        scene.font_family = Some("sans-serif".to_owned());
        scene.background_color = Some("#ffffff".to_owned());
        let view = View {
            scale: 1.0,
            of: [0.0, 0.0],
            at: (0.0, 0.0),
        };
        Self { scene, view }
    }

    /// Sets the view for the following calls.
    pub fn set_view(&mut self, view: View) {
        self.view = view;
    }

    /// Draws a heading at a place of the sheet, px, with a line of text below it.
    pub fn heading(&mut self, (x, y): (f64, f64), title: &str, subtitle: &str) {
        text(&mut self.scene, (x, y), title, 22, INK);
        text(&mut self.scene, (x, y + 22.0), subtitle, 14, MUTED);
    }

    fn at(&self, place: Place) -> (f64, f64) {
        let View { scale, of, at } = self.view;
        (
            at.0 + scale * (place[0] - of[0]),
            at.1 - scale * (place[1] - of[1]),
        )
    }

    /// Draws a polyline, dashed if it is not a part of the machine.
    pub fn line(&mut self, places: &[Place], colour: &str, width: f64, is_dashed: bool) {
        let points = places.iter().map(|&place| self.at(place)).collect();
        self.scene.add(Primitive::PolyLine {
            points,
            stroke: Color::from(colour),
            stroke_width: width,
            stroke_dasharray: is_dashed.then(|| "6 5".to_owned()),
        });
    }

    /// Draws an arc around a centre, from one angle to another, rad.
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

    /// Draws a joint.
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

    /// Draws a closed outline.
    pub fn outline(&mut self, places: &[Place], colour: &str, width: f64) {
        let mut closed = places.to_vec();
        closed.extend(places.first());
        self.line(&closed, colour, width, false);
    }

    /// Draws a closed outline with a fill that hides what is behind it.
    pub fn face(&mut self, places: &[Place], fill: &str, colour: &str, width: f64) {
        let mut d = String::new();
        for (i, &place) in places.iter().enumerate() {
            let (x, y) = self.at(place);
            let command = if i == 0 { 'M' } else { 'L' };
            d += &format!("{command}{x:.2} {y:.2} ");
        }
        d.push('Z');
        self.scene.add(Primitive::Path(Box::new(PathData {
            d,
            fill: Some(Color::from(fill)),
            stroke: Color::from(colour),
            stroke_width: width,
            opacity: None,
            stroke_dasharray: None,
        })));
    }

    /// Draws a rectangle between two corners.
    pub fn rectangle(&mut self, low: Place, high: Place, colour: &str) {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        self.outline(&corners, colour, 2.0);
    }

    /// Draws a spring between two places, `SPRING_PX` to either side.
    pub fn spring(&mut self, from: Place, to: Place, colour: &str) {
        const TURNS: u32 = 6;
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        let side = SPRING_PX / self.view.scale / length;
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

    /// Draws an arrow to a place.
    pub fn arrow(&mut self, from: Place, to: Place, colour: &str) {
        self.path_arrow(&[from, to], colour);
    }

    /// Draws an arrow along a polyline of two places or more.
    pub fn path_arrow(&mut self, places: &[Place], colour: &str) {
        let [.., from, to] = *places else {
            return;
        };
        self.line(places, colour, 2.0, false);
        let angle = (to[1] - from[1]).atan2(to[0] - from[0]);
        let head = ARROW_PX / self.view.scale;
        let barb = |turn: f64| {
            let angle = angle + turn;
            [to[0] - head * angle.cos(), to[1] - head * angle.sin()]
        };
        self.line(&[barb(0.4), to, barb(-0.4)], colour, 2.0, false);
    }

    /// Draws the ground: a line with strokes below it.
    pub fn ground(&mut self, from: Place, to: Place) {
        self.line(&[from, to], INK, 1.5, false);
        let stroke = ARROW_PX / self.view.scale;
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

    /// Draws a label beside a place, at a distance in px to the right and upwards.
    pub fn label(&mut self, place: Place, (right, up): (f64, f64), content: &str, colour: &str) {
        let (x, y) = self.at(place);
        text(&mut self.scene, (x + right, y - up), content, 14, colour);
    }

    /// Draws a label as [`label`](Self::label) does, anchored by its start, middle or end.
    pub fn label_at(
        &mut self,
        place: Place,
        (right, up): (f64, f64),
        content: &str,
        colour: &str,
        anchor: TextAnchor,
    ) {
        let (x, y) = self.at(place);
        let place = (x + right, y - up);
        text_anchored(&mut self.scene, place, content, 14, colour, anchor);
    }

    /// Draws a label as [`label_at`](Self::label_at) does, on a white background for places where lines pass behind it.
    pub fn label_on(
        &mut self,
        place: Place,
        (right, up): (f64, f64),
        content: &str,
        colour: &str,
        is_to_the_right: bool,
    ) {
        let (x, y) = self.at(place);
        // Approximate width of the text. The viewer's font is not known here.
        let width = 8.2 * content.chars().count() as f64;
        self.scene.add(Primitive::Rect {
            x: x + right - if is_to_the_right { 2.0 } else { width },
            y: y - up - 13.0,
            width: width + 2.0,
            height: 17.0,
            fill: Color::from("#ffffff"),
            stroke: None,
            stroke_width: None,
            opacity: Some(0.8),
        });
        let anchor = if is_to_the_right {
            TextAnchor::Start
        } else {
            TextAnchor::End
        };
        self.label_at(place, (right, up), content, colour, anchor);
    }

    /// Returns the drawing as SVG text.
    pub fn render(self) -> String {
        svg(&self.scene)
    }
}
