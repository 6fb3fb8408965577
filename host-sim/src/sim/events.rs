//! What can happen in a run.

use cophase_core::supervisor::{Command, Fault, State};

use crate::scene::file::{FaultAt, InputLine};

/// Something that happened at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When, s since power-up.
    pub t_s: f64,
    /// What.
    pub what: EventKind,
}

/// What can happen.
#[derive(Clone, Debug, PartialEq)]
pub enum EventKind {
    /// The supervisor changed its state; to running, see [`EventKind::Running`], and to fault, [`EventKind::Stopped`].
    State(State),
    /// The machine stands in the fault state.
    Stopped {
        /// Whether the drives hold the cranks.
        holds: bool,
    },
    /// Drives that held in the fault state were switched off.
    LetGo,
    /// The program began, or went on.
    Running {
        /// From which of its seconds.
        from_s: f64,
    },
    /// A command was given.
    Commanded(Command),
    /// A safety input changed.
    Input {
        /// Which.
        line: InputLine,
        /// To what.
        active: bool,
    },
    /// The shaft went into a forbidden band, and came out of it after that many seconds.
    BandCrossed {
        /// Time inside, s.
        in_s: f64,
        /// Whether it went in at the lower edge and came out at the upper one.
        upwards: bool,
    },
    /// The shaft went into a forbidden band, and came out after that many seconds at the edge where it went in: a stop turned
    /// it back.
    TurnedBackInBand {
        /// Time inside, s.
        in_s: f64,
        /// Whether it went in at the lower edge.
        entered_upwards: bool,
    },
    /// The program requested a speed in a forbidden band, for that many seconds, and an edge of the band was commanded.
    HeldAtBand {
        /// For how long, s.
        for_s: f64,
    },
    /// The shaft could not follow the program, for that many seconds.
    Lagged {
        /// For how long, s.
        for_s: f64,
        /// By at most how much, in amax, m/s².
        worst_mps2: f64,
    },
    /// An axis slipped by whole electrical cycles.
    Slipped {
        /// Which.
        axis: usize,
        /// How many it is off now; negative: behind.
        cycles: i64,
    },
    /// Deadlines were missed altogether.
    Missed {
        /// How many.
        deadlines: u32,
    },
    /// The scene puts in a fault.
    Injected(FaultAt),
    /// The loop reports something, whatever it does about it.
    Reported(Fault),
    /// A fault latched.
    Fault {
        /// What was seen.
        fault: Fault,
        /// Side of the platform that led then, degrees around it from axis 0 towards axis 1, if one did.
        leading_deg: Option<f32>,
    },
}

/// What made a machine stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoppedBy {
    /// The program was over.
    ProgramEnd,
    /// A command, or the stop input.
    Request,
    /// A fault.
    Fault,
}
