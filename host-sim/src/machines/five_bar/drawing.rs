//! Drawing of a five-bar arm with its symbols.

use super::Arm;
use crate::drawing::{Drawing, FIRST, Place, SECOND};
use crate::style::{INK, MUTED};

/// Draws the arm with its hand a quarter along the path, as SVG text.
pub fn draw(arm: &Arm) -> String {
    let [one, two, _, four] = arm.arm.rods.map(|rod| rod.length_m);
    let hand = arm.path.at(0.25).at_m;
    let [q1, q2] = arm.quarter_rad;
    let from = |start: Place, length: f64, angle: f64| -> Place {
        [
            start[0] + length * angle.cos(),
            start[1] + length * angle.sin(),
        ]
    };
    let origin = [0.0, 0.0];
    let elbow = from(origin, one, q1);
    let second = from(origin, two, q2);
    let joint = from(elbow, two, q2);
    let max = one + four;
    let ends = [0.0, 0.5].map(|part| arm.path.at(part).at_m);
    let points = [origin, elbow, second, joint, hand, ends[0], ends[1]];
    let fold = |axis: usize, of: fn(f64, f64) -> f64, start: f64| {
        points.iter().map(|point| point[axis]).fold(start, of)
    };
    let low = [
        fold(0, f64::min, 0.0) - 0.12 * max,
        fold(1, f64::min, 0.0) - 0.06 * max,
    ];
    let high = [
        fold(0, f64::max, 0.0) + 0.3 * max,
        fold(1, f64::max, 0.0) + 0.12 * max,
    ];
    let title = format!(
        "Five-bar arm: l1 = {:.0}, l2 = {:.0}, l4 = {:.0} mm",
        1e3 * one,
        1e3 * two,
        1e3 * four
    );
    let mut drawing = Drawing::new(&title, low, high);
    drawing.arrow([low[0], 0.0], [high[0], 0.0], MUTED);
    drawing.label([high[0], 0.0], (-14.0, -18.0), "x", MUTED);
    drawing.arrow([0.0, low[1]], [0.0, high[1]], MUTED);
    drawing.label([0.0, high[1]], (8.0, -14.0), "y", MUTED);
    drawing.line(&[ends[0], ends[1]], INK, 1.5, true);
    drawing.label(ends[1], (10.0, 4.0), "path", INK);
    drawing.arc(origin, 0.18 * max, (0.0, q1), FIRST);
    drawing.arc(origin, 0.1 * max, (0.0, q2), SECOND);
    drawing.label(from(origin, 0.18 * max, 0.7 * q1), (6.0, 6.0), "q1", FIRST);
    drawing.label(from(origin, 0.1 * max, 0.0), (-4.0, -18.0), "q2", SECOND);
    let middle = |a: Place, b: Place| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    for (start, end, name, colour) in [
        (origin, elbow, "l1", FIRST),
        (origin, second, "l2", SECOND),
        (second, joint, "l3 = l1", FIRST),
        (elbow, hand, "l4", SECOND),
    ] {
        drawing.line(&[start, end], colour, 3.0, false);
        let below = if name == "l4" { -20.0 } else { 6.0 };
        drawing.label(middle(start, end), (10.0, below), name, colour);
    }
    for place in [origin, elbow, second, joint, hand] {
        drawing.pin(place, INK);
    }
    drawing.label(hand, (10.0, 14.0), "hand with the tool", INK);
    drawing.render()
}
