//! Construction of a mechanism: from a scene's keys to the controller's settings, and from these to the mechanism itself.

use cophase_scene::SceneError;
use cophase_scene::file::Machine;

use super::Mechanism;

/// A mechanism that a scene can name.
pub trait Configured: Mechanism {
    /// Settings of the mechanism in the controller.
    type Settings;

    /// Keys of [`Machine::geometry`] that belong to this mechanism.
    const KEYS: &'static [&'static str];

    /// Returns the crank radius from a scene's keys, m.
    ///
    /// # Errors
    /// The key is missing. The core checks its range.
    fn radius_m(machine: &Machine) -> Result<f64, SceneError> {
        Ok(machine.needed("machine.crank_radius_mm")? / 1e3)
    }

    /// Creates the controller's settings from a scene's keys. Keys that only other mechanisms have are refused beforehand.
    ///
    /// # Errors
    /// A key is missing. The core checks the ranges of the settings.
    fn settings(machine: &Machine) -> Result<Self::Settings, SceneError>;

    /// Creates the mechanism from settings that the core has checked, and from a crank radius in m.
    fn from_settings(settings: &Self::Settings, crank_radius_m: f64) -> Self;
}
