//! Self-centring vibrating screen: springs, natural speed and amplitude.
//!
//! A box on springs carries a shaft with an exciter block. The wheel on the shaft is bored off its centre. So its rim stands still in
//! space, while box and shaft circle in opposite phase to the block. The source is a Chinese thesis on a railway screen. Some of its
//! formulas are missing in the text, and are rebuilt here.
//!
//! With the exciter's mass G at R from the shaft's axis, all other vibrating mass P, stiffness K and speed ω:
//!
//! - K = G ω², so that the amplitude far above resonance is A = G R ω² / ((P + G) ω² − K) = G R / P;
//! - natural speed √(K / (P + G)) = ω √(G / (G + P));
//! - throw index A ω² / g, which should be 2.25 to 3.24 times cos a on a deck inclined by a;
//! - the rim's centre stands still if the wheel is bored off by r = A. Otherwise it circles at |A − r|.

pub mod drive;
mod output;
mod scene;
mod spring;

use core::f64::consts::TAU;

use super::range::{OutOfRange, Range};
use crate::numbers::number;

pub use spring::Spring;

/// Gravity of the source, m/s². The source's stiffnesses are in kgf/cm.
pub const GRAVITY_MPS2: f64 = 9.81;

/// Least and largest ratio of throw index to the cosine of the deck's angle that the source recommends.
const THROW: [f64; 2] = [2.25, 3.24];

/// Masses and speed of a screen
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct Requirement {
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

/// Reason why a requirement has no screen: all numbers out of their ranges, never empty. Prints a line each.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", OutOfRange::lines(.0))]
pub struct DesignError(pub Vec<OutOfRange>);

/// Screen as designed for its masses and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Requirement that it meets.
    pub requirement: Requirement,
}

impl Requirement {
    /// Distance of the bore of the source's wheel from its centre, mm.
    pub const SOURCE_WHEEL_MM: f64 = 5.0;
}

impl Design {
    /// Speed of the shaft, rad/s.
    #[must_use]
    pub fn speed_rad_s(&self) -> f64 {
        self.requirement.speed_rpm * TAU / 60.0
    }

    /// Stiffness of all springs together, N/m.
    #[must_use]
    pub fn stiffness_n_per_m(&self) -> f64 {
        self.requirement.exciter_kg * self.speed_rad_s().powi(2)
    }

    /// Stiffness of all springs together, kgf/cm.
    #[must_use]
    pub fn stiffness_kgf_per_cm(&self) -> f64 {
        self.stiffness_n_per_m() / (100.0 * GRAVITY_MPS2)
    }

    fn whole_kg(&self) -> f64 {
        self.requirement.exciter_kg + self.requirement.vibrating_kg
    }

    /// Undamped natural speed of the box on its springs, rad/s.
    #[must_use]
    pub fn natural_rad_s(&self) -> f64 {
        (self.stiffness_n_per_m() / self.whole_kg()).sqrt()
    }

    /// The same, rpm.
    #[must_use]
    pub fn natural_speed_rpm(&self) -> f64 {
        self.natural_rad_s() * 60.0 / TAU
    }

    /// Working speed over natural speed.
    #[must_use]
    pub fn speed_ratio(&self) -> f64 {
        self.speed_rad_s() / self.natural_rad_s()
    }

    /// Amplitude of the box at working speed, without damping, mm.
    #[must_use]
    pub fn amplitude_mm(&self) -> f64 {
        let requirement = &self.requirement;
        let squared = self.speed_rad_s().powi(2);
        let block = requirement.exciter_kg * requirement.eccentricity_mm * squared;
        block / (self.whole_kg() * squared - self.stiffness_n_per_m())
    }

    /// Radius at which the centre of the wheel's rim circles, mm.
    #[must_use]
    pub fn wheel_wobble_mm(&self) -> f64 {
        (self.amplitude_mm() - self.requirement.wheel_mm).abs()
    }

    /// Greatest acceleration of the box over gravity.
    #[must_use]
    pub fn throw_index(&self) -> f64 {
        1e-3 * self.amplitude_mm() * self.speed_rad_s().powi(2) / GRAVITY_MPS2
    }

    /// Least and largest throw index that the source recommends for the deck's inclination.
    #[must_use]
    pub fn recommended_throw(&self) -> Option<[f64; 2]> {
        let cosine = self.requirement.deck_deg?.to_radians().cos();
        Some(THROW.map(|throw| throw * cosine))
    }

    /// Deflection of the springs by the weight of the whole vibrating mass, mm.
    #[must_use]
    pub fn static_deflection_mm(&self) -> f64 {
        1e3 * self.whole_kg() * GRAVITY_MPS2 / self.stiffness_n_per_m()
    }
}

const EXCITER: Range = Range::above_zero(
    "--exciter-kg",
    1e4,
    " kg",
    "the masses of exciter blocks",
    166.0,
);
const VIBRATING: Range = Range::above_zero(
    "--vibrating-kg",
    1e5,
    " kg",
    "the masses of screens",
    2900.0,
);
const ECCENTRICITY: Range = Range::above_zero(
    "--eccentricity-mm",
    1e3,
    " mm",
    "the distances of a block from its shaft",
    87.0,
);
const SPEED: Range = Range::above_zero("--speed-rpm", 6e3, " rpm", "the speeds of screens", 840.0);
const WHEEL: Range = Range::above_zero(
    "--wheel-mm",
    100.0,
    " mm",
    "the distances of a bore from its wheel's centre",
    5.0,
);
const DECK: Range = Range {
    flag: "--deck-deg",
    low: 0.0,
    closed: true,
    high: 45.0,
    unit: "°",
    meaning: "the inclinations on which stones do not slide by themselves",
    usual: 24.0,
};

/// Screen for its masses and speed.
///
/// # Errors
/// Numbers out of their ranges, all of them.
pub fn design(requirement: &Requirement) -> Result<Design, DesignError> {
    let numbers = [
        (EXCITER, requirement.exciter_kg),
        (VIBRATING, requirement.vibrating_kg),
        (ECCENTRICITY, requirement.eccentricity_mm),
        (SPEED, requirement.speed_rpm),
        (WHEEL, requirement.wheel_mm),
    ];
    let deck = requirement.deck_deg.map(|deck_deg| (DECK, deck_deg));
    let wrong = OutOfRange::find_all(numbers.into_iter().chain(deck));
    if wrong.is_empty() {
        Ok(Design {
            requirement: *requirement,
        })
    } else {
        Err(DesignError(wrong))
    }
}
