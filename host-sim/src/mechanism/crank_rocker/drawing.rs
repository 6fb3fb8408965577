//! Drawing of a crank-rocker at both dead centres.

use core::f64::consts::TAU;

use super::{CrankRocker, Linkage};
use crate::drawing::{Drawing, FIRST, Place, SECOND, View};
use crate::mechanism::drawing::{Mount, Unit, beside_plan};
use crate::style::{INK, MUTED};

impl Linkage {
    /// Drawing of the linkage at both dead centres, with its symbols, as SVG text.
    #[must_use]
    pub fn draw(&self) -> String {
        let (low, high) = corners(self);
        let title = format!("Crank-rocker at both dead centres: {}", proportions(self));
        let mut drawing = Drawing::new(&title, low, high);
        draw(&mut drawing, self);
        drawing.render()
    }
}

/// Draws the linkage of one unit beside the plan view of all units.
pub fn under_platform(mechanism: &CrankRocker, mount: &Mount) -> String {
    let linkage = &mechanism.linkage;
    let sizes = format!("at both dead centres: {}", proportions(linkage));
    beside_plan(
        mount,
        Unit::Upright,
        ("crank-rockers", &sizes),
        |drawing, [left, right]| {
            let (low, high) = corners(linkage);
            let scale = 0.96 * (right.0 - left.0) / (high[0] - low[0]);
            let height = scale * (high[1] - low[1]);
            let bottom = 0.5 * (left.1 + right.1 + height);
            drawing.set_view(View {
                scale,
                of: low,
                at: (left.0, bottom),
            });
            draw(drawing, linkage);
        },
    )
}

fn proportions(linkage: &Linkage) -> String {
    format!(
        "swing {:.1}°, time ratio {:.3}",
        linkage.swing_rad().to_degrees(),
        linkage.time_ratio()
    )
}

/// Crank angle, rocker angle, and both joints at a dead centre.
fn positions(linkage: &Linkage) -> [(f64, f64, Place, Place); 2] {
    linkage.dead_centres_rad().map(|crank| {
        let rocker = linkage.at(crank).angle_rad;
        let pin = [linkage.crank * crank.cos(), linkage.crank * crank.sin()];
        let end = [linkage.ground + rocker.cos(), rocker.sin()];
        (crank, rocker, pin, end)
    })
}

/// Corners of the area that the linkage covers.
fn corners(linkage: &Linkage) -> (Place, Place) {
    let ends = positions(linkage).map(|(_, _, _, end)| end);
    let right = ends.iter().map(|end| end[0]).fold(linkage.ground, f64::max);
    let top = ends.iter().map(|end| end[1]).fold(linkage.crank, f64::max);
    ([-linkage.crank, -linkage.crank], [right + 0.15, top])
}

fn draw(drawing: &mut Drawing, linkage: &Linkage) {
    let (crank_pivot, rocker_pivot) = ([0.0, 0.0], [linkage.ground, 0.0]);
    let positions = positions(linkage);
    drawing.line(&[crank_pivot, rocker_pivot], INK, 1.5, false);
    drawing.arc(crank_pivot, linkage.crank, (0.0, TAU), MUTED);
    drawing.arc(rocker_pivot, 1.0, (positions[0].1, positions[1].1), MUTED);
    let names = [
        ("B1", "C1", "stretched out", 0.0, FIRST),
        ("B2", "C2", "folded", -20.0, SECOND),
    ];
    for ((crank, _, pin, end), (pin_name, end_name, what, lower, colour)) in
        positions.into_iter().zip(names)
    {
        drawing.line(&[crank_pivot, pin, end, rocker_pivot], colour, 3.0, false);
        for joint in [pin, end] {
            drawing.pin(joint, colour);
        }
        drawing.label(pin, (8.0, -18.0), pin_name, colour);
        drawing.label(end, (-10.0, 14.0), end_name, colour);
        let note = format!("{what}: crank at {:.2}°", crank.to_degrees());
        drawing.label(
            [0.5 * linkage.ground, -0.6 * linkage.crank],
            (0.0, lower),
            &note,
            colour,
        );
    }
    for (pivot, name) in [(crank_pivot, "A"), (rocker_pivot, "D")] {
        drawing.pin(pivot, INK);
        drawing.label(pivot, (8.0, -20.0), name, INK);
    }
    let middle = |a: Place, b: Place| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    drawing.label(
        middle(crank_pivot, rocker_pivot),
        (0.0, -18.0),
        &format!("ground {:.4}", linkage.ground),
        INK,
    );
    let (_, _, pin, end) = positions[0];
    drawing.label(
        middle(pin, end),
        (-70.0, 24.0),
        &format!("coupler {:.4}", linkage.coupler),
        FIRST,
    );
    drawing.label(middle(end, rocker_pivot), (10.0, 0.0), "rocker 1", FIRST);
    let note = format!("crank {:.4}", linkage.crank);
    drawing.label([-linkage.crank, -linkage.crank], (0.0, -18.0), &note, MUTED);
}
