//! Scene table `[screen]`: a box on springs with unbalanced shafts.

use cophase_core::keys;
use cophase_core::settings::key::{Key, needed, or, or_value};
use cophase_core::settings::rows::GRAVITY_MPS2;
use serde::{Deserialize, Serialize};

const MAX_LENGTH_MM: f64 = 20_000.0;

/// Places on the box.
const SHAFTS_MM: Key = needed("[-600, 600]")
    .from(-MAX_LENGTH_MM / 2.0, MAX_LENGTH_MM / 2.0)
    .at_least(-0.5, &[("screen.length_mm", 1)])
    .at_most(0.5, &[("screen.length_mm", 1)]);

keys! {
    /// Table of a vibrating screen.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct ScreenTable {
        /// Mass of the box with its contents, without the exciter blocks, kg.
        box_kg: f64 = needed("2900").from(1.0, 1e5),
        /// Length of the box, mm. The springs are at its ends, and its mass is evenly distributed.
        length_mm: f64 = needed("4200").from(100.0, MAX_LENGTH_MM),
        /// Mass of the exciter block on each shaft, kg.
        block_kg: f64 = needed("83").from(0.01, 1e4),
        /// Distance of a block's centre of mass from its shaft's axis, mm.
        eccentricity_mm: f64 = needed("87.27").from(0.1, 1000.0),
        /// Position of each shaft along the box, relative to its centre, mm. One per axis.
        shafts_mm: Vec<f64> = SHAFTS_MM,
        /// Total stiffness of all springs, along and across the deck, N/mm.
        stiffness_n_per_mm: f64 = needed("1285.5").from(0.1, 1e6),
        /// Damping of the box on its springs, as a fraction of critical damping.
        zeta: f64 = or(0.07).from(0.001, 0.7),
        /// Gravity, m/s².
        gravity_mps2: f64 = GRAVITY_MPS2,
        /// Permits a scene whose motors have less than the sufficient torque at the resonance.
        allow_capture: bool = or_value("false"),
    }
}
