//! Settings of a platform on cranks for the core.

use cophase_core::settings::{MachineSettings, PlatformSettings};
use cophase_scene::SceneError;
use cophase_scene::file::{Drift, Machine};

use crate::mechanism::{AnyMechanism, Configured};

/// Returns the core's platform from `[machine]`, with its limit from `[drift]`, and checks it.
///
/// # Errors
/// A key is missing, belongs to another mechanism, or is out of its range.
pub fn platform(given: &Machine, drift: &Drift) -> Result<PlatformSettings, SceneError> {
    let platform = PlatformSettings {
        mechanism: AnyMechanism::settings(given)?,
        crank_radius_m: AnyMechanism::radius_m(given)?,
        load_kg: given.load_kg,
        platform: given.platform.into(),
        gravity_mps2: given.gravity_mps2,
        mount_radius_m: given.mount_radius_mm / 1e3,
        tilt_limit_mrad: drift.tilt_limit_mrad,
        allow_commanded_tilt: given.allow_commanded_tilt,
    };
    MachineSettings::Platform(platform).check()?;
    Ok(platform)
}
