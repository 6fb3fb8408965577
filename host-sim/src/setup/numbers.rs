//! Checks of a scene's values that the core does not have, or has in another form.

use cophase_core::settings::MAX_BANDS;
use cophase_scene::SceneError;
use cophase_scene::file::{self, AxisOverrides, Scene, Scope};

use crate::drives::{DriveModel, check_keys};
use crate::machines::Machine;

/// Checks the entries of `[[axis]]`. Returns the first error of each.
pub(super) fn check_overrides(scene: &Scene) -> Vec<SceneError> {
    let entries = scene.axis.iter().enumerate();
    entries
        .filter_map(|(entry, own)| check_axis(scene, entry, own).err())
        .collect()
}

fn check_axis(scene: &Scene, entry: usize, overrides: &AxisOverrides) -> Result<(), SceneError> {
    let key = |name: &str| format!("axis[{entry}].{name}");
    if overrides.number >= scene.axes.count {
        return Err(SceneError::for_key(
            key("number"),
            format!(
                "there is no axis {}; with axes.count = {} they are 0 to {}",
                overrides.number,
                scene.axes.count,
                scene.axes.count - 1
            ),
        ));
    }
    if scene.axis[..entry]
        .iter()
        .any(|other| other.number == overrides.number)
    {
        return Err(SceneError::for_key(
            key("number"),
            format!(
                "axis {} has an [[axis]] of its own already; put both into one",
                overrides.number
            ),
        ));
    }
    Ok(())
}

/// Checks tables whose keys depend on no other table. Returns all errors.
pub(super) fn check_tables(scene: &Scene) -> Vec<SceneError> {
    let mut errors = Vec::new();
    let mut refuse = |key: &str, problem: String| errors.push(SceneError::for_key(key, problem));
    if scene.link.timeout_s == 0.0 && scene.link.reaction != file::LossReaction::Stop {
        let problem = "has no effect without link.timeout_s, the time without a frame after which the host is lost; give it, or leave both out";
        refuse("link.reaction", problem.to_owned());
    }
    if let Some(Scope { from_s, to_s }) = scene.scope
        && to_s <= from_s
    {
        let problem = format!("{to_s} is not after scope.from_s = {from_s}; swap or part them");
        refuse("scope.to_s", problem);
    }
    errors
}

/// Checks forbidden bands as a whole. The core would report one edge at a time.
pub(super) fn check_bands(limits: &file::Limits) -> Result<(), SceneError> {
    let bands = limits.band.len();
    if bands > MAX_BANDS {
        let problem = format!(
            "{bands} bands are more than the {MAX_BANDS} that the shaft keeps; join neighbours"
        );
        return Err(SceneError::for_key("limits.band", problem));
    }
    for (i, band) in limits.band.iter().enumerate() {
        if band.from_hz <= limits.homing_speed_hz && band.to_hz >= limits.speed_hz {
            return Err(SceneError::for_key(
                format!("limits.band[{i}]"),
                format!(
                    "the band covers all speeds from limits.homing_speed_hz = {} to limits.speed_hz = {} rev/s, so \
                     that none is left to run at; let it begin above the one and end below the other",
                    limits.homing_speed_hz, limits.speed_hz
                ),
            ));
        }
    }
    Ok(())
}

/// Checks that keys of drives have an effect on a machine.
pub(super) fn check_drives(scene: &Scene, machine: &dyn Machine) -> Result<(), SceneError> {
    let axes = &scene.axes;
    check_keys(scene)?;
    for (entry, own) in scene.axis.iter().enumerate() {
        let takes_pulses = scene.resolved(own.number).drive.kind().takes_pulses();
        let may_turn_otherwise = takes_pulses && own.cam.is_none() && machine.has_level_of_torque();
        if own.drive_steps_per_turn.is_some() && !may_turn_otherwise {
            return Err(SceneError::for_key(
                format!("axis[{entry}].drive_steps_per_turn"),
                "is a drive's own count of pulses for a turn of its crank, and this axis has no such drive; leave it out",
            ));
        }
        if own.pull_out_scale == 1.0 {
            continue;
        }
        let problem = if axes.pull_out.is_empty() {
            "scales nothing: axes.pull_out is missing; give the motors' torque as [[speed_hz, torque_nm], …]"
        } else if !DriveModel::for_drive(scene.resolved(own.number).drive).uses("axes.pull_out") {
            "scales the torque at which a stepper loses its step, and this axis has none; leave it out"
        } else {
            continue;
        };
        let key = format!("axis[{entry}].pull_out_scale");
        return Err(SceneError::for_key(key, problem));
    }
    if axes.pull_out.is_empty() {
        return Ok(());
    }
    let mut steps = (0..axes.count)
        .filter(|&number| scene.resolved(number).drive.kind().is_open_loop())
        .map(|number| scene.resolved(number).steps_per_turn);
    match steps.find(|steps| steps % axes.full_steps_per_turn != 0) {
        Some(steps) => Err(SceneError::for_key(
            "axes.steps_per_turn",
            format!(
                "{steps} is not a whole number of microsteps to each of axes.full_steps_per_turn = {}; a stepper \
                 that loses its step slips by four of those",
                axes.full_steps_per_turn
            ),
        )),
        None => Ok(()),
    }
}
