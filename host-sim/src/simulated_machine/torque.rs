//! Conversion of a scene to cranks that torque moves.

use std::sync::Arc;

use cophase_methods::{Needs, Scheme};
use cophase_scene::SceneError;

use super::rotors::SpeedLimit;
use super::{DriveCommand, Rotors};
use crate::checked::Checked;
use crate::drives::{AtCrank, DriveModel, Motor, SimulatedAxis};
use crate::dynamics::{Driven, Dynamics, RotorParts};

/// Speed limit of a crank: this multiple of the largest speed of its machine, plus `COASTING_HZ`, rev/s, which a load may
/// drive it to. A faster crank has run away (`Broken`).
const BEYOND: f64 = 10.0;
const COASTING_HZ: f64 = 50.0;

/// Creates the cranks of a scene if torque moves them on its model level; none on the other levels.
///
/// # Errors
/// Fails if the scene does not set what the model level needs.
pub fn rotors(checked: &Checked, axes: &[SimulatedAxis]) -> Result<Option<Rotors>, SceneError> {
    if !checked.moves_by_torque() {
        return Ok(None);
    }
    let settings = &checked.settings;
    let motors = (0..axes.len())
        .map(|i| motor(checked, i))
        .collect::<Result<Vec<_>, _>>()?;
    let driven = Driven::new(dynamics(checked)?, motors);
    let apart = checked.cranks_apart();
    (checked.machine)
        .check_driven(checked.fidelity, &driven, settings, apart)
        .map_err(|error| checked.at_own_entry(error))?;
    let commanded = axes.iter().map(|axis| DriveCommand {
        turns: axis.turns(),
        torque_nm: 0.0,
    });
    let tick_s = 1.0 / f64::from(settings.tick_hz);
    let chosen = checked.chosen();
    let needs_positions =
        |scheme: &Scheme| scheme.facts().needs == Needs::SecondOrder && !scheme.suits(&driven);
    if let Some(scheme) = chosen.scheme.filter(needs_positions) {
        return Err(SceneError::for_key(
            "method.name",
            format!(
                "{scheme} needs {}, and axes.servo.integral_s gives each servo a component more, which is neither; let it \
                 be \"rk4\", or \"sdirk4\" where that needs too many steps, or leave integral_s out",
                scheme.facts().needs
            ),
        ));
    }
    let ratios = settings.axes.iter();
    let ratios = ratios.map(|axis| axis.follower.max_ratio(&settings.cams));
    let fastest_hz = settings.limits.speed_hz * ratios.fold(1.0, f64::max);
    let beyond_hz = BEYOND * fastest_hz + COASTING_HZ;
    let limit = SpeedLimit {
        max_rad_s: beyond_hz * std::f64::consts::TAU,
        axis_noun: checked.machine.axis_noun(),
        causes_of_torque: checked.machine.causes_of_torque(),
    };
    Rotors::new(driven, commanded.collect(), tick_s, chosen)
        .map(|rotors| Some(rotors.watched(limit)))
        .map_err(|problem| SceneError::for_key("method", problem))
}

/// Returns the equations of motion that the model level gives the machine.
fn dynamics(checked: &Checked) -> Result<Box<dyn Dynamics>, SceneError> {
    let rotors = RotorParts {
        inertia_kgm2: rotors_kgm2(checked)?,
        friction_nm: friction_nm(checked),
    };
    Arc::clone(&checked.machine).dynamics(checked.fidelity, rotors)
}

/// Returns the inertia of each rotor, kg·m².
fn rotors_kgm2(checked: &Checked) -> Result<Vec<f64>, SceneError> {
    let rotors_kgm2: Vec<f64> = (0..checked.settings.axes.len())
        .map(|i| AtCrank::new(&checked.scene, i).rotor_inertia_kgm2)
        .collect();
    if rotors_kgm2.contains(&0.0) {
        return Err(SceneError::for_key(
            "axes.rotor_inertia_kgm2",
            format!(
                "is 0; fidelity = \"{}\" moves rotors by torque, so give their inertia, or let fidelity be \"kinematic\"",
                checked.fidelity.name()
            ),
        ));
    }
    Ok(rotors_kgm2)
}

/// Returns the dry friction of each rotor, N·m.
fn friction_nm(checked: &Checked) -> Vec<f64> {
    let friction = |i| checked.scene.resolved(i).friction_nm;
    (0..checked.settings.axes.len()).map(friction).collect()
}

fn motor(checked: &Checked, i: usize) -> Result<Motor, SceneError> {
    AtCrank::motor(&checked.scene, i).ok_or_else(|| {
        let (key, what) = DriveModel::for_drive(checked.scene.resolved(i).drive).needs;
        SceneError::for_key(
            key,
            format!(
                "missing; fidelity = \"{}\" moves rotors by torque, so give {what}, or let fidelity be \"kinematic\"",
                checked.fidelity.name()
            ),
        )
    })
}
