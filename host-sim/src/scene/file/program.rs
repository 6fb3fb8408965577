//! `[[program]]`: amax(t).

use serde::{Deserialize, Serialize};

/// An entry of the program: a level and the way to it, or a block that is repeated.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Level, in units of 9.80665 m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amax_g: Option<f64>,
    /// Time to get there, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ramp_s: Option<f64>,
    /// Time to stay there, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold_s: Option<f64>,
    /// Shape of the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// How often `segments` are played in all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<u32>,
    /// The block that is repeated; blocks may hold blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segments: Option<Vec<Segment>>,
}

/// Shape of the way to a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// In proportion to time.
    Linear,
    /// With continuous second derivative.
    #[default]
    Smooth,
}
