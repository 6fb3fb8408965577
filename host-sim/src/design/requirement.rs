//! What the platform must do, and within which ranges the method answers.
//!
//! The ranges of load, acceleration, frequency, ratio, motors and safety are the source's (steps A to C,
//! E, H, I). Gravity's range is ours: Earth's, or the round 10 m/s² behind the source's figures.

use core::f64::consts::TAU;
use core::fmt;

use super::digits::plain;
use crate::mechanism::{Load, Platform};

/// Standard gravity, m/s².
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;

/// Steps A, B, C, E and H of the method, and the two numbers step I needs besides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirement {
    /// Mass of the load on the platform, kg: above 0, up to 50.
    pub load_kg: f64,
    /// Largest acceleration, in multiples of `gravity_mps2`: 10 to 200.
    pub amax_g: f64,
    /// Strokes a second, Hz: above 0, up to 200. The cranks turn as often.
    pub freq_hz: f64,
    /// Crank radius over rod length: 0.1 to 0.6.
    pub lambda: f64,
    /// Motors around the platform: 2 to 6.
    pub motors: u32,
    /// Factor on the torque for the masses left out: 1.5 to 3.
    pub safety: f64,
    /// Gravity, m/s²: 9.7 to 10. Both the unit of `amax_g` and a force on the load.
    pub gravity_mps2: f64,
}

impl Requirement {
    /// Safety factor where none is requested, in the lower half of the source's 1.5 to 3: the platform
    /// usually weighs less than the load it is built for, and motors are bought in steps anyway.
    pub const DEFAULT_SAFETY: f64 = 2.0;

    /// Largest acceleration, m/s² (step B).
    pub fn amax_mps2(&self) -> f64 {
        self.amax_g * self.gravity_mps2
    }

    /// Crank speed ω = 2 π f, rad/s (step D).
    pub fn speed_rad_s(&self) -> f64 {
        TAU * self.freq_hz
    }

    /// The load, for a platform on one side of the cranks or the other.
    pub fn load(&self, platform: Platform) -> Load {
        Load {
            mass_kg: self.load_kg,
            gravity_mps2: self.gravity_mps2,
            platform,
        }
    }

    /// Every quantity that is out of its range, in the order of the fields; empty if all is well.
    pub fn out_of_range(&self) -> Vec<OutOfRange> {
        Quantity::ALL
            .into_iter()
            .map(|quantity| OutOfRange {
                quantity,
                value: quantity.of(self),
            })
            .filter(|candidate| !candidate.quantity.admits(candidate.value))
            .collect()
    }
}

/// A quantity of the [`Requirement`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// `load_kg`
    Load,
    /// `amax_g`
    Amax,
    /// `freq_hz`
    Freq,
    /// `lambda`
    Lambda,
    /// `motors`
    Motors,
    /// `safety`
    Safety,
    /// `gravity_mps2`
    Gravity,
}

/// What there is to know about a quantity's range.
struct Range {
    flag: &'static str,
    low: f64,
    /// Whether `low` itself is in the range.
    closed: bool,
    high: f64,
    /// Unit, with the space that goes before it.
    unit: &'static str,
    /// What the range is, in a few words.
    meaning: &'static str,
    /// A value that works, for input that is not finite or lies below an open end.
    usual: f64,
}

impl Quantity {
    const ALL: [Self; 7] = [
        Self::Load,
        Self::Amax,
        Self::Freq,
        Self::Lambda,
        Self::Motors,
        Self::Safety,
        Self::Gravity,
    ];

    /// The command-line flag that sets it.
    pub fn flag(self) -> &'static str {
        self.range().flag
    }

    fn of(self, requirement: &Requirement) -> f64 {
        match self {
            Self::Load => requirement.load_kg,
            Self::Amax => requirement.amax_g,
            Self::Freq => requirement.freq_hz,
            Self::Lambda => requirement.lambda,
            Self::Motors => f64::from(requirement.motors),
            Self::Safety => requirement.safety,
            Self::Gravity => requirement.gravity_mps2,
        }
    }

    fn range(self) -> Range {
        match self {
            Self::Load => Range {
                flag: "--load-kg",
                low: 0.0,
                closed: false,
                high: 50.0,
                unit: " kg",
                meaning: "the loads this method is meant for",
                usual: 10.0,
            },
            Self::Amax => Range {
                flag: "--amax-g",
                low: 10.0,
                closed: true,
                high: 200.0,
                unit: " g",
                meaning: "the accelerations this method is meant for",
                usual: 50.0,
            },
            Self::Freq => Range {
                flag: "--freq-hz",
                low: 0.0,
                closed: false,
                high: 200.0,
                unit: " Hz",
                meaning: "the frequencies this method is meant for",
                usual: 20.0,
            },
            Self::Lambda => Range {
                flag: "--lambda",
                low: 0.1,
                closed: true,
                high: 0.6,
                unit: "",
                meaning: "the crank/rod ratios this mechanism is built with",
                usual: 0.3,
            },
            Self::Motors => Range {
                flag: "--motors",
                low: 2.0,
                closed: true,
                high: 6.0,
                unit: "",
                meaning: "the motors that go symmetrically around one platform",
                usual: 4.0,
            },
            Self::Safety => Range {
                flag: "--safety",
                low: 1.5,
                closed: true,
                high: 3.0,
                unit: "",
                meaning: "the factors that cover the masses left out",
                usual: Requirement::DEFAULT_SAFETY,
            },
            Self::Gravity => Range {
                flag: "--gravity",
                low: 9.7,
                closed: true,
                high: 10.0,
                unit: " m/s²",
                meaning: "gravity on Earth or the round figure for it",
                usual: STANDARD_GRAVITY_MPS2,
            },
        }
    }

    /// Whether `value` is in range; NaN and infinities are not.
    fn admits(self, value: f64) -> bool {
        let Range {
            low, closed, high, ..
        } = self.range();
        value <= high && (value > low || (closed && value == low))
    }
}

/// A quantity out of its range, and the value it had.
///
/// Prints as `--lambda 0.7: outside 0.1 to 0.6, the crank/rod ratios this mechanism is built with; try
/// 0.6`: the nearer end is suggested if it is in the range, else a usual value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// Which quantity.
    pub quantity: Quantity,
    /// What was requested.
    pub value: f64,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let range = self.quantity.range();
        let Range {
            flag, low, high, ..
        } = range;
        let Range { unit, meaning, .. } = range;
        let end = if range.closed {
            ""
        } else {
            " (0 itself excluded)"
        };
        let try_this = if !self.value.is_finite() {
            range.usual
        } else if self.value > high {
            high
        } else if range.closed {
            low
        } else {
            range.usual
        };
        let value = plain(self.value);
        write!(
            f,
            "{flag} {value}: outside {low} to {high}{unit}{end}, {meaning}; try {try_this}"
        )
    }
}
