//! Drawing of a screen with its symbols.

use core::f64::consts::TAU;

use super::Screen;
use crate::drawing::{Drawing, FIRST, SECOND};
use crate::style::{INK, MUTED};

/// Draws the screen, as SVG text. Blocks are at 60°, and their distance from the shaft is enlarged four times.
pub fn draw(screen: &Screen) -> String {
    const LARGER: f64 = 4.0;
    let half = screen.springs_m;
    let (height, spring) = (0.28 * half, 0.35 * half);
    let title = format!(
        "Screen: P = {:.0} kg, G = {:.0} kg at R = {:.1} mm",
        screen.box_kg,
        screen.block_kg,
        1e3 * screen.eccentricity_m
    );
    let mut drawing = Drawing::new(
        &title,
        [-1.15 * half, -height - spring],
        [1.15 * half, height + 0.25 * half],
    );
    drawing.rectangle([-half, -height], [half, height], INK);
    drawing.label(
        [-half, height],
        (8.0, -20.0),
        "box, mass P, pitch inertia I",
        INK,
    );
    for (x, name) in [(-0.9 * half, "K/2, ζ"), (0.9 * half, "K/2, ζ")] {
        drawing.spring([x, -height], [x, -height - spring], SECOND);
        drawing.label([x, -height - 0.5 * spring], (16.0, 0.0), name, SECOND);
        drawing.ground(
            [x - 0.12 * half, -height - spring],
            [x + 0.12 * half, -height - spring],
        );
    }
    drawing.line(&[[-half, 0.0], [half, 0.0]], MUTED, 1.0, true);
    let angle = TAU / 6.0;
    for (i, &place) in screen.places_m.iter().enumerate() {
        let radius = LARGER * screen.eccentricity_m;
        let block = [place + radius * angle.cos(), radius * angle.sin()];
        drawing.arc([place, 0.0], radius, (0.0, TAU), MUTED);
        drawing.line(&[[place, 0.0], block], FIRST, 3.0, false);
        drawing.pin([place, 0.0], INK);
        drawing.pin(block, FIRST);
        drawing.label(block, (8.0, 8.0), "G", FIRST);
        drawing.label([place, 0.0], (-14.0, -20.0), &format!("p{}", i + 1), INK);
        drawing.label(
            [
                place + 0.5 * radius * angle.cos(),
                0.5 * radius * angle.sin(),
            ],
            (8.0, -10.0),
            "R",
            FIRST,
        );
    }
    let corner = [0.0, height + 0.08 * half];
    drawing.arrow(corner, [0.12 * half, corner[1]], INK);
    drawing.arrow(corner, [0.0, corner[1] + 0.12 * half], INK);
    drawing.label([0.12 * half, corner[1]], (6.0, -4.0), "x", INK);
    drawing.label([0.0, corner[1] + 0.12 * half], (8.0, -4.0), "z", INK);
    drawing.label(
        [0.0, -height],
        (-100.0, -20.0),
        "R is drawn four times too large",
        MUTED,
    );
    drawing.render()
}
