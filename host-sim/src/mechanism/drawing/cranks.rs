//! Perspective view of cranks under a platform: slider-cranks or Scotch yokes, with their symbols.
//!
//! Lengths are relative to the mount radius. Cranks and links are enlarged in the drawing for visibility, in their true ratio.

use core::f64::consts::TAU;

use kuva::render::render::TextAnchor;

use super::perspective::{Eye, Place3, cylinder, prism};
use super::plan::{Unit, colour};
use super::{Mount, beside_plan, mm};
use crate::drawing::{Drawing, Place, View};
use crate::mechanism::Mechanism;
use crate::style::{INK, MUTED};

/// Angle of the cranks in the drawing, from the dead centre at which the platform is farthest, rad.
pub(super) const ALPHA_RAD: f64 = 0.9;
/// Mount radius on the sheet, px, if there is room for it.
const SCALE: f64 = 172.0;
/// Space for texts above and below the machine, px. The name of the platform is on the platform's side.
const TEXTS: (f64, f64) = (32.0, 34.0);
const TEXTS_BELOW: (f64, f64) = (20.0, 52.0);
/// Radius and thickness of the platform.
pub(super) const PLATE: (f64, f64) = (1.13, 0.07);
/// Radius and height of the load on the platform.
const LOAD: (f64, f64) = (0.42, 0.22);
/// Distance of a slot from the platform, in crank radii.
const SLOT: f64 = 1.2;
const STEEL: &str = "#E8EAEE";
const PALE: &str = "#F6F7F9";

/// Part between the crank's pin and the platform.
#[derive(Clone, Copy, Debug)]
pub enum Link {
    /// A rod of a length, m.
    Rod(f64),
    /// A slot across the line of travel.
    Slot,
}

/// Geometry of the drawing: lengths relative to the mount radius, z upwards from the crank axes.
pub(super) struct Cranks<'a> {
    pub(super) mount: &'a Mount,
    pub(super) eye: Eye,
    pub(super) link: Link,
    /// Crank radius in the drawing.
    pub(super) r: f64,
    /// +1 for a platform above, −1 for one below.
    pub(super) up: f64,
    /// Height of the corners of the platform.
    pub(super) corner: f64,
}

/// Draws the machine: the perspective view, and the plan view beside it.
pub fn cranks(mechanism: &impl Mechanism, link: Link, mount: &Mount) -> String {
    let radius_m = mechanism.crank_radius_m();
    let rod = match link {
        Link::Rod(length_m) => length_m / radius_m,
        Link::Slot => SLOT,
    };
    let r = (1.75 / (2.0 + rod)).min(0.23);
    let (sin, cos) = ALPHA_RAD.sin_cos();
    let reach = match link {
        Link::Rod(_) => cos + (rod * rod - sin * sin).sqrt(),
        Link::Slot => cos + SLOT,
    };
    let up = if mount.is_below { -1.0 } else { 1.0 };
    let cranks = Cranks {
        mount,
        eye: Eye::for_axes(mount.axes()),
        link,
        r,
        up,
        corner: up * r * reach,
    };
    let (links, sizes) = match link {
        Link::Rod(length_m) => (
            "slider-cranks",
            format!(
                "crank radius R = {}, rod length L = R/λ = {}",
                mm(radius_m),
                mm(length_m)
            ),
        ),
        Link::Slot => ("Scotch yokes", format!("crank radius R = {}", mm(radius_m))),
    };
    beside_plan(
        mount,
        Unit::Crank,
        (links, &sizes),
        |drawing, [low, high]| {
            cranks.draw(drawing, [low, high]);
        },
    )
}

impl Cranks<'_> {
    fn draw(&self, drawing: &mut Drawing, [low, high]: [(f64, f64); 2]) {
        let (top, bottom) = self.extent();
        let (above, below) = if self.mount.is_below {
            TEXTS_BELOW
        } else {
            TEXTS
        };
        let room = high.1 - low.1 - above - below;
        drawing.set_view(View {
            scale: SCALE.min(room / (top - bottom)),
            of: [0.0, 0.5 * (top + bottom)],
            at: (
                0.5 * (low.0 + high.0),
                0.5 * (low.1 + above + high.1 - below),
            ),
        });
        let axes = self.by_distance();
        if self.mount.is_below {
            self.platform(drawing);
            drawing.line(&self.eye.circle(1.12, self.base_z()), MUTED, 1.0, false);
        } else {
            self.base(drawing);
        }
        drawing.line(&self.eye.circle(1.0, 0.0), MUTED, 1.0, true);
        for &axis in &axes {
            self.axis(drawing, axis);
        }
        if !self.mount.is_below {
            self.platform(drawing);
        }
        for &axis in &axes {
            self.number(drawing, axis);
        }
        if let Some(&nearest) = axes.last() {
            self.symbols(drawing, nearest);
        }
        self.distance(drawing);
        self.amax(drawing);
        drawing.set_view(View {
            scale: 1.0,
            of: [0.0, 0.0],
            at: (low.0, high.1),
        });
        let note = "cranks and rods are drawn at a larger scale";
        drawing.label([0.0, 0.0], (0.0, 0.0), note, MUTED);
    }

    /// Height of the base that the motors stand on or hang from.
    fn base_z(&self) -> f64 {
        -self.up * (self.r + 0.14)
    }

    /// Highest and lowest point on the sheet.
    fn extent(&self) -> (f64, f64) {
        let plate = self.eye.circle(PLATE.0, self.corner);
        let base = self.eye.circle(1.0, self.base_z());
        let all = plate.iter().chain(&base).map(|place| place[1]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
            (low.min(y), high.max(y))
        });
        (high, low)
    }

    /// Axes in order of distance from the eye, the farthest first.
    fn by_distance(&self) -> Vec<usize> {
        let mut axes: Vec<usize> = (0..self.mount.axes()).collect();
        let near = |axis: &usize| self.eye.nearness(self.mount.angle_rad(*axis));
        axes.sort_by(|a, b| near(a).total_cmp(&near(b)));
        axes
    }

    fn base(&self, drawing: &mut Drawing) {
        drawing.face(&self.eye.circle(1.12, self.base_z()), PALE, MUTED, 1.0);
    }

    fn platform(&self, drawing: &mut Drawing) {
        let (low, high) = if self.mount.is_below {
            (self.corner - PLATE.1, self.corner)
        } else {
            (self.corner, self.corner + PLATE.1)
        };
        cylinder(drawing, self.eye, PLATE.0, (low, high), STEEL, INK);
        if !self.mount.is_below {
            cylinder(
                drawing,
                self.eye,
                LOAD.0,
                (high, high + LOAD.1),
                PALE,
                MUTED,
            );
            drawing.label_at(
                self.eye.project([0.0, 0.0, high + LOAD.1]),
                (0.0, -5.0),
                "m",
                INK,
                TextAnchor::Middle,
            );
        }
        let middle = self.eye.project([0.0, 0.0, high])[1];
        let above = if self.mount.is_below {
            -0.36 * PLATE.0 - PLATE.1 - 0.13
        } else {
            0.36 * PLATE.0 + 0.1
        };
        drawing.label_at(
            [0.0, middle + above],
            (0.0, 0.0),
            "platform with its load, mass m",
            INK,
            TextAnchor::Middle,
        );
    }

    /// Point in the plane of a crank, at a crank angle and a distance from its shaft.
    pub(super) fn around(&self, axis: usize, alpha_rad: f64, distance: f64) -> Place3 {
        let sense = if self.mount.reversed[axis] { -1.0 } else { 1.0 };
        let across = sense * distance * alpha_rad.sin();
        let (sin, cos) = self.mount.angle_rad(axis).sin_cos();
        [
            cos - across * sin,
            sin + across * cos,
            self.up * distance * alpha_rad.cos(),
        ]
    }

    pub(super) fn arc(&self, axis: usize, (from, to): (f64, f64), distance: f64) -> Vec<Place> {
        const PIECES: u32 = 40;
        (0..=PIECES)
            .map(|i| from + (to - from) * f64::from(i) / f64::from(PIECES))
            .map(|alpha| self.eye.project(self.around(axis, alpha, distance)))
            .collect()
    }

    pub(super) fn corner(&self, axis: usize) -> Place3 {
        let [x, y, _] = self.around(axis, 0.0, 0.0);
        [x, y, self.corner]
    }

    fn axis(&self, drawing: &mut Drawing, axis: usize) {
        let angle = self.mount.angle_rad(axis);
        let colour = colour(self.mount.reversed[axis]);
        let shaft = self.eye.project(self.around(axis, 0.0, 0.0));
        let motor = |drawing: &mut Drawing| {
            let base = self.base_z();
            let post = (base.min(0.0), base.max(0.0));
            prism(
                drawing,
                self.eye,
                angle,
                [(0.62, 0.78), (-0.05, 0.05), post],
                PALE,
                MUTED,
            );
            let body = [(0.54, 0.88), (-0.1, 0.1), (-0.1, 0.1)];
            prism(drawing, self.eye, angle, body, STEEL, MUTED);
        };
        let crank = |drawing: &mut Drawing| {
            let disc = self.arc(axis, (0.0, TAU), self.r);
            drawing.face(&disc, "#ffffff", colour, 1.0);
            let pin = self.eye.project(self.around(axis, ALPHA_RAD, self.r));
            let corner = self.eye.project(self.corner(axis));
            drawing.line(&[shaft, pin], colour, 4.0, false);
            match self.link {
                Link::Rod(_) => drawing.line(&[pin, corner], colour, 3.0, false),
                Link::Slot => self.slot(drawing, axis, colour),
            }
            drawing.pin(corner, colour);
            drawing.pin(pin, colour);
            drawing.pin(shaft, INK);
            let turning = (ALPHA_RAD + 0.75, ALPHA_RAD + 2.5);
            drawing.path_arrow(&self.arc(axis, turning, 1.32 * self.r), colour);
        };
        // The motor is inside the circle, so it is behind its crank if the axis is near the eye.
        if self.eye.nearness(angle) > 0.0 {
            motor(drawing);
            crank(drawing);
        } else {
            crank(drawing);
            motor(drawing);
        }
    }

    fn number(&self, drawing: &mut Drawing, axis: usize) {
        let place = self.around(axis, 0.5 * TAU, 1.32 * self.r + 0.12);
        drawing.label_at(
            self.eye.project(place),
            (0.0, -5.0),
            &axis.to_string(),
            colour(self.mount.reversed[axis]),
            TextAnchor::Middle,
        );
    }

    fn slot(&self, drawing: &mut Drawing, axis: usize, colour: &str) {
        let [x, y, _] = self.around(axis, 0.0, 0.0);
        let (sin, cos) = self.mount.angle_rad(axis).sin_cos();
        let z = self.up * self.r * ALPHA_RAD.cos();
        let (half, thick) = (1.25 * self.r, 0.12 * self.r);
        let at = |across: f64, z: f64| self.eye.project([x - across * sin, y + across * cos, z]);
        let frame = [
            at(-half, z - thick),
            at(half, z - thick),
            at(half, z + thick),
            at(-half, z + thick),
        ];
        drawing.outline(&frame, colour, 2.0);
        drawing.line(
            &[
                at(0.0, z + self.up * thick),
                self.eye.project(self.corner(axis)),
            ],
            colour,
            3.0,
            false,
        );
    }
}
