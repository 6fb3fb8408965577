//! Settings of a platform on cranks for the core.

use cophase_core::settings::MachineSettings;

use crate::mechanism::{AnyMechanism, Configured};
use crate::scene::SceneError;
use crate::scene::file::Machine;

/// Returns the core's machine from `[machine]`, and checks it.
///
/// # Errors
/// A key is missing, belongs to another mechanism, or is out of its range.
pub fn machine(given: &Machine) -> Result<MachineSettings, SceneError> {
    let machine = MachineSettings {
        mechanism: AnyMechanism::settings(given)?,
        crank_radius_m: AnyMechanism::radius_m(given)?,
        load_kg: given.load_kg,
        platform: given.platform.into(),
        gravity_mps2: given.gravity_mps2,
        mount_radius_m: given.mount_radius_mm / 1e3,
    };
    machine.check()?;
    Ok(machine)
}
