//! Symbols of the perspective view: those of one crank, the height of the platform, and the direction of amax.

use core::f64::consts::TAU;

use kuva::render::render::TextAnchor;

use super::cranks::{ALPHA_RAD, Cranks, Link, PLATE};
use super::plan::colour;
use crate::drawing::{Drawing, Place};
use crate::style::{INK, MUTED};

impl Cranks<'_> {
    /// Draws the symbols of one crank: its angle, radius and rod.
    pub(super) fn symbols(&self, drawing: &mut Drawing, axis: usize) {
        let colour = colour(self.mount.reversed[axis]);
        let at = |alpha, distance| self.eye.project(self.around(axis, alpha, distance));
        let shaft = at(0.0, 0.0);
        drawing.line(&[shaft, at(0.0, 1.5 * self.r)], MUTED, 1.2, true);
        let angle = match self.link {
            Link::Rod(_) => 0.62,
            Link::Slot => 0.42,
        };
        drawing.line(
            &self.arc(axis, (0.0, ALPHA_RAD), angle * self.r),
            colour,
            1.5,
            false,
        );
        // On the sheet the crank leans to one side, and its rod to the other.
        let outward = if at(ALPHA_RAD, 1.0)[0] > shaft[0] {
            1.0
        } else {
            -1.0
        };
        let middle = |a: Place, b: Place| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        // A slot occupies the place of the text, and a small crank has no room for it.
        let (alpha, moved) = match self.link {
            Link::Slot => (at(0.0, 0.3 * self.r), (-outward * 9.0, -2.0)),
            Link::Rod(_) if self.r > 0.18 => (at(0.45 * ALPHA_RAD, 0.62 * self.r), (0.0, 5.0)),
            Link::Rod(_) => (at(-0.4, 1.8 * self.r), (0.0, -5.0)),
        };
        drawing.label_at(alpha, moved, "α", colour, TextAnchor::Middle);
        let turning = at(ALPHA_RAD + 1.2, 1.32 * self.r + 0.09);
        drawing.label_at(turning, (0.0, -5.0), "ω", colour, TextAnchor::Middle);
        let pin = at(ALPHA_RAD, self.r);
        drawing.label_at(
            middle(shaft, pin),
            (outward * 7.0, -15.0),
            "R",
            colour,
            if outward > 0.0 {
                TextAnchor::Start
            } else {
                TextAnchor::End
            },
        );
        let name = match self.link {
            Link::Rod(_) => "L = R/λ",
            Link::Slot => "slot",
        };
        let of = match self.link {
            Link::Rod(_) => middle(pin, self.eye.project(self.corner(axis))),
            Link::Slot => {
                let z = self.up * self.r * ALPHA_RAD.cos();
                let [x, y, _] = self.around(axis, 0.25 * TAU, 1.3 * self.r);
                self.eye.project([x, y, z])
            }
        };
        let beside = match self.link {
            Link::Rod(_) => -outward,
            Link::Slot => outward,
        };
        drawing.label_on(of, (beside * 9.0, -2.0), name, colour, beside > 0.0);
    }

    /// Draws the height z of the platform above the crank axes, negative below them. x and y are those of the view from above.
    pub(super) fn distance(&self, drawing: &mut Drawing) {
        let (left, platform) = (-1.34, self.eye.height(self.corner));
        for (from, y) in [(-1.0, 0.0), (-PLATE.0, platform)] {
            drawing.line(&[[left - 0.05, y], [from, y]], MUTED, 1.0, true);
        }
        drawing.arrow([left, 0.0], [left, platform], INK);
        drawing.label_at(
            [left, 0.5 * platform],
            (-8.0, -4.0),
            if self.mount.is_below { "−z" } else { "z" },
            INK,
            TextAnchor::End,
        );
    }

    /// Draws the direction in which amax acts.
    pub(super) fn amax(&self, drawing: &mut Drawing) {
        let (right, platform) = (1.3, self.eye.height(self.corner));
        let from = platform + self.up * 0.03;
        drawing.arrow([right, from], [right, from - self.up * 0.42], INK);
        drawing.label_at(
            [right, from - self.up * 0.42],
            (0.0, if self.mount.is_below { 22.0 } else { -18.0 }),
            "amax",
            INK,
            TextAnchor::Middle,
        );
        drawing.label_at(
            [right, from - self.up * 0.42],
            (0.0, if self.mount.is_below { 6.0 } else { -34.0 }),
            "at α = 0",
            MUTED,
            TextAnchor::Middle,
        );
    }
}
