//! Flywheel of a crusher on an induction motor: the motor's torque curve, the flywheel's inertia, and how evenly the shaft turns.
//!
//! The source is a Chinese paper on a jaw crusher. Its motor's torque is a parabola over the motor's speed, through no load, rated load and
//! breakdown. A belt of ratio j gives the shaft j times the torque at 1/j of the speed.
//!
//! - rated torque 9550 P / n, in N·m, kW and rpm; breakdown torque is the overload factor times that;
//! - breakdown slip is s (λ + √(λ² − 1)), with s the rated slip and λ the overload factor (Kloss);
//! - inertia of a thin rim m D² / 4, of a disc m D² / 8;
//! - irregularity (ω₁ − ω₂) / ω̄, and energy given up J (ω₁² − ω₂²) / 2 between the fastest and the slowest speed.

mod dynamic;
mod output;

use core::f64::consts::TAU;

use super::range::{OutOfRange, Range};
use crate::numbers::number;

pub use dynamic::{Dynamic, Rock, Shape, periodic};
pub use output::Flywheel;

/// Motor, belt and flywheel, and the speed range of the shaft.
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct Requirement {
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
    /// Fastest and slowest speed of the shaft, rad/s. `None` if they are not known.
    #[arg(skip)]
    pub speeds_rad_s: Option<[f64; 2]>,
}

/// Reason why a requirement has no design.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Numbers out of their ranges: all of them, never empty. Prints a line each.
    #[error("{}", OutOfRange::lines(.0))]
    OutOfRange(Vec<OutOfRange>),
    /// The rated speed is not below the synchronous speed. A driving motor is slower than its field.
    #[error(
        "--rated-rpm {rated_rpm}: must be below --synchronous-rpm, {synchronous_rpm}; a motor under load slips"
    )]
    NoSlip {
        /// Rated speed that was given, rpm.
        rated_rpm: f64,
        /// Synchronous speed that was given, rpm.
        synchronous_rpm: f64,
    },
    /// The breakdown speed of the motor would be below standstill.
    #[error(
        "--rated-rpm {0}: with this --overload the motor would break down below standstill; give a rated speed nearer the synchronous one"
    )]
    Slip(f64),
    /// The shaft's speeds are in the wrong order.
    #[error("--slowest-rad-s {slowest}: must be below --fastest-rad-s, {fastest}")]
    Order {
        /// Slowest speed that was given, rad/s.
        slowest: f64,
        /// Fastest speed that was given, rad/s.
        fastest: f64,
    },
    /// The motor cannot break rock of that peak force, in kN.
    #[error(
        "--rock-kn {0}: brings the shaft to rest; lower it, or give a stronger motor or a heavier flywheel"
    )]
    Stalls(f64),
    /// No flywheel within a thousand times the given one keeps the irregularity.
    #[error("--irregularity {0}: no flywheel keeps it under this rock; allow more")]
    Irregularity(f64),
}

/// Torque of the motor over its speed, M = a ω² + b ω + c, N·m and rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueCurve {
    /// Coefficients a, b and c.
    pub coefficients: [f64; 3],
}

impl TorqueCurve {
    /// Parabola through three points, each a speed and a torque.
    #[must_use]
    pub fn through(points: [[f64; 2]; 3]) -> Self {
        let [[x0, y0], [x1, y1], [x2, y2]] = points;
        // Newton's divided differences.
        let first = (y1 - y0) / (x1 - x0);
        let second = ((y2 - y1) / (x2 - x1) - first) / (x2 - x0);
        Self {
            coefficients: [
                second,
                first - second * (x0 + x1),
                y0 - first * x0 + second * x0 * x1,
            ],
        }
    }

    /// Torque at a speed of the motor.
    #[must_use]
    pub fn at(&self, motor_rad_s: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        (a * motor_rad_s + b) * motor_rad_s + c
    }
}

/// Drive and flywheel of a crusher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Requirement that it meets.
    pub requirement: Requirement,
    /// Torque of the motor.
    pub curve: TorqueCurve,
}

impl Design {
    /// Speed of the shaft without load, rad/s.
    #[must_use]
    pub fn synchronous_rad_s(&self) -> f64 {
        self.requirement.synchronous_rpm * TAU / 60.0 / self.requirement.belt_ratio
    }

    /// Speed of the shaft at rated load, rad/s.
    #[must_use]
    pub fn rated_rad_s(&self) -> f64 {
        self.requirement.rated_rpm * TAU / 60.0 / self.requirement.belt_ratio
    }

    /// Rated torque of the motor, N·m.
    #[must_use]
    pub fn rated_torque_nm(&self) -> f64 {
        rated_nm(&self.requirement)
    }

    /// Breakdown torque of the motor, N·m.
    #[must_use]
    pub fn breakdown_torque_nm(&self) -> f64 {
        self.requirement.overload * self.rated_torque_nm()
    }

    /// Speed of the motor at breakdown, rad/s.
    #[must_use]
    pub fn breakdown_motor_rad_s(&self) -> f64 {
        breakdown_rad_s(&self.requirement)
    }

    /// Torque on the shaft at a speed of the shaft, N·m.
    #[must_use]
    pub fn shaft_torque_nm(&self, shaft_rad_s: f64) -> f64 {
        let ratio = self.requirement.belt_ratio;
        ratio * self.curve.at(ratio * shaft_rad_s)
    }

    /// Inertia of the flywheel if its mass is a thin rim, kg·m².
    #[must_use]
    pub fn rim_kgm2(&self) -> f64 {
        self.requirement.mass_kg * self.requirement.diameter_m.powi(2) / 4.0
    }

    /// The same if it is a disc, kg·m².
    #[must_use]
    pub fn disc_kgm2(&self) -> f64 {
        0.5 * self.rim_kgm2()
    }

    /// Difference of the fastest and the slowest speed over their mean.
    #[must_use]
    pub fn irregularity(&self) -> Option<f64> {
        let [fastest, slowest] = self.requirement.speeds_rad_s?;
        Some((fastest - slowest) / (0.5 * (fastest + slowest)))
    }

    /// Energy that the rim gives up between the fastest and the slowest speed, J.
    #[must_use]
    pub fn energy_swing_j(&self) -> Option<f64> {
        let [fastest, slowest] = self.requirement.speeds_rad_s?;
        Some(0.5 * self.rim_kgm2() * (fastest * fastest - slowest * slowest))
    }
}

fn rated_nm(requirement: &Requirement) -> f64 {
    9550.0 * requirement.power_kw / requirement.rated_rpm
}

/// Breakdown slip over synchronous speed.
fn breakdown_slip(requirement: &Requirement) -> f64 {
    let slip = 1.0 - requirement.rated_rpm / requirement.synchronous_rpm;
    let overload = requirement.overload;
    slip * (overload + (overload * overload - 1.0).sqrt())
}

fn breakdown_rad_s(requirement: &Requirement) -> f64 {
    requirement.synchronous_rpm * TAU / 60.0 * (1.0 - breakdown_slip(requirement))
}

const POWER: Range = Range::above_zero(
    "--power-kw",
    1e4,
    " kW",
    "the powers of crusher motors",
    15.0,
);
const RATED: Range = Range::above_zero(
    "--rated-rpm",
    12e3,
    " rpm",
    "the speeds of induction motors",
    970.0,
);
const SYNCHRONOUS: Range = Range::above_zero(
    "--synchronous-rpm",
    12e3,
    " rpm",
    "the speeds of induction motors",
    1000.0,
);
const MASS: Range = Range::above_zero("--mass-kg", 1e5, " kg", "the masses of flywheels", 280.0);
const DIAMETER: Range = Range::above_zero(
    "--diameter-m",
    20.0,
    " m",
    "the diameters of flywheels",
    0.8,
);
const FASTEST: Range = Range::above_zero(
    "--fastest-rad-s",
    1e3,
    " rad/s",
    "the speeds of crusher shafts",
    28.0,
);
const SLOWEST: Range = Range::above_zero(
    "--slowest-rad-s",
    1e3,
    " rad/s",
    "the speeds of crusher shafts",
    26.0,
);
const OVERLOAD: Range = Range {
    flag: "--overload",
    low: 1.1,
    closed: true,
    high: 5.0,
    unit: "",
    meaning: "the breakdown torques of induction motors over their rated torques",
    usual: 2.0,
};
const BELT: Range = Range {
    flag: "--belt-ratio",
    low: 0.1,
    closed: true,
    high: 100.0,
    unit: "",
    meaning: "the ratios of belts and gears",
    usual: 3.7,
};

/// Motor curve and flywheel.
///
/// # Errors
/// Numbers out of their ranges, all of them; or numbers that are inconsistent.
pub fn design(requirement: &Requirement) -> Result<Design, DesignError> {
    let numbers = [
        (POWER, requirement.power_kw),
        (RATED, requirement.rated_rpm),
        (SYNCHRONOUS, requirement.synchronous_rpm),
        (OVERLOAD, requirement.overload),
        (BELT, requirement.belt_ratio),
        (MASS, requirement.mass_kg),
        (DIAMETER, requirement.diameter_m),
    ];
    let speeds = requirement.speeds_rad_s.into_iter();
    let speeds = speeds.flat_map(|[fastest, slowest]| [(FASTEST, fastest), (SLOWEST, slowest)]);
    let wrong = OutOfRange::find_all(numbers.into_iter().chain(speeds));
    if !wrong.is_empty() {
        return Err(DesignError::OutOfRange(wrong));
    }
    let Requirement {
        rated_rpm,
        synchronous_rpm,
        ..
    } = *requirement;
    if rated_rpm >= synchronous_rpm {
        return Err(DesignError::NoSlip {
            rated_rpm,
            synchronous_rpm,
        });
    }
    if breakdown_slip(requirement) >= 1.0 {
        return Err(DesignError::Slip(rated_rpm));
    }
    if let Some([fastest, slowest]) = requirement.speeds_rad_s
        && slowest >= fastest
    {
        return Err(DesignError::Order { slowest, fastest });
    }
    let rated_nm = rated_nm(requirement);
    let curve = TorqueCurve::through([
        [synchronous_rpm * TAU / 60.0, 0.0],
        [rated_rpm * TAU / 60.0, rated_nm],
        [
            breakdown_rad_s(requirement),
            requirement.overload * rated_nm,
        ],
    ]);
    Ok(Design {
        requirement: *requirement,
        curve,
    })
}
