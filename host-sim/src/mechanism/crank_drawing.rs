//! Drawing of a crank under a platform: a slider-crank or a Scotch yoke, with their symbols.

use core::f64::consts::TAU;

use crate::drawing::{Drawing, FIRST, Place};
use crate::ink::{INK, MUTED};

/// Angle of the crank in the drawing, from the dead centre at which the platform is farthest, rad.
const ALPHA_RAD: f64 = 0.9;

/// Part between the crank's pin and the platform.
pub enum Link {
    /// A rod of a length, m.
    Rod(f64),
    /// A slot across the line of travel.
    Slot,
}

/// Draws a crank of a radius, m, as SVG text.
#[must_use]
pub fn draw(radius_m: f64, link: &Link) -> String {
    let r = radius_m;
    let pin: Place = [r * ALPHA_RAD.sin(), r * ALPHA_RAD.cos()];
    let (title, corner, top) = match *link {
        Link::Rod(rod_m) => {
            let height = pin[1] + (rod_m * rod_m - pin[0] * pin[0]).sqrt();
            (
                format!(
                    "Slider-crank, one of N: R = {:.2} mm, L = {:.2} mm",
                    1e3 * r,
                    1e3 * rod_m
                ),
                [0.0, height],
                r + rod_m,
            )
        }
        Link::Slot => (
            format!("Scotch yoke, one of N: R = {:.2} mm", 1e3 * r),
            [0.0, pin[1] + 1.2 * r],
            2.2 * r,
        ),
    };
    let wide = 2.2 * r.max(0.4 * top);
    let mut drawing = Drawing::new(&title, [-wide, -1.4 * r], [wide, top + 0.7 * r]);
    // The platform at its farthest and as it stands.
    let plate = |y: f64| [[-wide, y], [wide, y]];
    drawing.line(&plate(top), MUTED, 1.2, true);
    drawing.line(&plate(corner[1]), INK, 4.0, false);
    drawing.label(
        [-wide, corner[1]],
        (6.0, 10.0),
        "platform with its load, mass m",
        INK,
    );
    drawing.label(
        [-wide, top],
        (6.0, 10.0),
        "at the dead centre, α = 0",
        MUTED,
    );
    drawing.arc([0.0, 0.0], r, (0.0, TAU), MUTED);
    drawing.line(&[[0.0, 0.0], [0.0, corner[1]]], MUTED, 1.0, true);
    drawing.arc(
        [0.0, 0.0],
        0.45 * r,
        (0.25 * TAU - ALPHA_RAD, 0.25 * TAU),
        FIRST,
    );
    drawing.label([0.16 * r, 0.5 * r], (0.0, 8.0), "α", FIRST);
    drawing.line(&[[0.0, 0.0], pin], FIRST, 3.0, false);
    drawing.label([0.5 * pin[0], 0.5 * pin[1]], (8.0, -14.0), "R", FIRST);
    match link {
        Link::Rod(_) => {
            drawing.line(&[pin, corner], FIRST, 3.0, false);
            let middle = [0.5 * (pin[0] + corner[0]), 0.5 * (pin[1] + corner[1])];
            drawing.label(middle, (10.0, 0.0), "L = R/λ", FIRST);
            drawing.pin(corner, FIRST);
        }
        Link::Slot => {
            let half = 1.25 * r;
            drawing.rectangle([-half, pin[1] - 0.08 * r], [half, pin[1] + 0.08 * r], FIRST);
            drawing.line(&[[0.0, pin[1] + 0.08 * r], corner], FIRST, 3.0, false);
            drawing.label([half, pin[1]], (8.0, -5.0), "slot", FIRST);
        }
    }
    drawing.pin(pin, FIRST);
    drawing.pin([0.0, 0.0], INK);
    drawing.label([0.0, 0.0], (-22.0, -18.0), "ω", INK);
    drawing.arrow([-1.5 * r, 0.0], [-1.5 * r, corner[1]], INK);
    drawing.label([-1.5 * r, 0.5 * corner[1]], (-18.0, 0.0), "x", INK);
    drawing.ground([-0.5 * r, -1.15 * r], [0.5 * r, -1.15 * r]);
    drawing.line(&[[0.0, 0.0], [0.0, -1.15 * r]], INK, 1.5, false);
    drawing.render()
}
