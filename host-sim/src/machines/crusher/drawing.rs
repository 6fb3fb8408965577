//! Drawing of a jaw crusher with its symbols.

use core::f64::consts::TAU;

use super::Crusher;
use crate::drawing::{Drawing, FIRST, Place, SECOND};
use crate::style::{INK, MUTED};

/// Angle of the eccentric in the drawing, rad.
const PHI_RAD: f64 = 0.9;

/// Draws the crusher, as SVG text. The line from the shaft to the toggle's pivot points downwards.
pub fn draw(crusher: &Crusher) -> String {
    let linkage = &crusher.linkage;
    let angles = linkage.at(PHI_RAD);
    // The linkage has the fixed pivot on its x axis. A quarter turn moves it below the shaft.
    let down = |[x, y]: Place| -> Place { [y, -x] };
    let from = |start: Place, length: f64, angle: f64| -> Place {
        [
            start[0] + length * angle.cos(),
            start[1] + length * angle.sin(),
        ]
    };
    let origin = [0.0, 0.0];
    let pin = from(origin, linkage.eccentric_m, PHI_RAD);
    let force = from(pin, linkage.force_m, angles.jaw_rad);
    let joint = from(pin, linkage.jaw_m, angles.jaw_rad);
    let pivot = [linkage.ground_m, 0.0];
    let places = [origin, pin, force, joint, pivot].map(down);
    let [origin, pin, force, joint, pivot] = places;
    let title = format!(
        "Jaw crusher: e = {:.1} mm, l = {:.0}, r = {:.0}, g = {:.0} mm",
        1e3 * linkage.eccentric_m,
        1e3 * linkage.jaw_m,
        1e3 * linkage.toggle_m,
        1e3 * linkage.ground_m
    );
    let (reach, wheel) = (linkage.jaw_m, 0.22 * linkage.jaw_m);
    let mut drawing = Drawing::new(
        &title,
        [-0.9 * reach, -1.12 * reach],
        [0.9 * reach, 1.1 * wheel],
    );
    drawing.arc(origin, wheel, (0.0, TAU), MUTED);
    drawing.label([wheel, 0.0], (8.0, 0.0), "flywheel, inertia JF", MUTED);
    drawing.line(&[pin, joint], FIRST, 5.0, false);
    drawing.line(&[joint, pivot], SECOND, 3.0, false);
    drawing.line(&[origin, pivot], MUTED, 1.0, true);
    let middle = |a: Place, b: Place| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    drawing.label(middle(joint, pivot), (0.0, -22.0), "r", SECOND);
    drawing.label(middle(origin, pivot), (8.0, 0.0), "g", MUTED);
    drawing.label(middle(pin, joint), (-30.0, 0.0), "l", FIRST);
    let rock = 0.25 * reach * if joint[0] < pivot[0] { -1.0 } else { 1.0 };
    drawing.arrow([force[0] + rock, force[1]], force, INK);
    drawing.label([force[0] + rock, force[1]], (0.0, 12.0), "rock F", INK);
    for (place, name, right) in [
        (origin, "shaft with eccentric e", -180.0),
        (joint, "", 10.0),
        (pivot, "toggle's pivot", -120.0),
    ] {
        drawing.pin(place, INK);
        drawing.label(place, (right, 0.0), name, INK);
    }
    drawing.render()
}
