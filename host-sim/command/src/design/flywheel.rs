//! `cophase design flywheel`: drive and flywheel of a crusher.

use std::io::Write;

use host_sim::design::flywheel::{
    Design, Dynamic, Requirement, Rock, Shape, design, periodic, write_page,
};
use serde::Serialize;

use super::{DesignCommandError, write_json};
use crate::numbers::{number, whole};

/// Find the torque curve of a crusher's induction motor, and what its flywheel evens out
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct FlywheelArgs {
    /// Rated power of the motor, kW: above 0, up to 10,000
    #[arg(long, value_name = "P", allow_hyphen_values = true, value_parser = number)]
    pub power_kw: f64,
    /// Rated speed of the motor, rpm: below the synchronous speed
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = number)]
    pub rated_rpm: f64,
    /// Synchronous speed of the motor, rpm: above 0, up to 12,000
    #[arg(long, value_name = "N0", allow_hyphen_values = true, value_parser = number)]
    pub synchronous_rpm: f64,
    /// Breakdown torque over rated torque: 1.1 to 5
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = number)]
    pub overload: f64,
    /// Speed of the motor over that of the shaft: 0.1 to 100
    #[arg(long, value_name = "J", allow_hyphen_values = true, value_parser = number)]
    pub belt_ratio: f64,
    /// Mass of the flywheel, kg: above 0, up to 100,000
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub mass_kg: f64,
    /// Diameter on which that mass lies, m: above 0, up to 20
    #[arg(long, value_name = "D", allow_hyphen_values = true, value_parser = number)]
    pub diameter_m: f64,
    /// Fastest speed of the shaft, rad/s
    #[arg(
        long,
        value_name = "W",
        allow_hyphen_values = true, value_parser = number,
        requires = "slowest_rad_s"
    )]
    pub fastest_rad_s: Option<f64>,
    /// Slowest speed of the shaft, rad/s
    #[arg(
        long,
        value_name = "W",
        allow_hyphen_values = true, value_parser = number,
        requires = "fastest_rad_s"
    )]
    pub slowest_rad_s: Option<f64>,
    /// Peak force of the rock across the jaw, kN: computes the speeds of the periodic regime
    #[arg(long, value_name = "F", allow_hyphen_values = true, value_parser = number)]
    pub rock_kn: Option<f64>,
    /// How that force acts over the closing stroke
    #[arg(long, value_enum, default_value = "linear-rise", requires = "rock_kn")]
    pub rock: RockShape,
    /// Nodes a turn of the source's scheme, beside the converged solution: 4 to 10,000
    #[arg(long, value_name = "COUNT", default_value_t = 18, requires = "rock_kn", value_parser = whole::<u32>(4..=10_000), allow_negative_numbers = true)]
    pub nodes: u32,
    /// Irregularity under rock for which to find the flywheel: 0.001 to 0.5
    #[arg(
        long,
        value_name = "D",
        allow_hyphen_values = true, value_parser = number,
        requires = "rock_kn"
    )]
    pub irregularity: Option<f64>,
}

/// Shape of the rock's force.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub enum RockShape {
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
struct UnderRock {
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
struct Figures {
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

impl From<&Design> for Figures {
    fn from(design: &Design) -> Self {
        let speed = |which: usize| design.requirement.speeds_rad_s.map(|both| both[which]);
        let torque = |which| Some(design.shaft_torque_nm(speed(which)?));
        Self {
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
            under_rock: None,
        }
    }
}

/// Computes the figures and writes text, or with `json` one object, to `out`.
///
/// # Errors
/// Bad input, before anything is written; or `out` cannot be written.
pub fn run(
    args: &FlywheelArgs,
    json: bool,
    out: &mut impl Write,
) -> Result<(), DesignCommandError> {
    let found = design(&Requirement {
        power_kw: args.power_kw,
        rated_rpm: args.rated_rpm,
        synchronous_rpm: args.synchronous_rpm,
        overload: args.overload,
        belt_ratio: args.belt_ratio,
        mass_kg: args.mass_kg,
        diameter_m: args.diameter_m,
        speeds_rad_s: args
            .fastest_rad_s
            .zip(args.slowest_rad_s)
            .map(|(fastest, slowest)| [fastest, slowest]),
    })
    .map_err(DesignCommandError::input)?;
    let rock = args.rock_kn.map(|peak_kn| Rock {
        shape: args.rock.into(),
        peak_kn,
        nodes: args.nodes,
        irregularity: args.irregularity,
    });
    let dynamic = rock.map(|rock| periodic(&found, &rock)).transpose();
    let dynamic = dynamic.map_err(DesignCommandError::input)?;
    if json {
        let figures = Figures {
            under_rock: dynamic.as_ref().map(UnderRock::from),
            ..Figures::from(&found)
        };
        write_json(&figures, out)
    } else {
        Ok(write_page(&found, dynamic.as_ref(), out)?)
    }
}
