//! Motor data of an axis as they act at its crank, behind the gear.
//!
//! A scene states a motor as its data sheet does. With i turns of the motor per turn of the crank, a speed of the motor is 1/i of it at the
//! crank, a torque i times, and a stiffness, a damping or an inertia i² times. All models are in terms of the crank, so this is the only
//! place that converts; the results of a motor are converted back by [`torque_at_motor_nm`](super::SimulatedAxis::torque_at_motor_nm).

use cophase_scene::file::{InductionDrive, Scene, ServoDrive};

use super::PullOut;

/// Full steps per electrical cycle of a stepper.
const FULL_STEPS: f64 = 4.0;

/// Motor of an axis, in terms of its crank.
#[derive(Clone, Debug, PartialEq)]
pub struct AtCrank {
    /// Turns of the motor per turn of the crank, i.
    pub motor_turns: f64,
    /// Inertia of what turns with the motor, kg·m².
    pub rotor_inertia_kgm2: f64,
    /// Pull-out torque of a stepper against the speed of the crank.
    pub pull_out: PullOut,
    /// Damping by a stepper's drive, N·m·s/rad.
    pub damping_nms: f64,
    /// Electrical cycles of a stepper per turn of the crank.
    pub cycles_per_turn: f64,
    /// Drive of a servo.
    pub servo: Option<ServoDrive>,
    /// Induction motor with its converter.
    pub induction: Option<InductionDrive>,
}

impl AtCrank {
    /// Motor of axis `number` of a scene, whose pull-out curve has been checked.
    pub fn new(scene: &Scene, number: usize) -> Self {
        let axes = &scene.axes;
        let ratio = scene.gear(number).ratio();
        let squared = ratio * ratio;
        let scale = scene
            .overrides(number)
            .map_or(1.0, |own| own.pull_out_scale);
        Self {
            motor_turns: ratio,
            rotor_inertia_kgm2: axes.rotor_inertia_kgm2 * squared,
            pull_out: PullOut::behind_gear(&axes.pull_out, ratio, scale),
            damping_nms: axes.damping_nms * squared,
            cycles_per_turn: f64::from(axes.full_steps_per_turn) / FULL_STEPS * ratio,
            servo: axes.servo.map(|servo| ServoDrive {
                velocity_gain_nms: servo.velocity_gain_nms * squared,
                limit_nm: servo.limit_nm.map(|limit_nm| limit_nm * ratio),
                ..servo
            }),
            induction: axes.induction.map(|motor| InductionDrive {
                rated_nm: motor.rated_nm * ratio,
                rated_slip_hz: motor.rated_slip_hz / ratio,
                ..motor
            }),
        }
    }
}
