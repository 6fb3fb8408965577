//! The plan view: the mount circle with its motors from above, axis numbers, the axes of tilt, and each crank's sense of rotation.

use core::f64::consts::TAU;

use kuva::render::render::TextAnchor;

use super::{Mount, mm};
use crate::drawing::{Drawing, FIRST, Place, SECOND};
use crate::style::{INK, MUTED};

/// Crank radius in the drawing, relative to the mount radius.
const CRANK: f64 = 0.2;
/// Extent of a motor along the radius, and half its width, relative to the mount radius.
const MOTOR: ((f64, f64), f64) = ((0.56, 0.88), 0.11);

/// Colour of a crank, by whether it turns forward or is reversed.
pub fn colour(is_reversed: bool) -> &'static str {
    if is_reversed { SECOND } else { FIRST }
}

/// Kind of mechanism on the mount circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A motor whose shaft lies along the radius, with a crank.
    Crank,
    /// A mechanism with an upright shaft.
    Upright,
}

/// Draws the plan view around the origin, in units of the mount radius.
pub fn draw(drawing: &mut Drawing, mount: &Mount, unit: Unit) {
    drawing.label_at(
        [0.0, 1.62],
        (0.0, 0.0),
        "view from above",
        INK,
        TextAnchor::Middle,
    );
    drawing.arc([0.0, 0.0], 1.0, (0.0, TAU), MUTED);
    axes(drawing);
    for axis in 0..mount.axes() {
        match unit {
            Unit::Crank => motor(drawing, mount, axis),
            Unit::Upright => upright(drawing, mount, axis),
        }
        number(drawing, mount, axis);
    }
    radius(drawing, mount);
    notes(drawing, mount, unit);
}

/// Point at a distance along the radius of an axis and across it.
fn place(angle_rad: f64, along: f64, across: f64) -> Place {
    let (sin, cos) = angle_rad.sin_cos();
    [along * cos - across * sin, along * sin + across * cos]
}

/// Draws the x and y axes, and the sense of positive tilts.
fn axes(drawing: &mut Drawing) {
    drawing.arrow([0.0, 0.0], [1.48, 0.0], INK);
    drawing.label([1.48, 0.0], (5.0, -5.0), "x", INK);
    drawing.arrow([0.0, 0.0], [0.0, 1.4], INK);
    drawing.label([0.0, 1.4], (8.0, -4.0), "y", INK);
}

fn motor(drawing: &mut Drawing, mount: &Mount, axis: usize) {
    let angle = mount.angle_rad(axis);
    let is_reversed = mount.reversed[axis];
    let colour = colour(is_reversed);
    let at = |along, across| place(angle, along, across);
    let ((inner, outer), half) = MOTOR;
    let body = [
        at(inner, -half),
        at(outer, -half),
        at(outer, half),
        at(inner, half),
    ];
    drawing.face(&body, "#E8EAEE", MUTED, 1.2);
    drawing.line(&[at(outer, 0.0), at(1.0, 0.0)], INK, 3.0, false);
    drawing.line(&[at(1.0, -CRANK), at(1.0, CRANK)], colour, 5.0, false);
    // The pin of a forward crank moves from x towards y while the crank points to the platform.
    let sign = if is_reversed { -1.0 } else { 1.0 };
    let over = 1.1;
    drawing.arrow(
        at(over, -sign * 0.9 * CRANK),
        at(over, sign * 1.1 * CRANK),
        colour,
    );
}

/// Draws an upright shaft and its sense of rotation.
fn upright(drawing: &mut Drawing, mount: &Mount, axis: usize) {
    const PIECES: u32 = 40;
    let is_reversed = mount.reversed[axis];
    let [x, y] = place(mount.angle_rad(axis), 1.0, 0.0);
    let around = |radius: f64, part: f64| {
        let angle = TAU * part;
        [x + radius * angle.cos(), y + radius * angle.sin()]
    };
    let body: Vec<Place> = (0..PIECES)
        .map(|i| around(0.1, f64::from(i) / f64::from(PIECES)))
        .collect();
    drawing.face(&body, "#E8EAEE", MUTED, 1.2);
    let turn = |i: u32| 0.1 + 0.7 * f64::from(i) / f64::from(PIECES);
    let mut arrow: Vec<Place> = (0..=PIECES).map(|i| around(0.17, turn(i))).collect();
    if is_reversed {
        arrow.reverse();
    }
    drawing.path_arrow(&arrow, colour(is_reversed));
}

/// Draws the number of an axis, beside the coordinate axis that it may lie on.
fn number(drawing: &mut Drawing, mount: &Mount, axis: usize) {
    drawing.label_at(
        place(mount.angle_rad(axis) + 0.17, 1.27, 0.0),
        (0.0, -6.0),
        &axis.to_string(),
        colour(mount.reversed[axis]),
        TextAnchor::Middle,
    );
}

/// Draws the mount radius, between two axes.
fn radius(drawing: &mut Drawing, mount: &Mount) {
    let between = TAU / mount.axes() as f64;
    // Chooses the gap between axes that is nearest to the lower left.
    let gaps = (0..mount.axes()).map(|axis| (axis as f64 + 0.5) * between);
    let lower_left = 0.625 * TAU;
    let angle = gaps
        .min_by(|a, b| {
            let off = |angle: &f64| (angle - lower_left).abs();
            off(a).total_cmp(&off(b))
        })
        .unwrap_or(lower_left);
    drawing.arrow([0.0, 0.0], place(angle, 1.0, 0.0), MUTED);
}

/// Draws the legend of arrows and signs.
fn notes(drawing: &mut Drawing, mount: &Mount, unit: Unit) {
    let left = -1.42;
    let mut y = -1.6;
    let mut note = |text: &str, colour: Option<&str>| {
        if let Some(colour) = colour {
            drawing.arrow([left, y + 0.045], [left + 0.26, y + 0.045], colour);
        }
        let right = if colour.is_some() { 0.36 } else { 0.0 };
        drawing.label([left + right, y], (0.0, 0.0), text, INK);
        y -= 0.21;
    };
    let turning = match unit {
        Unit::Crank => "direction of the pin at α = 0",
        Unit::Upright => "direction of rotation",
    };
    note(turning, Some(FIRST));
    if mount.reversed.contains(&true) {
        note("the same of a reversed axis", Some(SECOND));
    }
    note(&format!("mount radius {}", mm(mount.radius_m)), Some(MUTED));
    note("tilt x > 0: the side of axis 0 is high", None);
    if mount.axes() > 2 {
        note("tilt y > 0: the +y side is high", None);
    }
}
