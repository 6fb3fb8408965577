//! What the loop is given beside its machine: its tick, its limits, its lines, and what it watches.

use serde::{Deserialize, Serialize};

/// The loop.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Control {
    /// Control ticks a second.
    pub tick_hz: u32,
    /// Crank phase at which the machine parks, degrees.
    pub park_deg: f64,
    /// Time that energised drives get to settle, s.
    pub settle_s: f64,
}

impl Default for Control {
    fn default() -> Self {
        Self {
            tick_hz: 2000,
            park_deg: 180.0,
            settle_s: 0.1,
        }
    }
}

/// What the master shaft may do.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Greatest speed, rev/s.
    pub speed_hz: f64,
    /// Greatest acceleration, rev/s².
    pub acceleration_hz_per_s: f64,
    /// Greatest jerk, rev/s³.
    pub jerk_hz_per_s2: f64,
    /// Greatest acceleration of a stop that a fault asks for, rev/s²: what the motors' torque allows; the usual one
    /// unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_acceleration_hz_per_s: Option<f64>,
    /// Its greatest jerk, rev/s³; the usual one unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_jerk_hz_per_s2: Option<f64>,
    /// Speed of the slow turn that finds index pulses and the parking phase, rev/s.
    #[serde(default = "default_homing_speed_hz")]
    pub homing_speed_hz: f64,
    /// Speeds at which the machine must not dwell, lowest first.
    #[serde(default, rename = "band", skip_serializing_if = "Vec::is_empty")]
    pub band: Vec<Band>,
}

/// A forbidden band of speeds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Lower edge, rev/s.
    pub from_hz: f64,
    /// Upper edge, rev/s.
    pub to_hz: f64,
}

/// Timing of the step lines.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pulse {
    /// Shortest time that STEP stays high, and low, ns.
    pub width_ns: f64,
    /// DIR before STEP, ns.
    pub dir_setup_ns: f64,
    /// DIR after STEP, ns.
    pub dir_hold_ns: f64,
}

impl Default for Pulse {
    fn default() -> Self {
        Self {
            width_ns: 400.0,
            dir_setup_ns: 500.0,
            dir_hold_ns: 500.0,
        }
    }
}

/// What counts as a pulse of an index line.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Index {
    /// Shortest time that a level must last to be no glitch, µs.
    pub width_us: f64,
}

impl Default for Index {
    fn default() -> Self {
        Self { width_us: 2.0 }
    }
}

/// How far the cranks may be apart.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drift {
    /// Platform tilt, mrad.
    pub tilt_limit_mrad: f64,
    /// Deviation of a crank from the plane through all, degrees.
    pub warp_limit_deg: f64,
    /// Mean lag of all, degrees.
    pub common_limit_deg: f64,
    /// What a reading may be off by, from noise alone, degrees.
    pub reading_error_deg: f64,
    /// Time by which all cranks follow late by their nature, µs.
    pub lag_us: f64,
}

/// What is done against drift.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Correction {
    /// Part of a difference between cranks that is trimmed away in a turn; 0 is never.
    pub gain: f64,
    /// Whether homing moves each crank by an amount of its own, and checks that this crank follows.
    pub prove_wiring: bool,
    /// Cross-coupling of servos: its gains are derived from [axes.servo], but for those that are given.
    pub couple: bool,
    /// Setpoint against what an axis is off from the mean of all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupling: Option<f64>,
    /// … and against that integrated, 1/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupling_per_s: Option<f64>,
}

impl Correction {
    /// Whether nothing is done.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl Default for Drift {
    fn default() -> Self {
        Self {
            tilt_limit_mrad: 3.0,
            warp_limit_deg: 3.0,
            common_limit_deg: 15.0,
            reading_error_deg: 0.25,
            lag_us: 0.0,
        }
    }
}

const fn default_homing_speed_hz() -> f64 {
    1.0
}
