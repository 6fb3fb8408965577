//! `[axes]` and `[[axis]]`: the motors.

use cophase_core::settings::DriveKind;
use serde::{Deserialize, Serialize};

use super::lengths::{pair, pairs, some_pair};

/// Values for all axes, unless an `[[axis]]` has its own.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Axes {
    /// Number of axes, 2 to 6.
    pub count: usize,
    /// Drive of the axes.
    pub drive: Drive,
    /// Steps per turn of the motor; for a servo drive, the counts that it expects.
    pub steps_per_turn: u32,
    /// Belt or gearbox between motor and crank, as `[motor turns, crank turns]`.
    #[serde(default = "one_to_one", deserialize_with = "pair")]
    pub gear: (u32, u32),
    /// Full steps per turn of the motor; a stepper slips by four of them.
    #[serde(default = "default_full_steps")]
    pub full_steps_per_turn: u32,
    /// Crank turns per master turn, as `[numerator, denominator]`.
    #[serde(default = "one_to_one", deserialize_with = "pair")]
    pub ratio: (u32, u32),
    /// Crank phase relative to the master's, degrees.
    #[serde(default)]
    pub offset_deg: f64,
    /// True if the cranks have index sensors.
    #[serde(default = "yes")]
    pub index: bool,
    /// Crank phase of the index sensor, degrees.
    #[serde(default)]
    pub index_deg: f64,
    /// Length of the index flag, degrees of the crank.
    #[serde(default)]
    pub index_width_deg: f64,
    /// Delay from the flag's edge to that of the line, µs.
    #[serde(default)]
    pub index_delay_us: f64,
    /// True if the motors have encoders, with `steps_per_turn` counts per turn of the motor.
    #[serde(default)]
    pub encoder: bool,
    /// True if a brake holds the cranks while the drives are off.
    #[serde(default)]
    pub brake: bool,
    /// Greatest trim, degrees.
    #[serde(default = "default_trim_limit_deg")]
    pub trim_limit_deg: f64,
    /// Speed at which trim changes, degrees/s.
    #[serde(default = "default_trim_rate")]
    pub trim_rate_deg_per_s: f64,
    /// Inertia of what turns with the motor, kg·m²; without a gear, rotor and crank.
    #[serde(default)]
    pub rotor_inertia_kgm2: f64,
    /// Friction torque at each crank, N·m.
    #[serde(default)]
    pub friction_nm: f64,
    /// Damping of a stepper's drive, N·m·s/rad, of the motor.
    #[serde(default)]
    pub damping_nms: f64,
    /// Pull-out torque of a stepper, of the motor, as `[speed_hz, torque_nm]` points, lowest speed first; straight lines between.
    #[serde(
        default,
        deserialize_with = "pairs",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub pull_out: Vec<(f64, f64)>,
    /// Drives of servos.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo: Option<ServoDrive>,
    /// Induction motors with their frequency converters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub induction: Option<InductionDrive>,
}

/// Servo drive: a position loop around a velocity loop. A drive that takes setpoints also has torque feed-forward.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ServoDrive {
    /// Gain from the position error to the velocity, 1/s.
    pub position_gain_per_s: f64,
    /// Gain from the velocity error to the torque, N·m·s/rad.
    pub velocity_gain_nms: f64,
    /// Integral time of the velocity loop, s; without it, the loop has no integral part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integral_s: Option<f64>,
    /// Torque limit, N·m, by the current limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_nm: Option<f64>,
    /// Part of the commanded velocity that is fed forward to the velocity loop, 0 to 1.
    #[serde(default = "one")]
    pub velocity_feed_forward: f64,
    /// Following-error window, degrees of the crank. Beyond it, the drive raises its alarm; without it, the drive has no alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub following_error_deg: Option<f64>,
}

/// Induction motor on a frequency converter that takes pulses. Torques and speeds are those of the motor.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct InductionDrive {
    /// Rated torque, N·m.
    pub rated_nm: f64,
    /// Slip at the rated torque, rev/s: the synchronous speed minus the speed of the motor.
    pub rated_slip_hz: f64,
    /// Breakdown torque over rated torque.
    pub breakdown_ratio: f64,
    /// Gain from the position error to the converter's frequency, 1/s.
    pub position_gain_per_s: f64,
    /// Following-error window, degrees of the crank. Beyond it, the converter raises its alarm; without it, there is no alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub following_error_deg: Option<f64>,
}

/// Drive of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drive {
    /// Step and direction pulses, open loop.
    Stepper,
    /// Position, velocity and torque setpoints.
    Servo,
    /// Step and direction pulses to a drive that closes its own position loop.
    PulseServo,
    /// Step and direction pulses to a frequency converter with an induction motor.
    Induction,
}

impl Drive {
    /// Returns what the drive is to the controller.
    pub const fn kind(self) -> DriveKind {
        match self {
            Self::Stepper => DriveKind::Stepper,
            Self::Servo => DriveKind::Servo,
            Self::PulseServo | Self::Induction => DriveKind::PulseServo,
        }
    }
}

/// Values of one axis that differ from those of all axes.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AxisOverrides {
    /// Number of the axis, counted from 0.
    pub number: usize,
    /// True if the motor is mounted the other way round.
    #[serde(default)]
    pub reversed: bool,
    /// Replaces the value in `[axes]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive: Option<Drive>,
    /// Replaces the value in `[axes]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps_per_turn: Option<u32>,
    /// Replaces the value in `[axes]`.
    #[serde(
        default,
        deserialize_with = "some_pair",
        skip_serializing_if = "Option::is_none"
    )]
    pub gear: Option<(u32, u32)>,
    /// Replaces the value in `[axes]`.
    #[serde(
        default,
        deserialize_with = "some_pair",
        skip_serializing_if = "Option::is_none"
    )]
    pub ratio: Option<(u32, u32)>,
    /// Replaces the value in `[axes]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset_deg: Option<f64>,
    /// Replaces the value in `[axes]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub index: Option<bool>,
    /// Replaces the value in `[axes]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub index_deg: Option<f64>,
    /// Name of the `[[cam_table]]` that it follows, instead of a gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cam: Option<String>,
    /// Angle of the cam table at the master's phase 0, degrees.
    #[serde(default)]
    pub cam_shift_deg: f64,
    /// Trim that is set from the start, degrees.
    #[serde(default)]
    pub trim_deg: f64,
    /// True phase of the crank at power-up, relative to the phase that the loop assumes, degrees.
    #[serde(default)]
    pub start_deg: f64,
    /// Replaces the value in `[axes]`, such as for a stiffer bearing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_nm: Option<f64>,
    /// Factor on its pull-out torque, such as for a weaker motor.
    #[serde(default = "one")]
    pub pull_out_scale: f64,
    /// Steps with which the simulated drive makes a turn of its crank, where its switches, or a gear, differ from the settings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive_steps_per_turn: Option<u32>,
}

impl AxisOverrides {
    /// Returns an axis whose values are those of all axes.
    pub const fn new(number: usize) -> Self {
        Self {
            number,
            reversed: false,
            drive: None,
            steps_per_turn: None,
            gear: None,
            ratio: None,
            offset_deg: None,
            index: None,
            index_deg: None,
            cam: None,
            cam_shift_deg: 0.0,
            trim_deg: 0.0,
            start_deg: 0.0,
            friction_nm: None,
            pull_out_scale: 1.0,
            drive_steps_per_turn: None,
        }
    }
}

/// Returns the full steps per turn of a usual stepper.
pub const fn default_full_steps() -> u32 {
    200
}
const fn one_to_one() -> (u32, u32) {
    (1, 1)
}
const fn default_trim_limit_deg() -> f64 {
    5.0
}
const fn default_trim_rate() -> f64 {
    1.0
}
const fn yes() -> bool {
    true
}
const fn one() -> f64 {
    1.0
}
