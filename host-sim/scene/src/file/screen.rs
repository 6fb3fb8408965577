//! Scene table `[screen]`: a box on springs with unbalanced shafts.

use serde::{Deserialize, Serialize};

/// Table of a vibrating screen.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ScreenTable {
    /// Mass of the box with its contents, without the exciter blocks, kg.
    pub box_kg: f64,
    /// Length of the box, mm. The springs are at its ends, and its mass is evenly distributed.
    pub length_mm: f64,
    /// Mass of the exciter block on each shaft, kg.
    pub block_kg: f64,
    /// Distance of a block's centre of mass from its shaft's axis, mm.
    pub eccentricity_mm: f64,
    /// Position of each shaft along the box, relative to its centre, mm. One per axis.
    pub shafts_mm: Vec<f64>,
    /// Total stiffness of all springs, along and across the deck, N/mm.
    pub stiffness_n_per_mm: f64,
    /// Damping of the box on its springs, as a fraction of critical damping.
    #[serde(default = "default_zeta")]
    pub zeta: f64,
    /// Gravity, m/s².
    #[serde(default = "standard_gravity")]
    pub gravity_mps2: f64,
    /// Permits a scene whose motors have less than the sufficient torque at the resonance.
    #[serde(default)]
    pub allow_capture: bool,
}

const fn default_zeta() -> f64 {
    0.07
}
const fn standard_gravity() -> f64 {
    9.80665
}
