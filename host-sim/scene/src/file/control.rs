//! Settings of the loop beside its machine: limits of the shaft, and corrections. The core has the tables of the others.

use serde::{Deserialize, Serialize};

/// Limits of the master shaft.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Greatest speed, rev/s.
    pub speed_hz: f64,
    /// Greatest acceleration, rev/s².
    pub acceleration_hz_per_s: f64,
    /// Greatest jerk, rev/s³.
    pub jerk_hz_per_s2: f64,
    /// Greatest acceleration of a stop after a fault, rev/s², as the motors' torque allows. The default is the acceleration
    /// above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_acceleration_hz_per_s: Option<f64>,
    /// Greatest jerk of such a stop, rev/s³. The default is the jerk above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_jerk_hz_per_s2: Option<f64>,
    /// Homing speed, rev/s, also used to reach the parking phase.
    #[serde(default = "default_homing_speed_hz")]
    pub homing_speed_hz: f64,
    /// Forbidden bands of speeds, lowest first.
    #[serde(default, rename = "band", skip_serializing_if = "Vec::is_empty")]
    pub band: Vec<Band>,
}

/// Band of speeds at which the machine must not dwell.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Lower edge, rev/s.
    pub from_hz: f64,
    /// Upper edge, rev/s.
    pub to_hz: f64,
}

/// Corrections of phase errors.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Correction {
    /// Part of a difference between cranks that trims remove per turn; 0 for no correction.
    pub gain: f64,
    /// True if homing moves each crank by an amount of its own, and checks that this crank follows.
    pub prove_wiring: bool,
    /// True for cross-coupling of servos. Gains that are not given are derived from `[axes.servo]`.
    pub couple: bool,
    /// Proportional gain of the cross-coupling, from the deviation of an axis from the mean of all to its setpoint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupling: Option<f64>,
    /// Integral gain of the cross-coupling, 1/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupling_per_s: Option<f64>,
}

impl Correction {
    /// Returns true if there is no correction.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

const fn default_homing_speed_hz() -> f64 {
    1.0
}
