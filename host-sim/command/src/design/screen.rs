//! `cophase design screen`: springs, natural speed and amplitude of a self-centring screen.

use std::io::Write;

use host_sim::design::screen::{Design, Requirement, design, write_page};
use host_sim::setup::runnable;
use serde::Serialize;

use super::{DesignCommandError, Print, write_json};
use crate::numbers::number;

/// Find springs, natural speed and amplitude of a self-centring vibrating screen
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct ScreenArgs {
    /// Mass of the exciter block, kg: above 0, up to 10,000
    #[arg(long, value_name = "G", allow_hyphen_values = true, value_parser = number)]
    pub exciter_kg: f64,
    /// All other vibrating mass, stones included, kg: above 0, up to 100,000
    #[arg(long, value_name = "P", allow_hyphen_values = true, value_parser = number)]
    pub vibrating_kg: f64,
    /// Distance of the block's centre of mass from the shaft's axis, mm: above 0, up to 1000
    #[arg(long, value_name = "R", allow_hyphen_values = true, value_parser = number)]
    pub eccentricity_mm: f64,
    /// Speed of the shaft, rpm: above 0, up to 6000
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = number)]
    pub speed_rpm: f64,
    /// Inclination of the deck, degrees: 0 to 45
    #[arg(long, value_name = "A", allow_hyphen_values = true, value_parser = number)]
    pub deck_deg: Option<f64>,
    /// Distance of the wheel's bore from its centre, mm: above 0, up to 100
    #[arg(long, value_name = "r", allow_hyphen_values = true, value_parser = number,
          default_value_t = Requirement::SOURCE_WHEEL_MM)]
    pub wheel_mm: f64,
}

/// The object that `--json` prints.
#[derive(Serialize)]
struct Figures {
    speed_rad_s: f64,
    throw_index: f64,
    stiffness_kgf_per_cm: f64,
    natural_speed_rpm: f64,
    speed_ratio: f64,
    amplitude_mm: f64,
    wheel_wobble_mm: f64,
    static_deflection_mm: f64,
}

impl From<&Design> for Figures {
    fn from(design: &Design) -> Self {
        Self {
            speed_rad_s: design.speed_rad_s(),
            throw_index: design.throw_index(),
            stiffness_kgf_per_cm: design.stiffness_kgf_per_cm(),
            natural_speed_rpm: design.natural_speed_rpm(),
            speed_ratio: design.speed_ratio(),
            amplitude_mm: design.amplitude_mm(),
            wheel_wobble_mm: design.wheel_wobble_mm(),
            static_deflection_mm: design.static_deflection_mm(),
        }
    }
}

/// Designs the screen and writes text, one JSON object or a scene to `out`.
///
/// # Errors
/// Bad input, before anything is written; or `out` cannot be written.
pub(super) fn run(
    args: &ScreenArgs,
    print: Print,
    out: &mut impl Write,
) -> Result<(), DesignCommandError> {
    let found = design(&Requirement {
        exciter_kg: args.exciter_kg,
        vibrating_kg: args.vibrating_kg,
        eccentricity_mm: args.eccentricity_mm,
        speed_rpm: args.speed_rpm,
        wheel_mm: args.wheel_mm,
        deck_deg: args.deck_deg,
    })
    .map_err(DesignCommandError::input)?;
    let scene = match print {
        Print::Scene => Some(runnable(found.scene()).map_err(DesignCommandError::input)?),
        Print::Page | Print::Json => None,
    };
    match (print, scene) {
        (_, Some(scene)) => Ok(out.write_all(scene.as_bytes())?),
        (Print::Json, None) => write_json(&Figures::from(&found), out),
        (_, None) => Ok(write_page(&found, out)?),
    }
}
