//! Construction of a mechanism: from a scene's keys to the controller's settings, and from these to the mechanism itself.

use super::Mechanism;
use crate::scene::SceneError;
use crate::scene::file::Machine;

/// A mechanism that a scene can name.
pub trait Configured: Mechanism {
    /// Settings that the controller is given of it.
    type Settings;

    /// Keys of [`Machine::geometry`] that belong to it.
    const KEYS: &'static [&'static str];

    /// Crank radius, m, of a scene's keys.
    ///
    /// # Errors
    /// The key is missing. Its range is the core's to check.
    fn radius_m(machine: &Machine) -> Result<f64, SceneError> {
        Ok(machine.needed("machine.crank_radius_mm")? / 1e3)
    }

    /// Makes the controller's settings of a scene's keys, of which there are none that belong to other mechanisms only.
    ///
    /// # Errors
    /// A key is missing. Ranges of the settings are the core's to check.
    fn settings(machine: &Machine) -> Result<Self::Settings, SceneError>;

    /// Makes the mechanism of settings that the core has checked, and of a crank radius in m.
    fn of(settings: &Self::Settings, crank_radius_m: f64) -> Self;

    /// Settings at the ends and in the middle of their ranges, for the conformance tests.
    #[cfg(test)]
    fn samples() -> Vec<Self::Settings>;
}
