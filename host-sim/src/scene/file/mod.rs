//! The form of a scene file. Every key carries its unit; unknown keys are refused.
//!
//! A file here is a table there: `machine` or `cam`, `control` (with limits and what is watched), `axes`, `program`, and
//! what happens to a scene from outside, `events`. How it is computed, `fidelity` says.

mod axes;
mod cam;
mod cam_table;
mod control;
mod events;
mod fault;
mod fidelity;
mod lengths;
mod machine;
mod program;
mod questions;
mod wiring;

pub use axes::{Axes, AxisOverrides, Drive, InductionDrive, ServoDrive};
pub use cam::{CamShaft, Damper, LawName};
pub use cam_table::{CamSegment, CamTable};
pub use control::{Band, Control, Correction, Drift, Index, Limits, Pulse};
pub use events::{CommandAt, CommandName, InputAt, InputLine, LateAt, Scope};
pub use fault::{FaultAt, FaultName, Lines, Noise};
pub use fidelity::{Fidelity, Method, MethodName};
pub use machine::{Foundation, Frame, Machine, Platform, Rods};
pub use program::{Segment, Shape};
pub use questions::Questions;
pub use wiring::{InputName, Level, Link, LossReaction, Wiring};

use serde::{Deserialize, Serialize};

use crate::plant::crusher::CrusherTable;
use crate::plant::five_bar::FiveBarTable;
use crate::plant::screen::ScreenTable;

/// A whole scene.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// What it is called, in titles and reports.
    pub name: String,
    /// One line that says what it shows.
    #[serde(default)]
    pub description: String,
    /// How much model: the lowest model level of the ladder that answers the question.
    #[serde(default)]
    pub fidelity: Fidelity,
    /// What `fidelity = "auto"` has to answer, and how well.
    #[serde(default, skip_serializing_if = "Questions::is_none")]
    pub questions: Questions,
    /// How a machine that torque moves is advanced.
    #[serde(default, skip_serializing_if = "Method::is_default")]
    pub method: Method,
    /// The mechanism and what it carries: cranks under one platform; this or `cam`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<Machine>,
    /// A cam shaft an axis, each with a follower of its own; this or `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cam: Option<CamShaft>,
    /// A vibrating screen; this instead of `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screen: Option<ScreenTable>,
    /// A jaw crusher; this instead of `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crusher: Option<CrusherTable>,
    /// A suspended five-bar arm; this instead of `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub five_bar: Option<FiveBarTable>,
    /// Curves that axes follow.
    #[serde(default, rename = "cam_table", skip_serializing_if = "Vec::is_empty")]
    pub cam_table: Vec<CamTable>,
    /// What the cranks stand on, if that moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
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
    pub axis: Vec<AxisOverrides>,
    /// What counts as a pulse of an index line.
    #[serde(default)]
    pub index: Index,
    /// How far the cranks may be apart.
    #[serde(default)]
    pub drift: Drift,
    /// What is done against it.
    #[serde(default, skip_serializing_if = "Correction::is_none")]
    pub correction: Correction,
    /// What sensors and loads make of themselves.
    #[serde(default, skip_serializing_if = "Noise::is_none")]
    pub noise: Noise,
    /// Levels of the board's lines.
    #[serde(default, skip_serializing_if = "Wiring::is_default")]
    pub wiring: Wiring,
    /// Loss of the host that started the machine.
    #[serde(default, skip_serializing_if = "Link::is_default")]
    pub link: Link,
    /// amax(t).
    pub program: Vec<Segment>,
    /// Commands that come at a time.
    #[serde(default, rename = "command", skip_serializing_if = "Vec::is_empty")]
    pub command: Vec<CommandAt>,
    /// Changes of the enable and stop inputs.
    #[serde(default, rename = "input", skip_serializing_if = "Vec::is_empty")]
    pub input: Vec<InputAt>,
    /// What goes wrong.
    #[serde(default, rename = "fault", skip_serializing_if = "Vec::is_empty")]
    pub fault: Vec<FaultAt>,
    /// Lateness of the loop.
    #[serde(default, rename = "late", skip_serializing_if = "Vec::is_empty")]
    pub late: Vec<LateAt>,
    /// Which part of the run `steps.vcd` shows; without it, 200 ms around the first fault that is put in, around the
    /// first slip or latched fault, or the first of motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scope: Option<Scope>,
}
