//! Drive and flywheel as a page and as an object.

use std::io::{self, Write};

use cophase_scene::digits::four;
use host_sim::machines::crusher::mains::Speeds;
use serde::Serialize;

use super::{Design, Dynamic, Requirement, Rock, Shape, design, periodic};
use crate::design::page::row;
use crate::design::{Method, Refused, no_scene};
use crate::numbers::{number, whole};

/// Options of the method.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Flywheel {
    #[command(flatten)]
    requirement: Requirement,
    /// Fastest speed of the shaft, rad/s
    #[arg(
        long,
        value_name = "W",
        allow_hyphen_values = true, value_parser = number,
        requires = "slowest_rad_s"
    )]
    fastest_rad_s: Option<f64>,
    /// Slowest speed of the shaft, rad/s
    #[arg(
        long,
        value_name = "W",
        allow_hyphen_values = true, value_parser = number,
        requires = "fastest_rad_s"
    )]
    slowest_rad_s: Option<f64>,
    /// Peak force of the rock across the jaw, kN: computes the speeds of the periodic regime
    #[arg(long, value_name = "F", allow_hyphen_values = true, value_parser = number)]
    rock_kn: Option<f64>,
    /// How that force acts over the closing stroke
    #[arg(long, value_enum, default_value = "linear-rise", requires = "rock_kn")]
    rock: RockShape,
    /// Nodes a turn of the source's scheme, beside the converged solution: 4 to 10,000
    #[arg(long, value_name = "COUNT", default_value_t = 18, requires = "rock_kn", value_parser = whole::<u32>(4..=10_000), allow_negative_numbers = true)]
    nodes: u32,
    /// Irregularity under rock for which to find the flywheel: 0.001 to 0.5
    #[arg(
        long,
        value_name = "D",
        allow_hyphen_values = true, value_parser = number,
        requires = "rock_kn"
    )]
    irregularity: Option<f64>,
}

/// Shape of the rock's force.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum RockShape {
    /// Rises with the shaft's angle, to its peak at the end of the stroke
    LinearRise,
    /// Its peak over the second half of the stroke
    SecondHalf,
    /// Its peak over the whole stroke
    Constant,
}

impl From<RockShape> for Shape {
    fn from(shape: RockShape) -> Self {
        match shape {
            RockShape::LinearRise => Self::LinearRise,
            RockShape::SecondHalf => Self::SecondHalf,
            RockShape::Constant => Self::Constant,
        }
    }
}

/// Speeds under rock: converged, and by the scheme of the source.
#[derive(Serialize)]
pub struct UnderRock {
    fastest_rad_s: f64,
    slowest_rad_s: f64,
    mean_rad_s: f64,
    irregularity: f64,
    nodes: u32,
    nodes_fastest_rad_s: Option<f64>,
    nodes_slowest_rad_s: Option<f64>,
    nodes_mean_rad_s: Option<f64>,
    required_inertia_kgm2: Option<f64>,
}

impl From<&Dynamic> for UnderRock {
    fn from(dynamic: &Dynamic) -> Self {
        let (converged, by_nodes) = (&dynamic.converged, dynamic.by_nodes.as_ref());
        Self {
            fastest_rad_s: converged.fastest_rad_s(),
            slowest_rad_s: converged.slowest_rad_s(),
            mean_rad_s: converged.mean_rad_s(),
            irregularity: converged.irregularity(),
            nodes: dynamic.rock.nodes,
            nodes_fastest_rad_s: by_nodes.map(|speeds| speeds.fastest_rad_s()),
            nodes_slowest_rad_s: by_nodes.map(|speeds| speeds.slowest_rad_s()),
            nodes_mean_rad_s: by_nodes.map(|speeds| speeds.mean_rad_s()),
            required_inertia_kgm2: dynamic.required_kgm2,
        }
    }
}

/// The object that `--json` prints.
#[derive(Serialize)]
pub struct Figures {
    synchronous_rad_s: f64,
    rated_rad_s: f64,
    rated_torque_nm: f64,
    breakdown_torque_nm: f64,
    breakdown_motor_rad_s: f64,
    torque_curve: [f64; 3],
    rim_inertia_kgm2: f64,
    disc_inertia_kgm2: f64,
    /// Torque of the shaft at rated load, and at the fastest and the slowest speed.
    shaft_torque_rated_nm: f64,
    shaft_torque_fastest_nm: Option<f64>,
    shaft_torque_slowest_nm: Option<f64>,
    irregularity: Option<f64>,
    energy_swing_j: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    under_rock: Option<UnderRock>,
}

impl Method for Flywheel {
    type Design = (Design, Option<Dynamic>);
    type Figures = Figures;

    fn design(&self) -> Result<Self::Design, Refused> {
        let speeds = self.fastest_rad_s.zip(self.slowest_rad_s);
        let design = design(&Requirement {
            speeds_rad_s: speeds.map(<[f64; 2]>::from),
            ..self.requirement
        })?;
        let rock = self.rock_kn.map(|peak_kn| Rock {
            shape: self.rock.into(),
            peak_kn,
            nodes: self.nodes,
            irregularity: self.irregularity,
        });
        let dynamic = rock.map(|rock| periodic(&design, &rock)).transpose()?;
        Ok((design, dynamic))
    }

    fn figures(&self, (design, dynamic): &Self::Design) -> Figures {
        let speed = |which: usize| design.requirement.speeds_rad_s.map(|both| both[which]);
        let torque = |which| Some(design.shaft_torque_nm(speed(which)?));
        Figures {
            synchronous_rad_s: design.synchronous_rad_s(),
            rated_rad_s: design.rated_rad_s(),
            rated_torque_nm: design.rated_torque_nm(),
            breakdown_torque_nm: design.breakdown_torque_nm(),
            breakdown_motor_rad_s: design.breakdown_motor_rad_s(),
            torque_curve: design.curve.coefficients,
            rim_inertia_kgm2: design.rim_kgm2(),
            disc_inertia_kgm2: design.disc_kgm2(),
            shaft_torque_rated_nm: design.shaft_torque_nm(design.rated_rad_s()),
            shaft_torque_fastest_nm: torque(0),
            shaft_torque_slowest_nm: torque(1),
            irregularity: design.irregularity(),
            energy_swing_j: design.energy_swing_j(),
            under_rock: dynamic.as_ref().map(UnderRock::from),
        }
    }

    fn write_page(&self, (design, dynamic): &Self::Design, out: &mut dyn Write) -> io::Result<()> {
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

    fn scene(&self, _: &Self::Design) -> Result<String, Refused> {
        Err(no_scene("jaw-crusher"))
    }
}

fn write_dynamic(dynamic: &Dynamic, out: &mut dyn Write) -> io::Result<()> {
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
