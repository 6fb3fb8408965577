//! Events of a run.

use cophase_core::supervisor::{Command, Fault, RefusedCommand, State};
use cophase_core::units::PerAxis;
use cophase_scene::file::{FaultAt, InputLine};
use serde::Serialize;

/// Event at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Time, s since power-up.
    pub t_s: f64,
    /// Kind of the event.
    pub what: EventKind,
}

/// Kind of an event.
#[derive(Clone, Debug, PartialEq)]
pub enum EventKind {
    /// The supervisor changed its state. [`EventKind::Running`] and [`EventKind::Stopped`] report the states run and fault.
    State(State),
    /// The machine stands in the fault state.
    Stopped {
        /// True if the drives hold the cranks.
        holds: bool,
    },
    /// The drives, which held in the fault state, were switched off.
    LetGo,
    /// The program began, or continued.
    Running {
        /// Program time at which it continues, s.
        from_s: f64,
    },
    /// A command was given.
    Commanded(Command),
    /// A command was not possible, and had no effect.
    Refused(RefusedCommand),
    /// A safety input changed.
    Input {
        /// Input that changed.
        line: InputLine,
        /// New level of the input.
        active: bool,
    },
    /// The speed of the shaft entered a forbidden band, and left it at the other edge.
    BandCrossed {
        /// Time inside the band, s.
        in_s: f64,
        /// True if it entered at the lower edge and left at the upper one.
        upwards: bool,
    },
    /// The speed of the shaft entered a forbidden band, and left it at the same edge, because of a stop.
    TurnedBackInBand {
        /// Time inside the band, s.
        in_s: f64,
        /// True if it entered at the lower edge.
        entered_upwards: bool,
    },
    /// The program requested a speed in a forbidden band, and an edge of the band was commanded instead.
    HeldAtBand {
        /// Duration, s.
        for_s: f64,
    },
    /// The shaft could not follow the program.
    Lagged {
        /// Duration, s.
        for_s: f64,
        /// Largest deviation of amax, m/s².
        worst_mps2: f64,
    },
    /// An axis slipped by whole electrical cycles.
    Slipped {
        /// Number of the axis.
        axis: usize,
        /// Cycles by which it is off now; negative is behind.
        cycles: i64,
    },
    /// The controller corrected phase errors in a run: it moved the offsets of axes.
    Corrected {
        /// Angle by which each axis was moved, degrees; 0 for an axis that does not exist. The angles add up
        /// to zero to a step, as the offsets before and after do so to half a step.
        by_deg: PerAxis<f64>,
        /// Duration, s.
        in_s: f64,
    },
    /// The loop missed deadlines completely.
    Missed {
        /// Number of deadlines.
        deadlines: u32,
    },
    /// The scene injected a fault.
    Injected(FaultAt),
    /// The loop reported a fault, whatever its reaction.
    Reported(Fault),
    /// A fault latched.
    Fault {
        /// Fault that latched.
        fault: Fault,
        /// Side of the platform that led at that time, degrees around it from axis 0 towards axis 1; none if no side led.
        leading_deg: Option<f32>,
    },
}

/// Cause of a stop of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum StoppedBy {
    /// The program ended.
    #[serde(rename = "program end")]
    ProgramEnd,
    /// A command, or the stop input.
    #[serde(rename = "request")]
    Request,
    /// A fault.
    #[serde(rename = "fault")]
    Fault,
}
