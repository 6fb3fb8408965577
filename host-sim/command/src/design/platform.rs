//! `cophase design` without a machine's name: the vibration platform on slider-cranks.

use std::io::Write;
use std::path::PathBuf;

use cophase_core::settings::Transmission;
use cophase_files::report::draw_operating_range;
use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use host_sim::design::OutOfRange;
use host_sim::design::platform::{Design, MotorChoice, Requirement, design, write_page};
use host_sim::mechanism::Mechanism;
use host_sim::operating_range::OperatingRange;
use host_sim::setup::checked_from_text;
use host_sim::setup::runnable;
use serde::Serialize;

use super::{DesignCommandError, Print, write_json};
use crate::numbers::{number, whole};
use crate::output::write_file;

/// Requirement of a vibration platform.
#[derive(Clone, Debug, clap::Args)]
pub struct PlatformArgs {
    /// Load on the platform, kg: above 0, up to 50
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub load_kg: f64,
    /// Largest acceleration, in multiples of gravity: 10 to 200
    #[arg(long, value_name = "A", allow_hyphen_values = true, value_parser = number)]
    pub amax_g: f64,
    /// Frequency of the platform, Hz: above 0, up to 200
    #[arg(long, value_name = "F", allow_hyphen_values = true, value_parser = number)]
    pub freq_hz: f64,
    /// Crank radius over rod length: 0.1 to 0.6. Small is smoother and takes longer rods; 0.25 is usual
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = number)]
    pub lambda: f64,
    /// Motors around the platform: 2 to 6
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = count)]
    pub motors: u32,
    /// Factor on the motor torque for the masses left out: 1.5 to 3
    #[arg(long, value_name = "K", allow_hyphen_values = true, value_parser = number,
          default_value_t = Requirement::DEFAULT_SAFETY)]
    pub safety: f64,
    /// Gravity, m/s²: 9.7 to 10
    #[arg(long, value_name = "G", allow_hyphen_values = true, value_parser = number,
          default_value_t = STANDARD_GRAVITY_MPS2)]
    pub gravity: f64,
    /// Belt or gearbox: turns of the motor and of the crank that belong together, such as 57:11
    #[arg(long, value_name = "M:C", value_parser = gear, default_value = "1:1")]
    pub gear: Transmission,
    /// Steps, or counts, per turn of the motor: 4 to 1,048,576
    #[arg(long, value_name = "S", value_parser = whole::<u32>(4..=1_048_576), default_value_t = 3200)]
    pub steps_per_turn: u32,
    /// Inertia of the motor, kg·m²: above 0, up to 1000
    #[arg(long, value_name = "J", allow_hyphen_values = true, value_parser = number)]
    pub rotor_inertia_kgm2: Option<f64>,
    /// Draw required and available torque, amplitude and step rate over speed into this file, too
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}

/// Parses a number of motors. Its range is checked later, with all other inputs.
fn count(text: &str) -> Result<u32, &'static str> {
    text.parse().map_err(|_| "must be a whole number; try 4")
}

/// Parses `M:C`.
fn gear(text: &str) -> Result<Transmission, &'static str> {
    let turns = |part: &str| part.trim().parse::<u32>().ok();
    let pair = text
        .split_once(':')
        .and_then(|(motor, crank)| Some((turns(motor)?, turns(crank)?)));
    let (motor_turns, crank_turns) =
        pair.ok_or("give turns of the motor and of the crank, such as 57:11")?;
    Ok(Transmission {
        motor_turns,
        crank_turns,
    })
}

impl From<&PlatformArgs> for MotorChoice {
    fn from(args: &PlatformArgs) -> Self {
        Self {
            gear: args.gear,
            steps_per_turn: args.steps_per_turn,
            rotor_inertia_kgm2: args.rotor_inertia_kgm2,
        }
    }
}

impl From<&PlatformArgs> for Requirement {
    fn from(args: &PlatformArgs) -> Self {
        Self {
            load_kg: args.load_kg,
            amax_g: args.amax_g,
            freq_hz: args.freq_hz,
            lambda: args.lambda,
            motors: args.motors,
            safety: args.safety,
            gravity_mps2: args.gravity,
        }
    }
}

/// The object that `--json` prints.
#[derive(Serialize)]
struct Figures {
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

impl Figures {
    fn new(design: &Design, motor: &MotorChoice) -> Self {
        let warnings = design.warnings(motor);
        Self {
            gravity_mps2: design.requirement.gravity_mps2,
            crank_radius_mm: 1e3 * design.mechanism.crank_radius_m(),
            rod_length_mm: 1e3 * design.mechanism.rod_length_m(),
            speed_rad_s: design.speed_rad_s(),
            torque_max_two_term_nm: design.torque_two_term.value,
            torque_max_exact_nm: design.torque_exact_below.value,
            motor_torque_nm: design.motor_torque_nm(),
            motor_torque_with_safety_nm: design.motor_torque_with_safety_nm(),
            peak_power_w: design.peak_power_w(),
            step_rate_max_hz: motor.step_rate_hz(design),
            electrical_cycle_deg: motor.electrical_cycle_deg(),
            torque_required_nm: motor.torque_nm(design),
            inertia_ratio: motor.inertia_ratio(design),
            warnings: warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

/// Operating range of a design, as SVG text: that of its scene.
fn picture(design: &Design, motor: &MotorChoice) -> Result<String, DesignCommandError> {
    let scene = runnable(design.scene(motor)).map_err(|error| {
        DesignCommandError::Input(format!(
            "--svg: the picture is that of the design's scene. {error}"
        ))
    })?;
    let range =
        checked_from_text(&scene, None).and_then(|checked| OperatingRange::for_scene(&checked));
    match range.map_err(DesignCommandError::input)? {
        Some(range) => Ok(draw_operating_range(&range)),
        None => Err(DesignCommandError::Input(
            "--svg: the torque of the design's motors is not known".to_owned(),
        )),
    }
}

/// Designs the requested platform. Writes text, one JSON object or a scene to `out`, and a picture to the file of `--svg`.
///
/// In the object, `torque_max_exact_nm` has the source's gravity sign (platform below the cranks), as
/// `torque_max_two_term_nm` has; `peak_power_w` is that of a platform above, all motors together, without
/// the safety factor.
///
/// # Errors
/// Bad input, before anything is written; or `out` cannot be written.
pub(super) fn run(
    args: &PlatformArgs,
    print: Print,
    out: &mut impl Write,
) -> Result<(), DesignCommandError> {
    let found = design(&args.into()).map_err(DesignCommandError::input)?;
    let motor = MotorChoice::from(args);
    let wrong = motor.out_of_range();
    if !wrong.is_empty() {
        return Err(DesignCommandError::Input(
            OutOfRange::lines(&wrong).to_string(),
        ));
    }
    let scene = match print {
        Print::Scene => Some(runnable(found.scene(&motor)).map_err(DesignCommandError::input)?),
        Print::Page | Print::Json => None,
    };
    if let Some(file) = &args.svg {
        write_file("--svg", file, picture(&found, &motor)?.as_bytes())?;
    }
    match (print, scene) {
        (_, Some(scene)) => Ok(out.write_all(scene.as_bytes())?),
        (Print::Json, None) => write_json(&Figures::new(&found, &motor), out),
        (_, None) => Ok(write_page(&found, &motor, out)?),
    }
}
