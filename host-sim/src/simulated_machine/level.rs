//! Checked scene on another model level.

use cophase_scene::SceneError;
use cophase_scene::file::{FaultAt, FaultName, Fidelity};

use crate::checked::Checked;
use crate::machines::Machine;
use crate::simulated_machine::SimulatedMachine;

impl Checked {
    /// Returns the same scene on a model level.
    ///
    /// # Errors
    /// The scene lacks data for the model level.
    pub fn on(&self, model_level: Fidelity) -> Result<Self, SceneError> {
        let mut other = self.clone();
        other.fidelity = model_level;
        check_level(&*self.machine, model_level)?;
        self.machine.check_data(&self.scene, model_level)?;
        check_faults(&other, model_level)?;
        SimulatedMachine::new(&other)?;
        Ok(other)
    }
}

/// Checks that a machine has a model level.
fn check_level(machine: &dyn Machine, model_level: Fidelity) -> Result<(), SceneError> {
    let levels = machine.levels();
    if model_level == Fidelity::Auto || levels.contains(&model_level) {
        return Ok(());
    }
    let names: Vec<_> = levels.iter().map(|level| level.name()).collect();
    Err(SceneError::for_key(
        "fidelity",
        format!(
            "\"{}\" is no model level of {}; it has {}",
            model_level.name(),
            machine.name(),
            names.join(", ")
        ),
    ))
}

/// Checks that all faults can occur on a model level.
fn check_faults(checked: &Checked, model_level: Fidelity) -> Result<(), SceneError> {
    let scene = &checked.scene;
    if let Some(i) = scene
        .moving_fault()
        .filter(|_| !checked.machine.has_level_of_torque())
    {
        return Err(SceneError::for_key(
            format!("fault[{i}].kind"),
            format!(
                "\"{}\" has a {} be elsewhere than commanded, and those of {} are where commanded on each model level; leave it out",
                scene.fault[i].kind.name(),
                checked.machine.axis_noun(),
                checked.machine.name()
            ),
        ));
    }
    if checked.machine.moves_by_torque(model_level) {
        return Ok(()); // `cranks_apart` reports that no crank moves alone on the rigid model level
    }
    let right = if checked.machine.has_level_of_torque() {
        format!(
            "torque moves no {}s on this model level; let fidelity be \"phased\", or leave it out",
            checked.machine.axis_noun()
        )
    } else {
        let name = checked.machine.name();
        format!("torque moves nothing on any model level of {name}; leave it out")
    };
    let load_step = |fault: &FaultAt| fault.kind == FaultName::LoadStep;
    if let Some(i) = scene.fault.iter().position(load_step) {
        return Err(SceneError::for_key(
            format!("fault[{i}].kind"),
            format!("\"load-step\" is a torque, and {right}"),
        ));
    }
    if scene.noise.load_nm > 0.0 {
        return Err(SceneError::for_key(
            "noise.load_nm",
            format!("is a torque, and {right}"),
        ));
    }
    Ok(())
}
