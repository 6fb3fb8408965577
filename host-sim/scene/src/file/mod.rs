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
mod machine;
mod program;
mod queries;
mod questions;
mod screen;
mod wiring;

pub use axes::{Axes, AxisOverrides, Drive, InductionDrive, ServoDrive};
pub use cam::{CamShaft, Damper, LawName};
pub use cam_table::{CamSegment, CamTable};
pub use control::{Band, Correction, Limits};
pub use cophase_core::settings::{Control, Drift, IndexSettings as Index, PulseSettings as Pulse};
pub use crusher::{CrusherTable, Rock};
pub use events::{CommandAt, CommandName, InputAt, InputLine, LateAt, MAX_S, Scope};
pub use fault::{FaultAt, FaultName, Lines, MIN_ENABLE_LOSS_US, Noise};
pub use fidelity::{Fidelity, Method, MethodName};
pub use five_bar::{Assembly, ContactTable, FiveBarTable, Plane};
pub use machine::{Foundation, Frame, Machine, MechanismName, Platform, Rods};
pub use program::{Segment, Shape};
pub use queries::Axis;
pub use questions::Questions;
pub use screen::ScreenTable;
pub use wiring::{InputName, Level, Link, LossReaction, Wiring};

use cophase_core::keys;
use cophase_core::settings::key::{needed, optional, or_value};
use serde::{Deserialize, Serialize};

/// Returns true if all keys of a table have their defaults.
fn is_unset<T: Default + PartialEq>(table: &T) -> bool {
    *table == T::default()
}

/// Tables of machines. A scene has one of them.
pub const MACHINES: [&str; 5] = ["machine", "cam", "screen", "crusher", "five_bar"];

keys! {
    /// Scene.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Scene {
        /// Name in titles and reports.
        name: String = needed("default"),
        /// Purpose of the scene, in one line.
        description: String = or_value("").such_as("three motors hold 40 g for a minute"),
        /// Model level, or `auto` for the lowest one that answers the questions.
        fidelity: Fidelity = or_value("auto"),
        /// Questions for `fidelity = "auto"`, with their tolerances.
        questions: Questions = or_value("{}"),
        /// Method of integration for machines that torque moves.
        method: Method = or_value("{}"),
        /// Cranks under one platform, and its load; this or `cam`.
        machine: Option<Machine> = optional(""),
        /// Cam shafts, one per axis, each with a follower; this or `machine`.
        cam: Option<CamShaft> = optional(""),
        /// Vibrating screen, instead of `machine`.
        screen: Option<ScreenTable> = optional(""),
        /// Jaw crusher, instead of `machine`.
        crusher: Option<CrusherTable> = optional(""),
        /// Suspended five-bar arm, instead of `machine`.
        five_bar: Option<FiveBarTable> = optional(""),
        /// Cam tables that axes follow.
        cam_table: Vec<CamTable> = or_value("[]"),
        /// Frame under the cranks, if it moves.
        frame: Option<Frame> = optional(""),
        /// Settings of the loop.
        control: Control = or_value("{}"),
        /// Limits of the master shaft.
        limits: Limits = needed(""),
        /// Timing of the STEP and DIR lines.
        pulse: Pulse = or_value("{}"),
        /// Values for all axes.
        axes: Axes = needed(""),
        /// Values of single axes that differ from those.
        axis: Vec<AxisOverrides> = or_value("[]"),
        /// Filter of the index lines.
        index: Index = or_value("{}"),
        /// Limits on phase errors.
        drift: Drift = or_value("{}"),
        /// Corrections of phase errors.
        correction: Correction = or_value("{}"),
        /// Noise of sensors and loads.
        noise: Noise = or_value("{}"),
        /// Active levels of the board's lines.
        wiring: Wiring = or_value("{}"),
        /// Action when the host that started the machine is lost.
        link: Link = or_value("{}"),
        /// Program amax(t).
        program: Vec<Segment> = needed(""),
        /// Commands at stated times.
        command: Vec<CommandAt> = or_value("[]"),
        /// Changes of the enable and stop inputs.
        input: Vec<InputAt> = or_value("[]"),
        /// Faults that the run injects.
        fault: Vec<FaultAt> = or_value("[]"),
        /// Late ticks of the loop.
        late: Vec<LateAt> = or_value("[]"),
        /// Part of the run that `steps.vcd` shows. The default is 200 ms around the first injected fault, else around the first slip
        /// or latched fault, else the first 200 ms of motion.
        scope: Option<Scope> = optional(""),
    }
}
