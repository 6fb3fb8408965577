//! Requests of a browser, as JSON: `{"id": 1, "request": "start"}`.

use serde::Deserialize;
use serde_json::{Map, Value};

/// Number of a request, which the reply repeats.
#[derive(Debug, Deserialize)]
pub(super) struct Numbered {
    pub(super) id: u64,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "request", rename_all = "kebab-case")]
pub(super) enum Request {
    /// Takes control, if no other browser and no other host has it.
    TakeControl,
    ReleaseControl,
    Arm,
    Disarm,
    Start,
    /// Stops at the parking phase, or now. Needs no control.
    Stop {
        now: bool,
    },
    Hold,
    Resume,
    Reset,
    Home,
    /// Turns the machine for 0.5 s.
    Jog,
    /// Scales the amplitude, thousandths.
    Override {
        permille: u16,
    },
    /// Loads the program of a scene, TOML.
    Load {
        text: String,
    },
    /// Restarts the controller. A simulated controller restarts with its machine in the initial state.
    Restart,
    /// Injects a fault into a simulated machine: the keys of `[[fault]]` except `at_s`.
    Inject {
        fault: Map<String, Value>,
    },
}

impl Request {
    /// Returns the name of the request, for errors.
    pub(super) const fn name(&self) -> &'static str {
        match self {
            Self::TakeControl | Self::ReleaseControl => "control",
            Self::Arm => "arm",
            Self::Disarm => "disarm",
            Self::Start => "start",
            Self::Stop { .. } => "stop",
            Self::Hold => "hold",
            Self::Resume => "resume",
            Self::Reset => "reset",
            Self::Home => "home",
            Self::Jog => "jog",
            Self::Override { .. } => "override",
            Self::Load { .. } => "load",
            Self::Restart => "restart",
            Self::Inject { .. } => "inject",
        }
    }
}
