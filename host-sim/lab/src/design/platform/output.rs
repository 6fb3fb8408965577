//! A platform as a page, as an object, as a scene and as a picture.

use std::io::{self, Write};
use std::path::PathBuf;

use cophase_files::report::draw_operating_range;
use host_sim::mechanism::Mechanism;
use host_sim::operating_range::OperatingRange;
use host_sim::setup::checked_from_text;
use serde::Serialize;

use super::page::write_page;
use super::{Design, MotorChoice, Requirement, design};
use crate::design::scene::runnable;
use crate::design::{Method, OutOfRange, Refused};

/// Requirement of a vibration platform.
#[derive(Clone, Debug, clap::Args)]
#[group(arg = "load_kg")] // the group, which tells whether these options were given, has no flattened ones by itself
pub struct Platform {
    #[command(flatten)]
    requirement: Requirement,
    #[command(flatten)]
    motor: MotorChoice,
    /// Draw required and available torque, amplitude and step rate over speed into this file, too
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

/// The object that `--json` prints.
#[derive(Serialize)]
pub struct Figures {
    gravity_mps2: f64,
    crank_radius_mm: f64,
    rod_length_mm: f64,
    speed_rad_s: f64,
    torque_max_two_term_nm: f64,
    /// With the source's gravity sign: platform below.
    torque_max_exact_nm: f64,
    motor_torque_nm: f64,
    motor_torque_with_safety_nm: f64,
    /// Platform above, all motors together.
    peak_power_w: f64,
    /// Figures of the motor behind its gear.
    step_rate_max_hz: f64,
    electrical_cycle_deg: f64,
    torque_required_nm: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia_ratio: Option<f64>,
    warnings: Vec<String>,
}

/// In the object, `torque_max_exact_nm` has the source's gravity sign (platform below the cranks), as `torque_max_two_term_nm` has;
/// `peak_power_w` is that of a platform above, all motors together, without the safety factor.
impl Method for Platform {
    type Design = Design;
    type Figures = Figures;

    fn design(&self) -> Result<Design, Refused> {
        let design = design(&self.requirement)?;
        let wrong = self.motor.out_of_range();
        if wrong.is_empty() {
            Ok(design)
        } else {
            Err(Refused(OutOfRange::lines(&wrong)))
        }
    }

    fn figures(&self, design: &Design) -> Figures {
        let warnings = design.warnings(&self.motor);
        Figures {
            gravity_mps2: design.requirement.gravity_mps2,
            crank_radius_mm: 1e3 * design.mechanism.crank_radius_m(),
            rod_length_mm: 1e3 * design.mechanism.rod_length_m(),
            speed_rad_s: design.speed_rad_s(),
            torque_max_two_term_nm: design.torque_two_term.value,
            torque_max_exact_nm: design.torque_exact_below.value,
            motor_torque_nm: design.motor_torque_nm(),
            motor_torque_with_safety_nm: design.motor_torque_with_safety_nm(),
            peak_power_w: design.peak_power_w(),
            step_rate_max_hz: self.motor.step_rate_hz(design),
            electrical_cycle_deg: self.motor.electrical_cycle_deg(),
            torque_required_nm: self.motor.torque_nm(design),
            inertia_ratio: self.motor.inertia_ratio(design),
            warnings: warnings.iter().map(ToString::to_string).collect(),
        }
    }

    fn write_page(&self, design: &Design, out: &mut dyn Write) -> io::Result<()> {
        write_page(design, &self.motor, out)
    }

    fn scene(&self, design: &Design) -> Result<String, Refused> {
        Ok(design.scene(&self.motor))
    }

    /// Draws the operating range of the design's scene.
    fn drawing(&self, design: &Design) -> Result<Option<(PathBuf, String)>, Refused> {
        let Some(file) = self.svg.clone() else {
            return Ok(None);
        };
        let scene = runnable(design.scene(&self.motor)).map_err(|error| {
            Refused(format!(
                "--svg: the picture is that of the design's scene. {error}"
            ))
        })?;
        let checked = checked_from_text(&scene, None)?;
        let range = OperatingRange::for_scene(&checked)?.ok_or_else(|| {
            Refused("--svg: the torque of the design's motors is not known".to_owned())
        })?;
        Ok(Some((file, draw_operating_range(&range))))
    }
}
