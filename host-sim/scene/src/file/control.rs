//! Settings of the loop beside its machine: tick, limits, lines, and monitoring.

use serde::{Deserialize, Serialize};

/// Settings of the loop.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Control {
    /// Control ticks per second.
    pub tick_hz: u32,
    /// Parking phase of the cranks, degrees.
    pub park_deg: f64,
    /// Settling time of the drives after they are switched on, s.
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

/// Timing of the step lines.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pulse {
    /// Shortest time that STEP stays high, and low, ns.
    pub width_ns: f64,
    /// Setup time of DIR before STEP, ns.
    pub dir_setup_ns: f64,
    /// Hold time of DIR after STEP, ns.
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

/// Filter of the index lines.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Index {
    /// Shortest duration of a level that counts, µs. Shorter ones are glitches.
    pub width_us: f64,
}

impl Default for Index {
    fn default() -> Self {
        Self { width_us: 2.0 }
    }
}

/// Limits of the phase errors.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drift {
    /// Limit of the platform's tilt, mrad.
    pub tilt_limit_mrad: f64,
    /// Limit of the warp, degrees: the deviation of a crank from the plane through all.
    pub warp_limit_deg: f64,
    /// Limit of the mean lag of all cranks, degrees.
    pub common_limit_deg: f64,
    /// Greatest error of a reading by noise, degrees.
    pub reading_error_deg: f64,
    /// Delay with which all cranks follow their commands in normal operation, µs.
    pub lag_us: f64,
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
