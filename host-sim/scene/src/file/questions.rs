//! `[questions]`: outputs that a scene requests, with their tolerances.

use serde::{Deserialize, Serialize};

/// Requested outputs for `fidelity = "auto"`, each with its tolerance. Other outputs do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Questions {
    /// Largest lag of a crank behind its command, or lead, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lag_deg: Option<f64>,
    /// Largest difference between two cranks' lags, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread_deg: Option<f64>,
    /// Largest tilt of the platform, mrad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_mrad: Option<f64>,
    /// Largest acceleration of the platform, percent of itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amax_percent: Option<f64>,
    /// Largest torque of a motor, percent of itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_percent: Option<f64>,
    /// Largest force on the ground beyond the weight, percent of itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_percent: Option<f64>,
    /// True if the set of motors that slip is requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slips: Option<bool>,
}

impl Questions {
    /// Returns true if no output is requested.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
