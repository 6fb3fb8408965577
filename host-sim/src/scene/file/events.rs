//! What comes from outside at a time, and what is looked at.

use serde::{Deserialize, Serialize};

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
    /// Forget the largest phase errors so far.
    ResetPeak,
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
