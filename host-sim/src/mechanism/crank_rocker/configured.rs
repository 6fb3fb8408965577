//! Creation of a crank-rocker from a scene's keys: the screw's lead, and the lengths of the links relative to the rocker's.

use std::f64::consts::TAU;

use cophase_core::mechanism::CrankRockerSettings;
use cophase_scene::SceneError;
use cophase_scene::file::Machine;

use super::{CrankRocker, Linkage};
use crate::mechanism::Configured;

impl Configured for CrankRocker {
    type Settings = CrankRockerSettings;

    const KEYS: &'static [&'static str] = &[
        "machine.screw_lead_mm",
        "machine.crank_ratio",
        "machine.coupler_ratio",
        "machine.ground_ratio",
    ];

    fn radius_m(machine: &Machine) -> Result<f64, SceneError> {
        Ok(machine.needed("machine.screw_lead_mm")? / 1e3 / TAU)
    }

    fn settings(machine: &Machine) -> Result<CrankRockerSettings, SceneError> {
        Ok(CrankRockerSettings {
            crank: machine.needed("machine.crank_ratio")?,
            coupler: machine.needed("machine.coupler_ratio")?,
            ground: machine.needed("machine.ground_ratio")?,
        })
    }

    fn from_settings(settings: &CrankRockerSettings, unit_m: f64) -> Self {
        let linkage = Linkage {
            crank: settings.crank,
            coupler: settings.coupler,
            ground: settings.ground,
        };
        Self::new(linkage, unit_m)
    }
}
