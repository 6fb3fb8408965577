//! Drive and flywheel as a page of text.

use std::io::{self, Write};

use crate::machines::crusher::mains::Speeds;
use cophase_scene::digits::four;

use super::{Design, Dynamic};
use crate::design::page::row;

/// Writes the design as text, with the speeds under rock if they were computed.
///
/// # Errors
/// `out` cannot be written to.
pub fn write_page(
    design: &Design,
    dynamic: Option<&Dynamic>,
    out: &mut impl Write,
) -> io::Result<()> {
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
    match dynamic {
        Some(dynamic) => write_dynamic(dynamic, out),
        None => Ok(()),
    }
}

fn write_dynamic(dynamic: &Dynamic, out: &mut impl Write) -> io::Result<()> {
    let rock = dynamic.rock;
    writeln!(
        out,
        "\nUnder {} kN of rock, periodic: converged, and with {} nodes a turn\n",
        rock.peak_kn, rock.nodes
    )?;
    type Of = fn(&Speeds) -> f64;
    let figures = [
        (
            "fastest speed of the shaft, rad/s",
            Speeds::fastest_rad_s as Of,
        ),
        ("slowest", Speeds::slowest_rad_s),
        ("mean over time", Speeds::mean_rad_s),
        ("irregularity, over that mean", Speeds::irregularity),
    ];
    for (what, figure) in figures {
        let by_nodes = match &dynamic.by_nodes {
            Some(speeds) => four(figure(speeds)),
            None => "comes to rest".to_owned(),
        };
        row(out, what, &four(figure(&dynamic.converged)), &by_nodes)?;
    }
    if let (Some(limit), Some(required)) = (rock.irregularity, dynamic.required_kgm2) {
        let note = format!("for an irregularity of {limit}");
        row(
            out,
            "flywheel that is required, kg·m²",
            &four(required),
            &note,
        )?;
    }
    Ok(())
}
