//! Structure of a scene file. Every key has its unit in its name; unknown keys are refused.
//!
//! Each module defines some tables of the file: `machine` or `cam`, `control` (with limits and monitoring), `axes`, `program`,
//! `events` (commands and inputs), and `fidelity` (model level and method).

mod axes;
mod cam;
mod cam_table;
mod control;
mod crusher;
mod events;
mod fault;
mod fidelity;
mod five_bar;
pub(crate) mod lengths;
mod machine;
mod program;
mod queries;
mod questions;
mod screen;
mod wiring;

pub use axes::{Axes, AxisOverrides, Drive, InductionDrive, ServoDrive, default_full_steps};
pub use cam::{CamShaft, Damper, LawName};
pub use cam_table::{CamSegment, CamTable};
pub use control::{Band, Correction, Limits};
pub use cophase_core::settings::{Control, Drift, IndexSettings as Index, PulseSettings as Pulse};
pub use crusher::{CrusherTable, Rock};
pub use events::{CommandAt, CommandName, InputAt, InputLine, LateAt, Scope};
pub use fault::{FaultAt, FaultName, Lines, MIN_ENABLE_LOSS_US, Noise};
pub use fidelity::{Fidelity, Method, MethodName};
pub use five_bar::{Assembly, ContactTable, FiveBarTable, Plane};
pub use machine::{Foundation, Frame, Machine, MechanismName, Platform, Rods};
pub use program::{Segment, Shape};
pub use questions::Questions;
pub use screen::ScreenTable;
pub use wiring::{InputName, Level, Link, LossReaction, Wiring};

use serde::{Deserialize, Serialize};

/// Scene.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name in titles and reports.
    pub name: String,
    /// Purpose of the scene, in one line.
    #[serde(default)]
    pub description: String,
    /// Model level, or `auto` for the lowest one that answers the questions.
    #[serde(default)]
    pub fidelity: Fidelity,
    /// Questions for `fidelity = "auto"`, with their tolerances.
    #[serde(default, skip_serializing_if = "Questions::is_none")]
    pub questions: Questions,
    /// Method of integration for machines that torque moves.
    #[serde(default, skip_serializing_if = "Method::is_default")]
    pub method: Method,
    /// Cranks under one platform, and its load; this or `cam`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<Machine>,
    /// Cam shafts, one per axis, each with a follower; this or `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cam: Option<CamShaft>,
    /// Vibrating screen, instead of `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screen: Option<ScreenTable>,
    /// Jaw crusher, instead of `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crusher: Option<CrusherTable>,
    /// Suspended five-bar arm, instead of `machine`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub five_bar: Option<FiveBarTable>,
    /// Cam tables that axes follow.
    #[serde(default, rename = "cam_table", skip_serializing_if = "Vec::is_empty")]
    pub cam_table: Vec<CamTable>,
    /// Frame under the cranks, if it moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    /// Settings of the loop.
    #[serde(default)]
    pub control: Control,
    /// Limits of the master shaft.
    pub limits: Limits,
    /// Timing of the step lines.
    #[serde(default)]
    pub pulse: Pulse,
    /// Values for all axes.
    pub axes: Axes,
    /// Values of single axes that differ from those.
    #[serde(default, rename = "axis", skip_serializing_if = "Vec::is_empty")]
    pub axis: Vec<AxisOverrides>,
    /// Filter of the index lines.
    #[serde(default)]
    pub index: Index,
    /// Limits of the phase errors.
    #[serde(default)]
    pub drift: Drift,
    /// Corrections of phase errors.
    #[serde(default, skip_serializing_if = "Correction::is_none")]
    pub correction: Correction,
    /// Noise of sensors and loads.
    #[serde(default, skip_serializing_if = "Noise::is_none")]
    pub noise: Noise,
    /// Active levels of the board's lines.
    #[serde(default, skip_serializing_if = "Wiring::is_default")]
    pub wiring: Wiring,
    /// Action when the host that started the machine is lost.
    #[serde(default, skip_serializing_if = "Link::is_default")]
    pub link: Link,
    /// Program amax(t).
    pub program: Vec<Segment>,
    /// Commands at stated times.
    #[serde(default, rename = "command", skip_serializing_if = "Vec::is_empty")]
    pub command: Vec<CommandAt>,
    /// Changes of the enable and stop inputs.
    #[serde(default, rename = "input", skip_serializing_if = "Vec::is_empty")]
    pub input: Vec<InputAt>,
    /// Faults that the run injects.
    #[serde(default, rename = "fault", skip_serializing_if = "Vec::is_empty")]
    pub fault: Vec<FaultAt>,
    /// Late ticks of the loop.
    #[serde(default, rename = "late", skip_serializing_if = "Vec::is_empty")]
    pub late: Vec<LateAt>,
    /// Part of the run that `steps.vcd` shows. The default is 200 ms around the first injected fault, else around the first slip
    /// or latched fault, else the first 200 ms of motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scope: Option<Scope>,
}
