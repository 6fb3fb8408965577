//! Motor data of an axis as they act at its crank, behind the gear.
//!
//! A scene states a motor as its data sheet does. With i turns of the motor per turn of the crank, a speed of the motor is 1/i of it at the
//! crank, a torque i times, and a stiffness, a damping or an inertia i² times. All models are in terms of the crank, so this and
//! the models of the drives are the only places that convert; the results of a motor are converted back by [`torque_at_motor_nm`](super::SimulatedAxis::torque_at_motor_nm).

use cophase_scene::file::Scene;

use super::{DriveModel, Motor, PullOut};

/// Motor of an axis, in terms of its crank.
#[derive(Clone, Debug, PartialEq)]
pub struct AtCrank {
    /// Turns of the motor per turn of the crank, i.
    pub motor_turns: f64,
    /// Inertia of what turns with the motor, kg·m².
    pub rotor_inertia_kgm2: f64,
    /// Pull-out torque of a stepper against the speed of the crank.
    pub pull_out: PullOut,
}

impl AtCrank {
    /// Motor of axis `number` of a scene, whose pull-out curve has been checked.
    pub fn new(scene: &Scene, number: usize) -> Self {
        let axes = &scene.axes;
        let axis = scene.resolved(number);
        let ratio = axis.gear.ratio();
        let scale = axis.own.pull_out_scale;
        Self {
            motor_turns: ratio,
            rotor_inertia_kgm2: axes.rotor_inertia_kgm2 * (ratio * ratio),
            pull_out: PullOut::behind_gear(&axes.pull_out, ratio, scale),
        }
    }

    /// Motor with its drive of axis `number` of a scene, if the scene has their keys.
    pub fn motor(scene: &Scene, number: usize) -> Option<Motor> {
        let model = DriveModel::for_drive(scene.resolved(number).drive);
        (model.motor)(&scene.axes, &Self::new(scene, number))
    }
}
