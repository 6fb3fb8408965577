//! Axonometric view: projection of points onto the sheet, and bodies without their hidden faces.

use core::f64::consts::TAU;

use crate::drawing::{Drawing, Place};

/// A point in space: x, y, and z upwards.
pub type Place3 = [f64; 3];

/// Elevation of the eye above the horizon, rad.
const ELEVATION_RAD: f64 = 0.36;
/// Angle between the eye's direction and the nearest axis in the plan view, rad.
const BESIDE_RAD: f64 = 0.45;

/// Eye of the view, by its direction in the plan view, rad from x.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    azimuth_rad: f64,
}

impl Eye {
    /// Creates the eye for a number of axes. The last axis is nearly in front, axis 0 to the right of it.
    pub fn for_axes(count: usize) -> Self {
        let last_rad = TAU / count as f64;
        let azimuth_rad = if count == 2 {
            -1.05
        } else {
            BESIDE_RAD - last_rad
        };
        Self { azimuth_rad }
    }

    /// Projects a point in space onto the sheet.
    pub fn project(self, [x, y, z]: Place3) -> Place {
        let (sin, cos) = self.azimuth_rad.sin_cos();
        let nearer = x * cos + y * sin;
        [
            y * cos - x * sin,
            self.height(z) - nearer * ELEVATION_RAD.sin(),
        ]
    }

    /// Nearness of a direction in the plan view to the eye, −1 to 1.
    pub fn nearness(self, angle_rad: f64) -> f64 {
        (angle_rad - self.azimuth_rad).cos()
    }

    /// Projects a height in space onto the sheet.
    pub fn height(self, z: f64) -> f64 {
        z * ELEVATION_RAD.cos()
    }

    /// Horizontal circle around the z axis.
    pub fn circle(self, radius: f64, z: f64) -> Vec<Place> {
        const PIECES: u32 = 96;
        (0..=PIECES)
            .map(|i| {
                let (sin, cos) = (TAU * f64::from(i) / f64::from(PIECES)).sin_cos();
                self.project([radius * cos, radius * sin, z])
            })
            .collect()
    }
}

/// Draws a vertical cylinder around the z axis: its wall, then its top.
pub fn cylinder(
    drawing: &mut Drawing,
    eye: Eye,
    radius: f64,
    (low, high): (f64, f64),
    fill: &str,
    colour: &str,
) {
    // The wall consists of the near half of the lower circle and the straight sides up to the upper circle.
    let half = |z: f64| {
        const PIECES: u32 = 48;
        (0..=PIECES).map(move |i| {
            let angle = eye.azimuth_rad - 0.25 * TAU + 0.5 * TAU * f64::from(i) / f64::from(PIECES);
            eye.project([radius * angle.cos(), radius * angle.sin(), z])
        })
    };
    let mut wall: Vec<Place> = half(low).collect();
    wall.extend(half(high).rev());
    drawing.face(&wall, fill, colour, 1.5);
    drawing.face(&eye.circle(radius, high), fill, colour, 1.5);
}

/// Draws a box in the frame of an axis, by its extents along the radius, across it and upwards.
pub fn prism(
    drawing: &mut Drawing,
    eye: Eye,
    angle_rad: f64,
    [along, across, up]: [(f64, f64); 3],
    fill: &str,
    colour: &str,
) {
    let (sin, cos) = angle_rad.sin_cos();
    let at = |r: f64, t: f64, z: f64| eye.project([r * cos - t * sin, r * sin + t * cos, z]);
    let side = |angle: f64| eye.nearness(angle_rad + angle) > 0.0;
    let r = if side(0.0) { along.1 } else { along.0 };
    let t = if side(0.25 * TAU) { across.1 } else { across.0 };
    let faces = [
        [
            at(r, across.0, up.0),
            at(r, across.1, up.0),
            at(r, across.1, up.1),
            at(r, across.0, up.1),
        ],
        [
            at(along.0, t, up.0),
            at(along.1, t, up.0),
            at(along.1, t, up.1),
            at(along.0, t, up.1),
        ],
        [
            at(along.0, across.0, up.1),
            at(along.1, across.0, up.1),
            at(along.1, across.1, up.1),
            at(along.0, across.1, up.1),
        ],
    ];
    for face in faces {
        drawing.face(&face, fill, colour, 1.0);
    }
}
