//! Drive and flywheel as a page of text.

use std::io::{self, Write};

use super::Design;
use crate::design::digits::four;
use crate::design::page::row;

/// Writes the design as text.
///
/// # Errors
/// `out` cannot be written to.
pub fn write_page(design: &Design, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "Crusher drive and flywheel\n")?;
    let mut row = |what: &str, value: f64, note: &str| row(out, what, &four(value), note);
    row(
        "shaft speed without load, rad/s",
        design.synchronous_rad_s(),
        "",
    )?;
    row("shaft speed at rated load, rad/s", design.rated_rad_s(), "")?;
    row("motor torque, rated, N·m", design.rated_torque_nm(), "")?;
    row(
        "motor torque, breakdown, N·m",
        design.breakdown_torque_nm(),
        "",
    )?;
    row(
        "motor speed at breakdown, rad/s",
        design.breakdown_motor_rad_s(),
        "",
    )?;
    let [a, b, c] = design.curve.coefficients;
    row("motor torque a ω² + b ω + c: a", a, "N·m s²")?;
    row("… b", b, "N·m s")?;
    row("… c", c, "N·m")?;
    row(
        "flywheel inertia as a thin rim, kg·m²",
        design.rim_kgm2(),
        "m D² / 4",
    )?;
    row("… as a disc, kg·m²", design.disc_kgm2(), "m D² / 8")?;
    if let (Some([fastest, slowest]), Some(irregularity), Some(energy_j)) = (
        design.requirement.speeds_rad_s,
        design.irregularity(),
        design.energy_swing_j(),
    ) {
        row(
            "shaft torque at the fastest speed, N·m",
            design.shaft_torque_nm(fastest),
            "",
        )?;
        row(
            "… at the slowest speed, N·m",
            design.shaft_torque_nm(slowest),
            "",
        )?;
        row(
            "irregularity",
            irregularity,
            "over the middle of both speeds",
        )?;
        row("energy that the rim gives up, J", energy_j, "")?;
    }
    Ok(())
}
