//! `[questions]`: what a scene is to answer, and how well.

use serde::{Deserialize, Serialize};

/// What `fidelity = "auto"` has to answer: outputs, each with how far it may be off. What is not asked does not count.
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
    /// Which motors fall out of step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slips: Option<bool>,
}

impl Questions {
    /// Whether nothing is asked.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
