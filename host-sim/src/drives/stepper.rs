//! Stepper: a micro-stepped motor, open loop.

use std::f64::consts::TAU;

use cophase_scene::file::Axes;

use crate::sines::sin_cos;

use super::{AtCrank, DriveKey, DriveModel, Field, Motor, PullOut, TorqueLaw};

/// Full steps per electrical cycle.
const FULL_STEPS: f64 = 4.0;

/// Keys of a motor whose field is a spring.
pub(super) const KEYS: [DriveKey; 3] = [
    DriveKey {
        key: "axes.pull_out",
        is_of_torque: true,
        is_given: |axes| !axes.pull_out.is_empty(),
        unused: "is the torque at which a stepper loses its step, and no axis here is a stepper; leave it out",
    },
    DriveKey {
        key: "axes.damping_nms",
        is_of_torque: true,
        is_given: |axes| axes.damping_nms != 0.0,
        unused: "is what a stepper's drive damps, and no axis here is a stepper; leave it out",
    },
    DriveKey {
        key: "axes.full_steps_per_turn",
        // The controller names lost steps by it.
        is_of_torque: false,
        is_given: |axes| axes.full_steps_per_turn != Axes::USUAL_FULL_STEPS,
        unused: "is the number of a stepper's full steps, and no axis here is a stepper; leave it out",
    },
];

pub(super) const MODEL: DriveModel = DriveModel {
    keys: &KEYS,
    needs: (
        "axes.pull_out",
        "the motors' pull-out torque as [[speed_hz, torque_nm], …]",
    ),
    torque_key: "axes.pull_out",
    window_deg: |_| None,
    motor: |axes, at_crank| Stepper::for_axes(axes, at_crank).map(Motor::Stepper),
};

/// A micro-stepped motor. Its field acts as a spring that repeats every electrical cycle.
///
/// Torque is T(ω) sin(p (φ − α)) + d (φ′ − ω), with p electrical cycles per turn. Beyond a quarter of a cycle the torque
/// falls again. The rotor then slips until the field catches it, a whole number of cycles away.
#[derive(Clone, Debug, PartialEq)]
pub struct Stepper {
    /// Pull-out torque against speed.
    pub pull_out: PullOut,
    /// Electrical cycles per turn: a quarter of the full steps.
    pub cycles_per_turn: f64,
    /// Damping by current control and eddy currents, N·m·s.
    pub damping_nms: f64,
}

impl Stepper {
    /// Motor of a scene at its crank, if the scene has its torque.
    pub(super) fn for_axes(axes: &Axes, at_crank: &AtCrank) -> Option<Self> {
        let turns = at_crank.motor_turns;
        (!axes.pull_out.is_empty()).then(|| Self {
            pull_out: at_crank.pull_out.clone(),
            cycles_per_turn: f64::from(axes.full_steps_per_turn) / FULL_STEPS * turns,
            damping_nms: axes.damping_nms * (turns * turns),
        })
    }
}

impl TorqueLaw for Stepper {
    #[inline]
    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64, _: f64) -> f64 {
        let ahead_rad = self.cycles_per_turn * (field.alpha_rad - alpha_rad);
        let ([sine], _) = sin_cos(&[ahead_rad]);
        self.max_nm(omega_rad_s) * sine + self.damping_nms * (field.omega_rad_s - omega_rad_s)
    }

    fn damping_nms(&self) -> f64 {
        self.damping_nms
    }

    fn stiffness_nm(&self, omega_rad_s: f64) -> (f64, f64) {
        let stiffness = self.cycles_per_turn * self.max_nm(omega_rad_s);
        (stiffness, stiffness)
    }

    fn stiffest_nm(&self) -> f64 {
        self.cycles_per_turn * self.pull_out.max_nm()
    }

    fn max_nm(&self, omega_rad_s: f64) -> f64 {
        self.pull_out.torque_nm(omega_rad_s.abs() / TAU)
    }
}
