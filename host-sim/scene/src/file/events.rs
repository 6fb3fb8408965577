//! Inputs to a scene at stated times, and the window of `steps.vcd`.

use cophase_core::settings::key::needed;
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

/// Latest time in a run, s.
pub const MAX_S: f64 = 1e6;

keys! {
    /// Command at a time. A scene without a start command starts at 0 s.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct CommandAt {
        /// Time, s.
        at_s: f64 = needed("1").from(0.0, MAX_S),
        /// Command.
        r#do: CommandName = needed("stop"),
    }
}

words! {
    /// Command of an operator.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum CommandName {
        /// Run the program.
        Start = "start",
        /// Stop at the parking phase.
        Stop = "stop",
        /// Hold the program's time.
        Hold = "hold",
        /// Resume the program's time.
        Resume = "resume",
        /// Reset the fault.
        Reset = "reset",
        /// Reset the recorded peaks of the phase errors.
        ResetPeak = "reset-peak",
    }
}

keys! {
    /// Change of a safety input.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct InputAt {
        /// Time, s.
        at_s: f64 = needed("1").from(0.0, MAX_S),
        /// Input.
        line: InputLine = needed("stop"),
        /// State of the input. Enable: the drives may be on. Stop: the machine must stop.
        active: bool = needed("true"),
    }
}

words! {
    /// Safety input.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum InputLine {
        /// Enable input, active from the start.
        Enable = "enable",
        /// Stop input, not active at the start.
        Stop = "stop",
    }
}

keys! {
    /// A late start of one tick of the loop.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct LateAt {
        /// Time, s; the first deadline from then on is met late.
        at_s: f64 = needed("1").from(0.0, MAX_S),
        /// Delay, µs.
        by_us: f64 = needed("50").from(0.0, 1e6),
    }
}

keys! {
    /// Window of `steps.vcd`.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Scope {
        /// Start, s.
        from_s: f64 = needed("0.5").from(0.0, MAX_S),
        /// End, s.
        to_s: f64 = needed("1").from(0.0, MAX_S),
    }
}
