//! Checked scene on another model level.

use super::{cam, faults};
use crate::machine::Machine;
use crate::scene::file::Fidelity;
use crate::scene::{Checked, SceneError};

impl Checked {
    /// Returns the same scene on a model level.
    ///
    /// # Errors
    /// The scene lacks data for the model level.
    pub fn on(&self, model_level: Fidelity) -> Result<Self, SceneError> {
        let mut other = self.clone();
        other.fidelity = model_level;
        if let Some(follower) = &self.cam {
            cam::check_level(model_level, follower)?;
        } else if let Some(plant) = &self.plant {
            let levels = plant.levels();
            if model_level != Fidelity::Auto && !levels.contains(&model_level) {
                let names: Vec<_> = levels.iter().map(|level| level.name()).collect();
                return Err(SceneError::at(
                    "fidelity",
                    format!(
                        "\"{}\" is no model level of {}; it has {}",
                        model_level.name(),
                        plant.name(),
                        names.join(", ")
                    ),
                ));
            }
        } else if model_level == Fidelity::QuasiStatic && other.scene.axes.pull_out.is_empty() {
            return Err(SceneError::at(
                "axes.pull_out",
                "missing; fidelity = \"quasi-static\" compares torques, so give the motors' pull-out torque \
                 as [[speed_hz, torque_nm], …], or let fidelity be \"kinematic\"",
            ));
        }
        faults::check_level(&other, model_level)?;
        Machine::new(&other)?;
        Ok(other)
    }
}
