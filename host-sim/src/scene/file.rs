//! The form of a scene file. Every key carries its unit; unknown keys are refused.

use cophase_methods::Scheme;
use serde::{Deserialize, Serialize};

/// A whole scene.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// What it is called, in titles and reports.
    pub name: String,
    /// One line that says what it shows.
    #[serde(default)]
    pub description: String,
    /// How much model: the lowest rung of the ladder that answers the question.
    #[serde(default)]
    pub fidelity: Fidelity,
    /// How a machine that torque moves is advanced.
    #[serde(default, skip_serializing_if = "Method::is_default")]
    pub method: Method,
    /// The mechanism and what it carries.
    pub machine: Machine,
    /// The loop.
    #[serde(default)]
    pub control: Control,
    /// What the master shaft may do.
    pub limits: Limits,
    /// The step lines' timing.
    #[serde(default)]
    pub pulse: Pulse,
    /// What all axes have in common.
    pub axes: Axes,
    /// What single axes have apart.
    #[serde(default, rename = "axis", skip_serializing_if = "Vec::is_empty")]
    pub axis: Vec<AxisApart>,
    /// What counts as a pulse of an index line.
    #[serde(default)]
    pub index: Index,
    /// How far the cranks may be apart.
    #[serde(default)]
    pub drift: Drift,
    /// amax(t).
    pub program: Vec<Segment>,
    /// Commands that come at a time.
    #[serde(default, rename = "command", skip_serializing_if = "Vec::is_empty")]
    pub command: Vec<CommandAt>,
    /// Changes of the enable and stop inputs.
    #[serde(default, rename = "input", skip_serializing_if = "Vec::is_empty")]
    pub input: Vec<InputAt>,
    /// Lateness of the loop.
    #[serde(default, rename = "late", skip_serializing_if = "Vec::is_empty")]
    pub late: Vec<LateAt>,
    /// Which part of the run `steps.vcd` shows; without it, the first 200 ms of motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scope: Option<Scope>,
}

/// How much model a scene gets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fidelity {
    /// The lowest rung that answers the scene's question.
    #[default]
    Auto,
    /// Axes are where they are told to be; the platform follows from geometry.
    Kinematic,
    /// The torque that motion needs, against the torque that each motor has.
    QuasiStatic,
    /// All cranks on one shaft, moved by the motors' torque.
    Rigid,
    /// Each crank its own rotor, moved by its motor's torque; the platform tilts.
    Phased,
}

impl Fidelity {
    /// As it is written in scenes and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Kinematic => "kinematic",
            Self::QuasiStatic => "quasi-static",
            Self::Rigid => "rigid",
            Self::Phased => "phased",
        }
    }
}

/// How a machine that torque moves is advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Method {
    /// Which method.
    pub name: MethodName,
    /// How many steps it makes in a control tick; by default as many as the machine's fastest mode asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps_per_tick: Option<u32>,
}

impl Method {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A method by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// What is best for the machine: RK4 at a step that follows its fastest mode.
    #[default]
    Auto,
    /// Order 1; unstable without damping.
    ExplicitEuler,
    /// Order 1; keeps energy.
    SymplecticEuler,
    /// Order 2; keeps energy.
    VelocityVerlet,
    /// Order 4.
    Rk4,
    /// Order 2, implicit; keeps energy.
    ImplicitMidpoint,
    /// Order 4, implicit; fast modes die away.
    Sdirk4,
}

impl MethodName {
    /// The method; none if it is to be chosen.
    pub const fn scheme(self) -> Option<Scheme> {
        Some(match self {
            Self::Auto => return None,
            Self::ExplicitEuler => Scheme::ExplicitEuler,
            Self::SymplecticEuler => Scheme::SymplecticEuler,
            Self::VelocityVerlet => Scheme::VelocityVerlet,
            Self::Rk4 => Scheme::Rk4,
            Self::ImplicitMidpoint => Scheme::ImplicitMidpoint,
            Self::Sdirk4 => Scheme::Sdirk4,
        })
    }
}

/// The slider-crank platform.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Crank radius, mm.
    pub crank_radius_mm: f64,
    /// Crank radius over rod length; give this or `rod_length_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lambda: Option<f64>,
    /// Rod length, mm; give this or `lambda`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rod_length_mm: Option<f64>,
    /// Mass on the platform, kg.
    pub load_kg: f64,
    /// Which way up.
    #[serde(default)]
    pub platform: Platform,
    /// Gravity, m/s².
    #[serde(default = "standard_gravity")]
    pub gravity_mps2: f64,
    /// Radius of the circle on which the cranks stand, mm.
    #[serde(default = "default_mount_radius_mm")]
    pub mount_radius_mm: f64,
    /// Inertia of platform and load about a tilt axis, kg·m²; by default that of an even disc as wide as the mount.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_inertia_kgm2: Option<f64>,
    /// Stiffness of a rod with its bearings, N/µm.
    #[serde(default = "default_rod_stiffness")]
    pub rod_n_per_um: f64,
}

/// Which way up the platform is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Platform {
    /// Above the cranks.
    #[default]
    Above,
    /// Below the cranks.
    Below,
}

impl From<Platform> for cophase_core::settings::Platform {
    fn from(platform: Platform) -> Self {
        match platform {
            Platform::Above => Self::Above,
            Platform::Below => Self::Below,
        }
    }
}

/// The loop.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Control {
    /// Control ticks a second.
    pub tick_hz: u32,
    /// Crank phase at which the machine parks, degrees.
    pub park_deg: f64,
    /// Time that energised drives get to settle, s.
    pub settle_s: f64,
}

impl Default for Control {
    fn default() -> Self {
        Self {
            tick_hz: 2000,
            park_deg: 180.0,
            settle_s: 0.1,
        }
    }
}

/// What the master shaft may do.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Greatest speed, rev/s.
    pub speed_hz: f64,
    /// Greatest acceleration, rev/s².
    pub acceleration_hz_per_s: f64,
    /// Greatest jerk, rev/s³.
    pub jerk_hz_per_s2: f64,
    /// Speed of the slow turn that finds index pulses and the parking phase, rev/s.
    #[serde(default = "default_creep_hz")]
    pub creep_hz: f64,
    /// Speeds at which the machine must not dwell, lowest first.
    #[serde(default, rename = "band", skip_serializing_if = "Vec::is_empty")]
    pub band: Vec<Band>,
}

/// A forbidden band of speeds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Lower edge, rev/s.
    pub from_hz: f64,
    /// Upper edge, rev/s.
    pub to_hz: f64,
}

/// Timing of the step lines.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pulse {
    /// Shortest time that STEP stays high, and low, ns.
    pub width_ns: f64,
    /// DIR before STEP, ns.
    pub dir_setup_ns: f64,
    /// DIR after STEP, ns.
    pub dir_hold_ns: f64,
}

impl Default for Pulse {
    fn default() -> Self {
        Self {
            width_ns: 400.0,
            dir_setup_ns: 500.0,
            dir_hold_ns: 500.0,
        }
    }
}

/// What all axes have in common, unless an `[[axis]]` says otherwise.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Axes {
    /// How many, 2 to 6.
    pub count: usize,
    /// How they are driven.
    pub drive: Drive,
    /// Steps, or encoder counts, to a turn of the crank.
    pub steps_per_turn: u32,
    /// Full steps to a turn of the motor; a stepper slips by four of them.
    #[serde(default = "default_full_steps")]
    pub full_steps_per_turn: u32,
    /// Crank turns per master turn, as `[numerator, denominator]`.
    #[serde(default = "one_to_one")]
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
    /// Torque of a servo's drive to an error of position, N·m/rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_stiffness_nm: Option<f64>,
    /// Torque of a servo's drive to an error of speed, N·m·s/rad; by default critical for the rotor alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_damping_nms: Option<f64>,
    /// Greatest torque of a servo, N·m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_limit_nm: Option<f64>,
    /// Pull-out torque of a stepper as `[speed_hz, torque_nm]` points, lowest speed first; straight lines between.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pull_out: Vec<(f64, f64)>,
}

/// How an axis is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drive {
    /// Step and direction pulses, open loop.
    Stepper,
    /// Position, velocity and torque setpoints.
    Servo,
}

/// What one axis has apart from the others.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AxisApart {
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
    #[serde(skip_serializing_if = "Option::is_none")]
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

/// What counts as a pulse of an index line.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Index {
    /// Shortest time that a level must last to be no glitch, µs.
    pub width_us: f64,
}

impl Default for Index {
    fn default() -> Self {
        Self { width_us: 2.0 }
    }
}

/// How far the cranks may be apart.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drift {
    /// Platform tilt, mrad.
    pub tilt_limit_mrad: f64,
    /// Deviation of a crank from the plane through all, degrees.
    pub warp_limit_deg: f64,
    /// Mean lag of all, degrees.
    pub common_limit_deg: f64,
}

impl Default for Drift {
    fn default() -> Self {
        Self {
            tilt_limit_mrad: 3.0,
            warp_limit_deg: 3.0,
            common_limit_deg: 15.0,
        }
    }
}

/// An entry of the program: a level and the way to it, or a block that is repeated.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Level, in units of 9.80665 m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amax_g: Option<f64>,
    /// Time to get there, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ramp_s: Option<f64>,
    /// Time to stay there, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold_s: Option<f64>,
    /// Shape of the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// How often `segments` are played in all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<u32>,
    /// The block that is repeated; blocks may hold blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segments: Option<Vec<Segment>>,
}

/// Shape of the way to a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// In proportion to time.
    Linear,
    /// With continuous second derivative.
    #[default]
    Smooth,
}

/// A command at a time. A start at 0 s is given unless the scene gives one of its own.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CommandAt {
    /// When, s.
    pub at_s: f64,
    /// What.
    #[serde(rename = "do")]
    pub action: CommandName,
}

/// What can be commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommandName {
    /// Run the program.
    Start,
    /// Stop at the parking phase.
    Stop,
    /// Let the program's time stand still.
    Hold,
    /// Let it go on.
    Resume,
    /// Leave the fault state.
    Reset,
}

/// A change of a safety input.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct InputAt {
    /// When, s.
    pub at_s: f64,
    /// Which.
    pub line: InputLine,
    /// enable: the drives may be on. stop: the machine shall stop.
    pub active: bool,
}

/// The safety inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputLine {
    /// Active from the start.
    Enable,
    /// Not active from the start.
    Stop,
}

/// The loop wakes late, once.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LateAt {
    /// The first deadline from this time on, s.
    pub at_s: f64,
    /// By how much, µs.
    pub by_us: f64,
}

/// A window, as an oscilloscope has one.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scope {
    /// From, s.
    pub from_s: f64,
    /// To, s.
    pub to_s: f64,
}

const fn standard_gravity() -> f64 {
    9.80665
}
const fn default_mount_radius_mm() -> f64 {
    250.0
}
const fn default_creep_hz() -> f64 {
    1.0
}
const fn default_rod_stiffness() -> f64 {
    50.0
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
