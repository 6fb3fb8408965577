//! `[axes]` and `[[axis]]`: the motors.

use cophase_core::axes::{CAM_SHIFT_DEG, RATIO};
use cophase_core::keys;
use cophase_core::settings::DriveKind;
use cophase_core::settings::key::{Kind, Value, needed, optional, or, or_value};
use cophase_core::settings::rows::{
    GEAR, INDEX_DEG, INDEX_DELAY_US, INDEX_WIDTH_DEG, OFFSET_DEG, ROTOR_INERTIA_KGM2,
    STEPS_PER_TURN, TRIM_DEG, TRIM_LIMIT_DEG, TRIM_RATE_DEG_PER_S,
};
use serde::{Deserialize, Serialize};

/// Largest torque, N·m: more than a motor for a platform of 50 kg needs.
const MAX_FRICTION_NM: f64 = 1000.0;

keys! {
    /// Values for all axes, unless an `[[axis]]` has its own.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Axes {
        /// Number of axes. Each machine has its own numbers of them, at most 6.
        count: usize = needed("4"),
        /// Drive of the axes.
        drive: Drive = needed("stepper"),
        /// Steps per turn of the motor; for a servo drive, the counts that it expects.
        steps_per_turn: u32 = STEPS_PER_TURN,
        /// Belt or gearbox between motor and crank, as `[motor turns, crank turns]`.
        gear: (u32, u32) = GEAR,
        /// Full steps per turn of the motor; a stepper slips by four of them.
        full_steps_per_turn: u32 = or(Axes::USUAL_FULL_STEPS as f64).from(4.0, 65_536.0),
        /// Crank turns per master turn, as `[numerator, denominator]`.
        ratio: (u32, u32) = RATIO,
        /// Crank phase relative to the master's, degrees.
        offset_deg: f64 = OFFSET_DEG,
        /// True if the cranks have index sensors.
        index: bool = or_value("true"),
        /// Crank phase of the index sensor, degrees.
        index_deg: f64 = INDEX_DEG,
        /// Length of the index flag, degrees of the crank.
        index_width_deg: f64 = INDEX_WIDTH_DEG,
        /// Delay from the flag's edge to that of the line, µs.
        index_delay_us: f64 = INDEX_DELAY_US,
        /// True if the motors have encoders, with `steps_per_turn` counts per turn of the motor.
        encoder: bool = or_value("false"),
        /// True if a brake holds the cranks while the drives are off.
        brake: bool = or_value("false"),
        /// Greatest trim, degrees.
        trim_limit_deg: f64 = TRIM_LIMIT_DEG,
        /// Speed at which trim changes, degrees/s.
        trim_rate_deg_per_s: f64 = TRIM_RATE_DEG_PER_S,
        /// Inertia of what turns with the motor, kg·m²; without a gear, rotor and crank.
        rotor_inertia_kgm2: f64 = ROTOR_INERTIA_KGM2,
        /// Friction torque at each crank, N·m.
        friction_nm: f64 = or(0.0).from(0.0, MAX_FRICTION_NM),
        /// Damping of a stepper's drive, N·m·s/rad, of the motor.
        damping_nms: f64 = or(0.0).from(0.0, 1000.0),
        /// Pull-out torque of a stepper, of the motor, as `[speed_hz, torque_nm]` points, lowest speed first; straight lines between.
        pull_out: Vec<(f64, f64)> = or_value("[]").such_as("[[0, 5.0], [10, 4.6], [20, 2.5], [30, 1.7]]"),
        /// Drives of servos.
        servo: Option<ServoDrive> = optional(""),
        /// Induction motors with their frequency converters.
        induction: Option<InductionDrive> = optional(""),
    }
}

impl Axes {
    /// Full steps per turn of a usual stepper.
    pub const USUAL_FULL_STEPS: u32 = 200;
}

keys! {
    /// Servo drive: a position loop around a velocity loop. A drive that takes setpoints also has torque feed-forward.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct ServoDrive {
        /// Gain from the position error to the velocity, 1/s.
        position_gain_per_s: f64 = needed("200").from(1e-3, 1e5),
        /// Gain from the velocity error to the torque, N·m·s/rad.
        velocity_gain_nms: f64 = needed("1.5").from(1e-6, 1e5),
        /// Integral time of the velocity loop, s; without it, the loop has no integral part.
        integral_s: Option<f64> = optional("0.02").from(1e-5, 1e3),
        /// Torque limit, N·m, by the current limit.
        limit_nm: Option<f64> = optional("8.36").from(1e-3, 1e5),
        /// Part of the commanded velocity that is fed forward to the velocity loop.
        velocity_feed_forward: f64 = or(1.0).from(0.0, 1.0),
        /// Following-error window, degrees of the crank. Beyond it, the drive raises its alarm; without it, the drive has no alarm.
        following_error_deg: Option<f64> = optional("20").from(0.01, 180.0),
    }
}

keys! {
    /// Induction motor on a frequency converter that takes pulses. Torques and speeds are those of the motor.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct InductionDrive {
        /// Rated torque, N·m.
        rated_nm: f64 = needed("20").from(1e-3, 1e6),
        /// Slip at the rated torque, rev/s: the synchronous speed minus the speed of the motor.
        rated_slip_hz: f64 = needed("0.5").from(1e-4, 10.0),
        /// Breakdown torque over rated torque.
        breakdown_ratio: f64 = needed("2.5").from(1.1, 10.0),
        /// Gain from the position error to the converter's frequency, 1/s.
        position_gain_per_s: f64 = needed("5").from(1e-3, 1e3),
        /// Following-error window, degrees of the crank. Beyond it, the converter raises its alarm; without it, there is no alarm.
        following_error_deg: Option<f64> = optional("20").from(0.01, 180.0),
    }
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

impl Value for Drive {
    const KIND: Kind = Kind::Word(&["stepper", "servo", "pulse-servo", "induction"]);
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

keys! {
    /// Values of one axis that differ from those of all axes.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct AxisOverrides {
        /// Number of the axis, counted from 0.
        number: usize = needed("1"),
        /// True if the motor is mounted the other way round.
        reversed: bool = or_value("false"),
        /// Replaces the value in `[axes]`.
        drive: Option<Drive> = optional("servo"),
        /// Replaces the value in `[axes]`.
        steps_per_turn: Option<u32> = STEPS_PER_TURN.or_left_out(),
        /// Replaces the value in `[axes]`.
        gear: Option<(u32, u32)> = GEAR.or_left_out().such_as("[3, 1]"),
        /// Replaces the value in `[axes]`.
        ratio: Option<(u32, u32)> = RATIO.or_left_out().such_as("[1, 2]"),
        /// Replaces the value in `[axes]`.
        offset_deg: Option<f64> = OFFSET_DEG.or_left_out().such_as("90"),
        /// Replaces the value in `[axes]`.
        index: Option<bool> = optional("false"),
        /// Replaces the value in `[axes]`.
        index_deg: Option<f64> = INDEX_DEG.or_left_out().such_as("120"),
        /// Name of the `[[cam_table]]` that it follows, instead of a gear.
        cam: Option<String> = optional("lift"),
        /// Angle of the cam table at the master's phase 0, degrees.
        cam_shift_deg: f64 = CAM_SHIFT_DEG,
        /// Trim that is set from the start, degrees.
        trim_deg: f64 = TRIM_DEG,
        /// True phase of the crank at power-up, relative to the phase that the loop assumes, degrees.
        start_deg: f64 = OFFSET_DEG,
        /// Replaces the value in `[axes]`, such as for a stiffer bearing.
        friction_nm: Option<f64> = optional("0.5").from(0.0, MAX_FRICTION_NM),
        /// Factor on its pull-out torque, such as for a weaker motor.
        pull_out_scale: f64 = or(1.0).from(0.0, 10.0),
        /// Steps with which the simulated drive makes a turn of its crank, where its switches, or a gear, differ from the settings.
        drive_steps_per_turn: Option<u32> = optional("1600").from(4.0, 1e6),
    }
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
