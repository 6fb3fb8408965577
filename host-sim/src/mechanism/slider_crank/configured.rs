//! Creation of a slider-crank from a scene's keys: `machine.lambda`, or `machine.rod_length_mm`.

use cophase_core::mechanism::SliderCrankSettings;
use cophase_scene::SceneError;
use cophase_scene::file::Machine;

use super::SliderCrank;
use crate::mechanism::Configured;

impl Configured for SliderCrank {
    type Settings = SliderCrankSettings;

    const KEYS: &'static [&'static str] = &[
        "machine.crank_radius_mm",
        "machine.lambda",
        "machine.rod_length_mm",
    ];

    fn settings(machine: &Machine) -> Result<SliderCrankSettings, SceneError> {
        lambda(machine).map(|lambda| SliderCrankSettings { lambda })
    }

    fn from_settings(settings: &SliderCrankSettings, crank_radius_m: f64) -> Self {
        Self::of_lengths(crank_radius_m, crank_radius_m / settings.lambda)
    }
}

fn lambda(machine: &Machine) -> Result<f64, SceneError> {
    match (machine.lambda, machine.rod_length_mm) {
        (Some(lambda), None) => Ok(lambda),
        (None, Some(length_mm)) => Ok(machine.needed("machine.crank_radius_mm")? / length_mm),
        (Some(_), Some(_)) => Err(SceneError::for_key(
            "machine.rod_length_mm",
            "given together with machine.lambda, which has the same meaning; leave one out",
        )),
        (None, None) => Err(SceneError::for_key(
            "machine.lambda",
            "missing; give the ratio of crank radius to rod length, or machine.rod_length_mm",
        )),
    }
}
