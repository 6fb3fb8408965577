//! Requirement of a platform, and the ranges of the method.
//!
//! The ranges of load, acceleration, frequency, ratio, motors and safety are the source's (steps A to C,
//! E, H, I). Gravity's range is ours: Earth's, or the round 10 m/s² behind the source's figures.

use core::f64::consts::TAU;

use cophase_scene::units::STANDARD_GRAVITY_MPS2;

use crate::design::range::{OutOfRange, Range};
use crate::numbers::number;
use host_sim::mechanism::{Load, Platform};

/// Numbers of steps A, B, C, E and H of the method, and the two that step I needs in addition.
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct Requirement {
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
    #[arg(long = "gravity", value_name = "G", allow_hyphen_values = true, value_parser = number,
          default_value_t = STANDARD_GRAVITY_MPS2)]
    pub gravity_mps2: f64,
}

/// Parses a number of motors. Its range is checked later, with all other inputs.
fn count(text: &str) -> Result<u32, &'static str> {
    text.parse().map_err(|_| "must be a whole number; try 4")
}

impl Requirement {
    /// Default safety factor, in the lower half of the source's 1.5 to 3. The platform usually weighs
    /// less than the load that it is built for, and motors are sold in steps anyway.
    pub const DEFAULT_SAFETY: f64 = 2.0;

    /// Largest acceleration, m/s² (step B).
    pub fn amax_mps2(&self) -> f64 {
        self.amax_g * self.gravity_mps2
    }

    /// Crank speed ω = 2 π f, rad/s (step D).
    pub fn speed_rad_s(&self) -> f64 {
        TAU * self.freq_hz
    }

    /// The load, for a platform on either side of the cranks.
    pub fn load(&self, platform: Platform) -> Load {
        Load {
            mass_kg: self.load_kg,
            gravity_mps2: self.gravity_mps2,
            platform,
        }
    }

    /// All numbers that are out of their ranges, in the order of the fields. Empty if there are none.
    pub fn out_of_range(&self) -> Vec<OutOfRange> {
        OutOfRange::find_all([
            (LOAD, self.load_kg),
            (AMAX, self.amax_g),
            (FREQ, self.freq_hz),
            (LAMBDA, self.lambda),
            (MOTORS, f64::from(self.motors)),
            (SAFETY, self.safety),
            (GRAVITY, self.gravity_mps2),
        ])
    }
}

const LOAD: Range = Range::above_zero(
    "--load-kg",
    50.0,
    " kg",
    "the loads this method is meant for",
    10.0,
);

const AMAX: Range = Range {
    flag: "--amax-g",
    low: 10.0,
    closed: true,
    high: 200.0,
    unit: " g",
    meaning: "the accelerations this method is meant for",
    usual: 50.0,
};

const FREQ: Range = Range::above_zero(
    "--freq-hz",
    200.0,
    " Hz",
    "the frequencies this method is meant for",
    20.0,
);

const LAMBDA: Range = Range {
    flag: "--lambda",
    low: 0.1,
    closed: true,
    high: 0.6,
    unit: "",
    meaning: "the crank/rod ratios this mechanism is built with",
    usual: 0.3,
};

const MOTORS: Range = Range {
    flag: "--motors",
    low: 2.0,
    closed: true,
    high: 6.0,
    unit: "",
    meaning: "the motors that go symmetrically around one platform",
    usual: 4.0,
};

const SAFETY: Range = Range {
    flag: "--safety",
    low: 1.5,
    closed: true,
    high: 3.0,
    unit: "",
    meaning: "the factors that cover the masses left out",
    usual: Requirement::DEFAULT_SAFETY,
};

const GRAVITY: Range = Range {
    flag: "--gravity",
    low: 9.7,
    closed: true,
    high: 10.0,
    unit: " m/s²",
    meaning: "gravity on Earth or the round figure for it",
    usual: STANDARD_GRAVITY_MPS2,
};
