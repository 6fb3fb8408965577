//! `[[program]]`: the program amax(t).

use serde::{Deserialize, Serialize};

/// Entry of the program: a level and the transition to it, or a repeated block.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Level of amax, in units of 9.80665 m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amax_g: Option<f64>,
    /// Duration of the transition, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ramp_s: Option<f64>,
    /// Duration of the hold, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold_s: Option<f64>,
    /// Shape of the transition.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// Number of times that `segments` are played.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<u32>,
    /// Repeated block; blocks may contain blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segments: Option<Vec<Segment>>,
}

/// Shape of the transition to a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// Linear in time.
    Linear,
    /// Smooth, with a continuous second derivative.
    #[default]
    Smooth,
}
