//! `cophase design crank-rocker`: synthesis of a four-bar linkage.

use std::io::Write;
use std::path::PathBuf;

use host_sim::design::crank_rocker::{Design, Requirement, design, write_page};
use host_sim::setup::runnable;
use serde::Serialize;

use super::{DesignCommandError, Print, write_json};
use crate::numbers::number;
use crate::output::write_file;

/// Find the links of a crank-rocker from the swing of its rocker, for a drive with a screw
#[derive(Clone, Debug, clap::Args)]
pub struct CrankRockerArgs {
    /// Swing of the rocker, degrees: above 0, up to 179
    #[arg(long, value_name = "A", allow_hyphen_values = true, value_parser = number)]
    pub swing_deg: f64,
    /// Pressure angle where crank and coupler are stretched out, degrees: from 0 to below half the swing
    #[arg(long, value_name = "B", allow_hyphen_values = true, value_parser = number)]
    pub pressure_deg: f64,
    /// Time of the forward stroke over that of the return: 0.01 to 0.999
    #[arg(long, value_name = "K", allow_hyphen_values = true, value_parser = number)]
    pub time_ratio: f64,
    /// Lead of the screw that the rocker turns, mm: above 0, up to 1000
    #[arg(long, value_name = "P", allow_hyphen_values = true, value_parser = number)]
    pub screw_lead_mm: Option<f64>,
    /// Draw the linkage at both dead centres into this file, too
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}

/// The object that `--json` prints. Lengths are relative to that of the rocker.
#[derive(Serialize)]
struct Figures {
    crank_ratio: f64,
    coupler_ratio: f64,
    ground_ratio: f64,
    theta_deg: f64,
    grashof_margin: f64,
    dead_centre_deg: [f64; 2],
    swing_deg: f64,
    time_ratio: f64,
    pressure_max_deg: f64,
    pressure_min_deg: f64,
    pressure_mean_deg: f64,
    rocker_speed_max: f64,
    rocker_speed_min: f64,
    rocker_acceleration_max: f64,
    rocker_acceleration_min: f64,
    /// `None` without a screw.
    stroke_mm: Option<f64>,
}

impl From<&Design> for Figures {
    fn from(design: &Design) -> Self {
        let linkage = &design.linkage;
        let (pressure, speed) = (design.pressure_deg(), design.rocker_speed());
        let acceleration = design.rocker_acceleration();
        Self {
            crank_ratio: linkage.crank,
            coupler_ratio: linkage.coupler,
            ground_ratio: linkage.ground,
            theta_deg: design.theta_deg,
            grashof_margin: linkage.grashof_margin(),
            dead_centre_deg: design.dead_centres_deg(),
            swing_deg: linkage.swing_rad().to_degrees(),
            time_ratio: linkage.time_ratio(),
            pressure_max_deg: pressure.max,
            pressure_min_deg: pressure.min,
            pressure_mean_deg: design.mean_pressure_deg(),
            rocker_speed_max: speed.max,
            rocker_speed_min: speed.min,
            rocker_acceleration_max: acceleration.max,
            rocker_acceleration_min: acceleration.min,
            stroke_mm: design.stroke_mm(),
        }
    }
}

/// Finds the linkage and writes text, one JSON object or a scene to `out`.
///
/// # Errors
/// Bad input, before anything is written; or `out` cannot be written.
pub(super) fn run(
    args: &CrankRockerArgs,
    print: Print,
    out: &mut impl Write,
) -> Result<(), DesignCommandError> {
    let found = design(&Requirement {
        swing_deg: args.swing_deg,
        pressure_deg: args.pressure_deg,
        time_ratio: args.time_ratio,
        screw_lead_mm: args.screw_lead_mm,
    })
    .map_err(DesignCommandError::input)?;
    let scene = match print {
        Print::Scene => Some(
            found
                .scene()
                .and_then(runnable)
                .map_err(DesignCommandError::input)?,
        ),
        Print::Page | Print::Json => None,
    };
    if let Some(file) = &args.svg {
        write_file("--svg", file, found.linkage.draw().as_bytes())?;
    }
    match (print, scene) {
        (_, Some(scene)) => Ok(out.write_all(scene.as_bytes())?),
        (Print::Json, None) => write_json(&Figures::from(&found), out),
        (_, None) => Ok(write_page(&found, out)?),
    }
}
