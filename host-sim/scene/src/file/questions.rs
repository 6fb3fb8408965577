//! `[questions]`: outputs that a scene requests, with their tolerances.

use cophase_core::keys;
use cophase_core::settings::key::optional;
use serde::{Deserialize, Serialize};

keys! {
    /// Requested outputs for `fidelity = "auto"`, each with its tolerance. Other outputs do not count.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Questions left out if Questions::is_none, {
        /// Largest lag of a crank behind its command, or lead, degrees.
        lag_deg: Option<f64> = optional("2").from(1e-9, 1e6),
        /// Largest difference between two cranks' lags, degrees.
        spread_deg: Option<f64> = optional("0.1").from(1e-9, 1e6),
        /// Largest tilt of the platform, mrad.
        tilt_mrad: Option<f64> = optional("0.01").from(1e-9, 1e6),
        /// Largest acceleration of the platform, percent of itself.
        amax_percent: Option<f64> = optional("20").from(1e-9, 1e6),
        /// Largest torque of a motor, percent of itself.
        torque_percent: Option<f64> = optional("5").from(1e-9, 1e6),
        /// Largest force on the ground beyond the weight, percent of itself.
        ground_percent: Option<f64> = optional("10").from(1e-9, 1e6),
        /// True if the set of motors that slip is requested.
        slips: Option<bool> = optional("true"),
    }
}

impl Questions {
    /// Returns true if no output is requested.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
