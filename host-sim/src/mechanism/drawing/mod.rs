//! Drawing of a platform on its mechanisms: a perspective view with symbols, and the plan view from above.
//!
//! [`Mount`] defines the number and arrangement of the mechanisms. `cranks` draws cranks with rods or slots, `plan` the
//! view from above. A mechanism without cranks under the platform draws its own view with [`beside_plan`].

mod cranks;
mod perspective;
mod plan;
mod symbols;

pub use cranks::{Link, cranks};
pub use plan::Unit;

use crate::drawing::{Drawing, View};

/// Height of the sheet, px.
const HEIGHT: f64 = 540.0;
/// Centre of the plan view, and its mount radius, px.
const PLAN: ((f64, f64), f64) = ((732.0, 250.0), 102.0);

/// Platform with its load, and the arrangement of the mechanisms around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mount {
    /// Name of the machine.
    pub name: String,
    /// For each axis, true if it is mounted in reverse.
    pub reversed: Vec<bool>,
    /// True if the platform hangs below the cranks.
    pub is_below: bool,
    /// Radius of the circle on which the mechanisms are mounted, m.
    pub radius_m: f64,
    /// Mass of the platform with its load, kg.
    pub load_kg: f64,
}

impl Mount {
    /// Number of axes.
    fn axes(&self) -> usize {
        self.reversed.len()
    }

    /// Angle of an axis on the mount circle, rad, from x towards y.
    fn angle_rad(&self, axis: usize) -> f64 {
        core::f64::consts::TAU * axis as f64 / self.axes() as f64
    }
}

/// Draws a mechanism's view on the left and the plan view on the right. `draw` draws the mechanism between two corners of
/// the sheet, px. `links` names the mechanisms, and `sizes` their dimensions.
pub fn beside_plan(
    mount: &Mount,
    unit: Unit,
    (links, sizes): (&str, &str),
    draw: impl FnOnce(&mut Drawing, [(f64, f64); 2]),
) -> String {
    let mut drawing = Drawing::sheet(HEIGHT);
    let title = format!(
        "{}: {} {links} under one platform",
        mount.name,
        mount.axes()
    );
    let subtitle = format!("{sizes}, load {} kg", plain(mount.load_kg));
    drawing.heading((20.0, 34.0), &title, &subtitle);
    draw(&mut drawing, [(20.0, 80.0), (545.0, HEIGHT - 20.0)]);
    let (at, scale) = PLAN;
    let of = [0.0, 0.0];
    drawing.set_view(View { scale, of, at });
    plan::draw(&mut drawing, mount, unit);
    drawing.render()
}

/// Formats a length in mm, without trailing zeros.
fn mm(length_m: f64) -> String {
    format!("{} mm", plain((length_m * 1e5).round() / 1e2))
}

fn plain(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    format!("{rounded}")
}
