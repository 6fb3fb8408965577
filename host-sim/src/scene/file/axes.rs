//! `[axes]` and `[[axis]]`: the motors.

use serde::{Deserialize, Serialize};

use super::lengths::{pair, pairs, some_pair};

/// What all axes have in common, unless an `[[axis]]` says otherwise.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Axes {
    /// How many, 2 to 6.
    pub count: usize,
    /// How they are driven.
    pub drive: Drive,
    /// Steps to a turn of the crank; the counts that a servo drive expects.
    pub steps_per_turn: u32,
    /// Full steps to a turn of the motor; a stepper slips by four of them.
    #[serde(default = "default_full_steps")]
    pub full_steps_per_turn: u32,
    /// Crank turns per master turn, as `[numerator, denominator]`.
    #[serde(default = "one_to_one", deserialize_with = "pair")]
    pub ratio: (u32, u32),
    /// Crank phase relative to the master's, degrees.
    #[serde(default)]
    pub offset_deg: f64,
    /// Whether the cranks have index sensors.
    #[serde(default = "yes")]
    pub index: bool,
    /// Crank phase at which the index sensor stands, degrees.
    #[serde(default)]
    pub index_deg: f64,
    /// Length of the index flag, degrees of the crank.
    #[serde(default)]
    pub index_width_deg: f64,
    /// Time from the flag's edge to the line's, µs.
    #[serde(default)]
    pub index_delay_us: f64,
    /// Whether the motors' encoders are read, at `steps_per_turn` counts to a turn.
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
    /// Inertia of rotor and crank, kg·m².
    #[serde(default)]
    pub rotor_inertia_kgm2: f64,
    /// Friction that each motor works against, N·m.
    #[serde(default)]
    pub friction_nm: f64,
    /// What a stepper's drive damps, N·m·s/rad.
    #[serde(default)]
    pub damping_nms: f64,
    /// Pull-out torque of a stepper as `[speed_hz, torque_nm]` points, lowest speed first; straight lines between.
    #[serde(
        default,
        deserialize_with = "pairs",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub pull_out: Vec<(f64, f64)>,
    /// The drives of servos.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo: Option<ServoDrive>,
    /// Induction motors with their frequency converters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub induction: Option<InductionDrive>,
}

/// A servo's drive: a position loop around a velocity loop. A drive that takes setpoints has torque feed-forward besides.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ServoDrive {
    /// Velocity to an error of position, 1/s.
    pub position_gain_per_s: f64,
    /// Torque to an error of velocity, N·m·s/rad.
    pub velocity_gain_nms: f64,
    /// Integral time of the velocity loop, s; without it the loop has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integral_s: Option<f64>,
    /// Greatest torque, N·m: the current limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_nm: Option<f64>,
    /// Share of the commanded velocity that the velocity loop gets directly, 0 to 1.
    #[serde(default = "one")]
    pub velocity_feed_forward: f64,
    /// Following-error window, degrees of the crank: beyond it the drive raises its alarm. Without it the drive has no alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub following_error_deg: Option<f64>,
}

/// An induction motor on a frequency converter that takes pulses; torques and speeds are those of the crank, behind the belt.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct InductionDrive {
    /// Rated torque, N·m.
    pub rated_nm: f64,
    /// Slip at the rated torque, rev/s: the synchronous speed less the speed of the crank.
    pub rated_slip_hz: f64,
    /// Breakdown torque, over the rated one.
    pub breakdown_ratio: f64,
    /// Correction of the converter's frequency to an error of position, 1/s.
    pub position_gain_per_s: f64,
    /// Following-error window, degrees of the crank: beyond it the converter raises its alarm. Without it there is no alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub following_error_deg: Option<f64>,
}

/// How an axis is driven.
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
    /// Whether the drive is commanded by STEP and DIR.
    pub const fn takes_pulses(self) -> bool {
        matches!(self, Self::Stepper | Self::PulseServo | Self::Induction)
    }
}

/// What one axis has apart from the others.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AxisOverrides {
    /// Which one, counted from 0.
    pub number: usize,
    /// Mounted the other way round.
    #[serde(default)]
    pub reversed: bool,
    /// Instead of the common one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive: Option<Drive>,
    /// Instead of the common one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps_per_turn: Option<u32>,
    /// Instead of the common one.
    #[serde(
        default,
        deserialize_with = "some_pair",
        skip_serializing_if = "Option::is_none"
    )]
    pub ratio: Option<(u32, u32)>,
    /// Instead of the common one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset_deg: Option<f64>,
    /// Instead of the common one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub index: Option<bool>,
    /// Instead of the common one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub index_deg: Option<f64>,
    /// Name of the `[[cam_table]]` that it follows, instead of a gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cam: Option<String>,
    /// Angle of that table at the master's phase 0, degrees.
    #[serde(default)]
    pub cam_shift_deg: f64,
    /// Trim that is set from the start, degrees.
    #[serde(default)]
    pub trim_deg: f64,
    /// Where the crank truly stands at power-up, against where the loop believes it, degrees.
    #[serde(default)]
    pub start_deg: f64,
    /// Instead of the common one: a stiffer bearing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_nm: Option<f64>,
    /// Factor on its pull-out torque: a weaker motor.
    #[serde(default = "one")]
    pub pull_out_scale: f64,
}

impl AxisOverrides {
    /// Axis that has nothing apart from the others.
    pub const fn new(number: usize) -> Self {
        Self {
            number,
            reversed: false,
            drive: None,
            steps_per_turn: None,
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
        }
    }
}

const fn default_full_steps() -> u32 {
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
