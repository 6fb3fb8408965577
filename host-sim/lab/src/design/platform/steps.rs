//! From requirement to design: steps D, F, G and I, which compute. Step J is the task of the rest of this
//! project. Here it appears as speeds to reach and as a mismatch limit.
//!
//! Three torque curves are searched, because the source's formula differs from the true one in two ways.
//! It ends after two harmonics of the acceleration, and its gravity sign is that of a platform hanging
//! below its cranks. The source's own curve (two-term, below) sizes the motors, as in the source.

use super::requirement::Requirement;
use crate::design::range::OutOfRange;
use host_sim::mechanism::slider_crank::{SliderCrank, SliderCrankError};
use host_sim::mechanism::turn_search::{TurnPeak, max_over_turn};
use host_sim::mechanism::{Mechanism, Platform};

/// Reason why a requirement has no design.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Quantities out of their ranges: all of them, never empty. Prints a line each.
    #[error("{}", OutOfRange::lines(.0))]
    OutOfRange(Vec<OutOfRange>),
    /// A frequency so near 0 that `f64` cannot represent the crank's length.
    #[error("--freq-hz {freq_hz:e}: too slow for any crank ({source}); try 20")]
    NoCrank {
        /// The requested frequency, Hz.
        freq_hz: f64,
        /// Error of the crank.
        source: SliderCrankError,
    },
    /// A load so near 0 that torques underflow.
    #[error("--load-kg {0:e}: too light to compute a torque for; try 10")]
    NoTorque(f64),
}

/// A platform that meets its requirement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Requirement that it meets.
    pub requirement: Requirement,
    /// Crank and rod (steps F and G).
    pub mechanism: SliderCrank,
    /// Highest torque of all cranks together over a turn, N·m, with its angle: the source's two-term
    /// formula, platform below (step I).
    pub torque_two_term: TurnPeak,
    /// The same with exact acceleration, and the source's gravity sign: platform below.
    pub torque_exact_below: TurnPeak,
    /// The same with exact acceleration, platform above.
    pub torque_exact_above: TurnPeak,
}

impl Design {
    /// Crank speed ω = 2 π f, rad/s (step D).
    pub fn speed_rad_s(&self) -> f64 {
        self.requirement.speed_rad_s()
    }

    /// Crank speed, turns a minute.
    pub fn speed_rpm(&self) -> f64 {
        60.0 * self.requirement.freq_hz
    }

    /// One motor's share of a torque or power of all cranks.
    pub fn per_motor(&self, total: f64) -> f64 {
        total / f64::from(self.requirement.motors)
    }

    /// Torque of one motor, N·m: the two-term maximum over N, as in the source (step I).
    pub fn motor_torque_nm(&self) -> f64 {
        self.per_motor(self.torque_two_term.value)
    }

    /// Torque for the choice of the motor, N·m: [`Design::motor_torque_nm`] times the safety factor.
    pub fn motor_torque_with_safety_nm(&self) -> f64 {
        self.requirement.safety * self.motor_torque_nm()
    }

    /// Highest mechanical power of all cranks together, W: largest |M| over a turn times ω, exact
    /// kinematics, platform above, without the safety factor. The same power flows back in the same turn.
    pub fn peak_power_w(&self) -> f64 {
        // Torque is odd in the angle, so the largest value is also the largest magnitude.
        self.torque_exact_above.value * self.speed_rad_s()
    }
}

/// Sizes the platform (source, steps A to I).
///
/// Torque maxima are those of the whole turn, to 1e-13 of themselves: see
/// [`max_over_turn`]. Refuses, with all reasons at once, quantities out of the ranges that
/// [`Requirement`] states, and numbers so near 0 that nothing can be computed from them.
///
/// ```
/// use crate::design::platform::{Requirement, design};
/// let found = design(&Requirement {
///     load_kg: 10.0,
///     amax_g: 10.0,
///     freq_hz: 5.0,
///     lambda: 0.3,
///     motors: 3,
///     safety: Requirement::DEFAULT_SAFETY,
///     gravity_mps2: 10.0,
/// })?;
/// assert_eq!(format!("{:.0}", found.motor_torque_nm()), "15");
/// # Ok::<(), crate::design::platform::DesignError>(())
/// ```
pub fn design(requirement: &Requirement) -> Result<Design, DesignError> {
    let out_of_range = requirement.out_of_range();
    if !out_of_range.is_empty() {
        return Err(DesignError::OutOfRange(out_of_range));
    }
    let freq_hz = requirement.freq_hz;
    let omega = requirement.speed_rad_s();
    let mechanism = SliderCrank::for_amax(requirement.amax_mps2(), omega, requirement.lambda)
        .map_err(|source| DesignError::NoCrank { freq_hz, source })?;
    let below = requirement.load(Platform::Below);
    let above = requirement.load(Platform::Above);
    let found = Design {
        requirement: *requirement,
        mechanism,
        torque_two_term: max_over_turn(|a| mechanism.torque_two_term_nm(&below, a, omega)),
        torque_exact_below: max_over_turn(|a| mechanism.torque_nm(&below, a, omega, 0.0)),
        torque_exact_above: max_over_turn(|a| mechanism.torque_nm(&above, a, omega, 0.0)),
    };
    let torque_nm = found.torque_exact_above.value;
    if torque_nm.is_normal() && found.motor_torque_nm().is_normal() {
        Ok(found)
    } else {
        Err(DesignError::NoTorque(requirement.load_kg))
    }
}
