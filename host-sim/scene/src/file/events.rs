//! Inputs to a scene at stated times, and the window of `steps.vcd`.

use serde::{Deserialize, Serialize};

/// Command at a time. A scene without a start command starts at 0 s.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CommandAt {
    /// Time, s.
    pub at_s: f64,
    /// Command.
    #[serde(rename = "do")]
    pub action: CommandName,
}

/// Command of an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommandName {
    /// Run the program.
    Start,
    /// Stop at the parking phase.
    Stop,
    /// Hold the program's time.
    Hold,
    /// Resume the program's time.
    Resume,
    /// Reset the fault.
    Reset,
    /// Reset the recorded peaks of the phase errors.
    ResetPeak,
}

/// Change of a safety input.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct InputAt {
    /// Time, s.
    pub at_s: f64,
    /// Input.
    pub line: InputLine,
    /// State of the input. Enable: the drives may be on. Stop: the machine must stop.
    pub active: bool,
}

/// Safety input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputLine {
    /// Enable input, active from the start.
    Enable,
    /// Stop input, not active at the start.
    Stop,
}

/// A late start of one tick of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LateAt {
    /// Time, s; the first deadline from then on is met late.
    pub at_s: f64,
    /// Delay, µs.
    pub by_us: f64,
}

/// Window of `steps.vcd`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scope {
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
}
