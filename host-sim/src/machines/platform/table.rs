//! The platform on cranks that the tables `[machine]` and `[frame]` of a scene describe.

use std::ops::RangeInclusive;
use std::sync::Arc;

use cophase_core::settings::{MachineSettings, PlatformSettings};
use cophase_scene::file::{self, Rods};
use cophase_scene::{Scene, SceneError};

use super::{CranksUnderPlatform, Platform};
use crate::machines::table::given;
use crate::machines::{Made, Table};
use crate::mechanism::{AnyMechanism, Configured};

/// Returns the core's platform from `[machine]`, and checks it.
///
/// # Errors
/// A key is missing, belongs to another mechanism, or is out of its range.
pub fn platform(given: &file::Machine) -> Result<PlatformSettings, SceneError> {
    let platform = PlatformSettings {
        mechanism: AnyMechanism::settings(given)?,
        crank_radius_m: AnyMechanism::radius_m(given)?,
        load_kg: given.load_kg,
        platform: given.platform.into(),
        gravity_mps2: given.gravity_mps2,
        mount_radius_m: given.mount_radius_mm / 1e3,
        allow_commanded_tilt: given.allow_commanded_tilt,
    };
    MachineSettings::Platform(platform).check()?;
    Ok(platform)
}

impl Table for file::Machine {
    fn key(&self) -> &'static str {
        "machine"
    }

    fn machine_name(&self) -> &'static str {
        super::NAME
    }

    fn list_name(&self) -> &'static str {
        self.mechanism.name()
    }

    fn simulation_keys(&self, scene: &Scene) -> Vec<&'static str> {
        let keys = [
            (
                "machine.tilt_inertia_kgm2",
                self.tilt_inertia_kgm2.is_some(),
            ),
            ("machine.rods", self.rods != Rods::QuasiStatic),
            ("frame", scene.frame.is_some()),
        ];
        given(&keys).collect()
    }

    fn axes(&self) -> RangeInclusive<usize> {
        2..=6
    }

    fn make(&self, scene: &Scene) -> Result<Made, SceneError> {
        if scene.questions.ground_percent.is_some() && scene.frame.is_none() {
            return Err(SceneError::for_key(
                "questions.ground_percent",
                "requests the force on the ground, which needs a frame on springs: give [frame], or leave the question out",
            ));
        }
        let settings = platform(self)?;
        let machine = CranksUnderPlatform {
            platform: Platform::new(&settings, scene.axes.count),
            given: self.clone(),
            frame: scene.frame.clone(),
        };
        Ok(Made {
            settings: MachineSettings::Platform(settings),
            machine: Arc::new(machine),
        })
    }
}
