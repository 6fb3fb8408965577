//! Checked scene on another model level.

use cophase_scene::SceneError;
use cophase_scene::file::{FaultAt, FaultName, Fidelity};

use crate::cam::Follower;
use crate::checked::Checked;
use crate::machine::Machine;

impl Checked {
    /// Returns the same scene on a model level.
    ///
    /// # Errors
    /// The scene lacks data for the model level.
    pub fn on(&self, model_level: Fidelity) -> Result<Self, SceneError> {
        let mut other = self.clone();
        other.fidelity = model_level;
        if let Some(follower) = &self.cam {
            check_followers(model_level, follower)?;
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
        check_faults(&other, model_level)?;
        Machine::new(&other)?;
        Ok(other)
    }
}

/// Checks that cams have a model level, and that the scene has the data for it.
fn check_followers(model_level: Fidelity, follower: &Follower) -> Result<(), SceneError> {
    match model_level {
        Fidelity::Auto | Fidelity::Kinematic => Ok(()),
        Fidelity::Elastic if follower.links.is_some() => Ok(()),
        Fidelity::Elastic => Err(SceneError::at(
            "cam.masses_kg",
            "missing; fidelity = \"elastic\" needs cam.masses_kg, cam.stiffness_n_per_mm, and cam.zeta or \
             cam.dampers_ns_per_m; or let fidelity be \"kinematic\"",
        )),
        other => Err(SceneError::at(
            "fidelity",
            format!(
                "\"{}\" is of cranks under a platform; with [cam] there are \"kinematic\" and \"elastic\"",
                other.name()
            ),
        )),
    }
}

/// Checks that all faults can occur on a model level.
fn check_faults(checked: &Checked, model_level: Fidelity) -> Result<(), SceneError> {
    let scene = &checked.scene;
    if let Some(i) = scene.moving_fault().filter(|_| checked.cam.is_some()) {
        return Err(SceneError::at(
            format!("fault[{i}].kind"),
            format!(
                "\"{}\" has a crank be elsewhere than commanded, and cam shafts are where commanded; leave it \
                 out, or give a scene with [machine]",
                scene.fault[i].kind.name()
            ),
        ));
    }
    if model_level.moves_by_torque() && checked.cam.is_none() {
        return Ok(()); // `cranks_apart` reports that no crank moves alone on the rigid model level
    }
    let right =
        "torque moves no cranks on this model level; let fidelity be \"phased\", or leave it out";
    let load_step = |fault: &FaultAt| fault.kind == FaultName::LoadStep;
    if let Some(i) = scene.fault.iter().position(load_step) {
        return Err(SceneError::at(
            format!("fault[{i}].kind"),
            format!("\"load-step\" is a torque, and {right}"),
        ));
    }
    if scene.noise.load_nm > 0.0 {
        return Err(SceneError::at(
            "noise.load_nm",
            format!("is a torque, and {right}"),
        ));
    }
    Ok(())
}
