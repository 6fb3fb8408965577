//! Checks of a scene's values that the core does not have, or has in another form.

use cophase_core::settings::{MAX_BANDS, Transmission};
use cophase_scene::SceneError;
use cophase_scene::file::{self, AxisOverrides, Scene};

use crate::drives::{DriveModel, check_keys};

pub(super) fn check_overrides(
    scene: &Scene,
    entry: usize,
    overrides: &AxisOverrides,
) -> Result<(), SceneError> {
    let key = |name: &str| format!("axis[{entry}].{name}");
    if overrides.number >= scene.axes.count {
        return Err(SceneError::at(
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
        return Err(SceneError::at(
            key("number"),
            format!(
                "axis {} has an [[axis]] of its own already; put both into one",
                overrides.number
            ),
        ));
    }
    let has_crank = scene.cam.is_none() && overrides.cam.is_none();
    let takes_pulses = has_crank && scene.resolved(overrides.number).drive.kind().takes_pulses();
    if overrides.drive_steps_per_turn.is_none() || takes_pulses {
        return Ok(());
    }
    Err(SceneError::at(
        key("drive_steps_per_turn"),
        "is a drive's own count of pulses for a turn of its crank, and this axis has no such drive; leave it out",
    ))
}

/// Checks belts and gearboxes alone, as the models of all machines divide by them.
pub(super) fn check_gears(scene: &Scene) -> Result<(), SceneError> {
    let own = scene.axis.iter().enumerate();
    let own = own.filter_map(|(entry, own)| Some((format!("axis[{entry}].gear"), own.gear?)));
    for (key, gear) in std::iter::once(("axes.gear".to_owned(), scene.axes.gear)).chain(own) {
        let most = Transmission::MAX_TURNS;
        if [gear.0, gear.1]
            .iter()
            .any(|turns| !(1..=most).contains(turns))
        {
            let problem = format!(
                "[{}, {}] is not [motor turns, crank turns] of 1 to {most} each; a belt from 57 teeth on the crank to 11 on the motor is \
                 [57, 11]",
                gear.0, gear.1
            );
            return Err(SceneError::at(key, problem));
        }
    }
    Ok(())
}

pub(super) fn check_times(scene: &Scene) -> Result<(), SceneError> {
    if scene.link.timeout_s == 0.0 && scene.link.reaction != file::LossReaction::Stop {
        let problem = "has no effect without link.timeout_s, the time without a frame after which the host is lost; give it, or leave both out";
        return Err(SceneError::at("link.reaction", problem));
    }
    if scene.limits.band.len() > MAX_BANDS {
        return Err(SceneError::at(
            "limits.band",
            format!(
                "{} bands are more than the {MAX_BANDS} that the shaft keeps; join neighbours",
                scene.limits.band.len()
            ),
        ));
    }
    if let Some(scope) = scene.scope
        && scope.to_s <= scope.from_s
    {
        return Err(SceneError::at(
            "scope.to_s",
            format!(
                "{} is not after scope.from_s = {}; swap or part them",
                scope.to_s, scope.from_s
            ),
        ));
    }
    Ok(())
}

/// Checks forbidden bands as a whole. The core would report one edge at a time.
pub(super) fn check_bands(limits: &file::Limits) -> Result<(), SceneError> {
    for (i, band) in limits.band.iter().enumerate() {
        if band.from_hz <= limits.homing_speed_hz && band.to_hz >= limits.speed_hz {
            return Err(SceneError::at(
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

/// Checks that keys of drives have an effect.
pub(super) fn check_drives(scene: &Scene) -> Result<(), SceneError> {
    let axes = &scene.axes;
    check_keys(scene)?;
    for (entry, own) in scene.axis.iter().enumerate() {
        if own.pull_out_scale == 1.0 {
            continue;
        }
        let problem = if axes.pull_out.is_empty() {
            "scales nothing: axes.pull_out is missing; give the motors' torque as [[speed_hz, torque_nm], …]"
        } else if !DriveModel::of(scene.resolved(own.number).drive).uses("axes.pull_out") {
            "scales the torque at which a stepper loses its step, and this axis has none; leave it out"
        } else {
            continue;
        };
        let key = format!("axis[{entry}].pull_out_scale");
        return Err(SceneError::at(key, problem));
    }
    if axes.pull_out.is_empty() {
        return Ok(());
    }
    let mut steps = (0..axes.count)
        .filter(|&number| scene.resolved(number).drive.kind().is_open_loop())
        .map(|number| scene.resolved(number).steps_per_turn);
    match steps.find(|steps| steps % axes.full_steps_per_turn != 0) {
        Some(steps) => Err(SceneError::at(
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
