//! Creation of a slider-crank from a scene's keys: `machine.lambda`, or `machine.rod_length_mm`.

use cophase_core::mechanism::SliderCrankSettings;
use cophase_core::problem::Problem;
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

    fn of(settings: &SliderCrankSettings, crank_radius_m: f64) -> Self {
        Self::of_lengths(crank_radius_m, crank_radius_m / settings.lambda)
    }
}

fn lambda(machine: &Machine) -> Result<f64, SceneError> {
    match (machine.lambda, machine.rod_length_mm) {
        (Some(lambda), None) => Ok(lambda),
        (None, Some(length_mm)) => {
            let radius_mm = machine.needed("machine.crank_radius_mm")?;
            let lambda = radius_mm / length_mm;
            // The core refuses an invalid crank radius with its own message.
            if (0.1..=0.6).contains(&lambda) || !(0.1..=500.0).contains(&radius_mm) {
                return Ok(lambda);
            }
            // Rounded inwards, so that the advised values are accepted.
            let low = (radius_mm / 0.6 * 100.0).ceil() / 100.0;
            let high = (radius_mm / 0.1 * 100.0).floor() / 100.0;
            Err(SceneError::of(
                "machine.rod_length_mm",
                Problem::out_of_range(length_mm, low, high),
            ))
        }
        (Some(_), Some(_)) => Err(SceneError::at(
            "machine.rod_length_mm",
            "given together with machine.lambda, which has the same meaning; leave one out",
        )),
        (None, None) => Err(SceneError::at(
            "machine.lambda",
            "missing; give the ratio of crank radius to rod length, or machine.rod_length_mm",
        )),
    }
}
