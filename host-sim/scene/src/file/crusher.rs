//! Scene table `[crusher]`: a jaw crusher.

use serde::{Deserialize, Serialize};

use super::lengths;

/// Table of a jaw crusher.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CrusherTable {
    /// Eccentricity of the shaft, mm.
    pub eccentric_mm: f64,
    /// Length of the jaw from the eccentric to the toggle plate, mm.
    pub jaw_mm: f64,
    /// Length of the toggle plate, mm.
    pub toggle_mm: f64,
    /// Distance of the toggle's fixed pivot from the shaft, mm.
    pub ground_mm: f64,
    /// Distance of the rock's force from the eccentric, along the jaw, mm.
    pub force_mm: f64,
    /// Mass of the jaw, kg. Its inertia is that of a uniform rod.
    pub jaw_kg: f64,
    /// Distance of the jaw's centre of mass from the eccentric, mm.
    pub jaw_centre_mm: f64,
    /// Profile of the rock's force over the closing stroke.
    #[serde(default)]
    pub rock: Rock,
    /// Peak force of the rock across the jaw, kN.
    pub rock_kn: f64,
    /// Turns of the shaft since power-up between which rock is fed.
    #[serde(deserialize_with = "lengths::two")]
    pub rock_turns: (f64, f64),
}

/// Profile of the rock's force over the closing stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rock {
    /// Rise in proportion to the shaft's angle, up to the peak at the end of the stroke.
    #[default]
    LinearRise,
    /// Peak force over the second half of the stroke.
    SecondHalf,
    /// Peak force over the whole stroke.
    Constant,
}
