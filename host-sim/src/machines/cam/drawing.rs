//! Drawing of a cam with its follower, labelled with their symbols.

use core::f64::consts::TAU;

use super::CamShafts;
use crate::drawing::{Drawing, FIRST, Place, SECOND};
use crate::style::{INK, MUTED};

/// Draws a follower as SVG text, with the cam of its law on a base circle whose radius is the stroke. A pusher on a screw has no cam: the
/// drawing shows its lift over a turn.
pub fn draw(shafts: &CamShafts) -> String {
    let stroke = shafts.cam.stroke_m;
    match shafts.screw_lead_m {
        Some(lead_m) => lift(shafts, lead_m, stroke),
        None => cam(shafts, stroke),
    }
}

/// Displacement at a fraction of the turn, m.
fn displacement(shafts: &CamShafts, part: f64) -> f64 {
    shafts.cam.at_angle(part * TAU).displacement
}

fn cam(shafts: &CamShafts, stroke: f64) -> String {
    const PIECES: u32 = 180;
    // The cam is turned so that its follower is half-way up the rise.
    let turned = 0.5 * shafts.cam.rise_rad / TAU;
    let outline: Vec<Place> = (0..PIECES)
        .map(|i| {
            let part = f64::from(i) / f64::from(PIECES);
            let radius = stroke + displacement(shafts, part + turned);
            let angle = 0.25 * TAU - part * TAU;
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    let roller = stroke + displacement(shafts, turned);
    let title = format!("Cam with its follower: H = {:.0} mm", 1e3 * stroke);
    let top = if shafts.links.is_some() { 5.0 } else { 3.2 };
    let mut drawing = Drawing::new(
        &title,
        [-3.4 * stroke, -2.2 * stroke],
        [3.4 * stroke, top * stroke],
    );
    drawing.outline(&outline, FIRST, 2.5);
    drawing.arc([0.0, 0.0], stroke, (0.0, TAU), MUTED);
    drawing.arc([0.0, 0.0], 2.0 * stroke, (0.0, TAU), MUTED);
    drawing.pin([0.0, 0.0], INK);
    drawing.label([0.0, 0.0], (10.0, -18.0), "shaft, ω", INK);
    drawing.label(
        [1.4 * stroke, -1.6 * stroke],
        (10.0, 0.0),
        "base circle, and circle of the stroke H",
        MUTED,
    );
    drawing.pin([0.0, roller], INK);
    let mut height = roller;
    if shafts.links.is_some() {
        for (i, part) in ["shaft", "arm", "link"].into_iter().enumerate() {
            let low = height + 0.55 * stroke;
            drawing.spring([0.0, height], [0.0, low], SECOND);
            drawing.label(
                [0.0, 0.5 * (height + low)],
                (22.0, -4.0),
                &format!("k{0}, c{0}: {part}", i + 1),
                SECOND,
            );
            drawing.rectangle(
                [-0.5 * stroke, low],
                [0.5 * stroke, low + 0.5 * stroke],
                INK,
            );
            drawing.label(
                [0.0, low + 0.25 * stroke],
                (-8.0, -5.0),
                &format!("m{}", i + 1),
                INK,
            );
            height = low + 0.5 * stroke;
        }
    } else {
        drawing.line(&[[0.0, roller], [0.0, roller + stroke]], INK, 4.0, false);
        height += stroke;
    }
    drawing.label([0.5 * stroke, height], (10.0, -14.0), "pusher", INK);
    drawing.arrow([-stroke, roller], [-stroke, roller + stroke], INK);
    drawing.label([-stroke, roller + 0.5 * stroke], (-18.0, 0.0), "s", INK);
    drawing.render()
}

fn lift(shafts: &CamShafts, lead_m: f64, stroke: f64) -> String {
    const PIECES: u32 = 360;
    let title = format!(
        "Electronic cam: H = {:.0} mm on a screw of {:.0} mm a turn",
        1e3 * stroke,
        1e3 * lead_m
    );
    let (wide, high) = (4.0 * stroke, 1.6 * stroke);
    let mut drawing = Drawing::new(
        &title,
        [-0.3 * stroke, -0.4 * stroke],
        [wide + 0.4 * stroke, high],
    );
    let places: Vec<Place> = (0..=PIECES)
        .map(|i| f64::from(i) / f64::from(PIECES))
        .map(|part| [part * wide, displacement(shafts, part)])
        .collect();
    drawing.arrow([0.0, 0.0], [wide + 0.3 * stroke, 0.0], INK);
    drawing.arrow([0.0, 0.0], [0.0, 1.5 * stroke], INK);
    drawing.label([wide, 0.0], (-60.0, -40.0), "phase of the master", INK);
    drawing.label(
        [0.0, 1.5 * stroke],
        (10.0, -8.0),
        "position of the pusher, s",
        INK,
    );
    drawing.line(&places, FIRST, 2.5, false);
    drawing.line(&[[0.0, stroke], [wide, stroke]], MUTED, 1.0, true);
    drawing.label([wide, stroke], (6.0, 0.0), "H", MUTED);
    let cam = &shafts.cam;
    let mut begin = 0.0;
    for (name, angle) in [
        ("rise", cam.rise_rad),
        ("dwell", cam.dwell_rad),
        ("return", cam.return_rad),
    ] {
        let end = begin + angle / TAU * wide;
        drawing.line(&[[end, 0.0], [end, stroke]], MUTED, 1.0, true);
        drawing.label([0.5 * (begin + end), 0.0], (-16.0, -20.0), name, MUTED);
        begin = end;
    }
    drawing.render()
}
