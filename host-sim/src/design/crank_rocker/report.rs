//! A crank-rocker as a page of text.

use std::io::{self, Write};

use cophase_scene::digits::four;

use super::Design;
use crate::design::page::row;

/// Writes the page.
///
/// # Errors
/// `out` cannot be written to.
pub fn write_page(design: &Design, out: &mut impl Write) -> io::Result<()> {
    let linkage = &design.linkage;
    let degrees = |angle_deg: f64| format!("{angle_deg:.3}");
    writeln!(out, "Crank-rocker; lengths are over the rocker's\n")?;
    let mut line = |what: &str, value: String, note: &str| row(out, what, &value, note);
    line("crank", format!("{:.5}", linkage.crank), "")?;
    line("coupler", format!("{:.5}", linkage.coupler), "")?;
    line("ground", format!("{:.5}", linkage.ground), "")?;
    line(
        "Grashof margin",
        format!("{:.5}", linkage.grashof_margin()),
        "above 0, so that the crank turns all round",
    )?;
    let [stretched, folded] = design.dead_centres_deg();
    line(
        "dead centre, stretched out, deg",
        degrees(stretched),
        "crank angle from the ground line",
    )?;
    line("dead centre, folded, deg", degrees(folded), "")?;
    line("angle between them, Θ, deg", degrees(design.theta_deg), "")?;
    line(
        "swing of the rocker, deg",
        degrees(linkage.swing_rad().to_degrees()),
        "",
    )?;
    line(
        "time ratio",
        four(linkage.time_ratio()),
        "forward over return",
    )?;
    let pressure = design.pressure_deg();
    line("pressure angle, largest, deg", degrees(pressure.max), "")?;
    line("… least, deg", degrees(pressure.min), "")?;
    line(
        "… mean over a turn, deg",
        degrees(design.mean_pressure_deg()),
        "signed",
    )?;
    let (speed, acceleration) = (design.rocker_speed(), design.rocker_acceleration());
    line(
        "rocker speed, largest",
        four(speed.max),
        "times the crank's",
    )?;
    line("… least", four(speed.min), "")?;
    line(
        "rocker acceleration, largest",
        four(acceleration.max),
        "times the crank speed squared",
    )?;
    line("… least", four(acceleration.min), "")?;
    if let Some(stroke_mm) = design.stroke_mm() {
        line("stroke of the screw's rod, mm", four(stroke_mm), "")?;
    }
    Ok(())
}
