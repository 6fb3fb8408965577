//! Requests of a browser, as JSON: `{"id": 1, "request": "start"}`.
//!
//! Every request other than a stop has an [`Order`]. A stop discards all requests that came before it and are not carried out yet, and a
//! request that waited too long is discarded, too.

use std::borrow::Cow;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use serde::Deserialize;
use serde_json::{Map, Value};

use crate::link::stops::Stops;

/// Longest request other than to load a program, bytes.
const MAX_SHORT_BYTES: usize = 4096;

/// Longest time that a request waits.
const MAX_WAIT: Duration = Duration::from_secs(10);

/// Number of a request, which the reply repeats.
#[derive(Debug, Deserialize)]
struct Numbered {
    id: u64,
}

/// Request to load a program. It is parsed without the memory that a request of any form may take.
#[derive(Debug, Deserialize)]
struct Load<'a> {
    #[serde(borrow)]
    request: Cow<'a, str>,
    text: String,
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
        /// Program as the controller takes it, after the check.
        #[serde(skip)]
        program: Vec<u8>,
    },
    /// Restarts the controller. A simulated controller restarts with its machine in the initial state.
    Restart,
    /// Injects a fault into a simulated machine: the keys of `[[fault]]` except `at_s`.
    Inject {
        fault: Map<String, Value>,
    },
}

impl Request {
    /// Parses a request. Returns its number, which an invalid request may have, too.
    pub(super) fn parse(text: &str) -> (u64, Result<Self, String>) {
        let number = serde_json::from_str(text).map_or(0, |Numbered { id }| id);
        let parsed = if text.len() <= MAX_SHORT_BYTES {
            serde_json::from_str(text)
        } else {
            serde_json::from_str(text).and_then(|Load { request, text }| {
                if request == "load" {
                    let program = Vec::new();
                    return Ok(Self::Load { text, program });
                }
                Err(serde::de::Error::custom(format_args!(
                    "{request} is longer than {MAX_SHORT_BYTES} bytes"
                )))
            })
        };
        let parsed = parsed.map_err(|error| format!("the request is not understood: {error}"));
        (number, parsed)
    }

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

/// Place of a request among the stops, and the end of its validity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Order {
    stops: u64,
    end: Instant,
}

impl Order {
    /// Order of a request that arrives now.
    pub(super) fn now(stops: &Stops) -> Self {
        Self {
            stops: stops.requested(),
            end: Instant::now() + MAX_WAIT,
        }
    }

    /// Checks that the request may still be carried out.
    pub(super) fn check(self, stops: &Stops) -> Result<(), String> {
        if stops.requested() != self.stops {
            return Err("a stop came after this request; make it again".to_owned());
        }
        if Instant::now() > self.end {
            return Err(format!(
                "the request waited longer than {} s; make it again",
                MAX_WAIT.as_secs()
            ));
        }
        Ok(())
    }
}

/// Request on its way. Whoever answers it takes it.
#[derive(Debug)]
pub(super) struct Pending {
    /// The browser's number.
    pub(super) browser: u32,
    pub(super) request: Request,
    pub(super) order: Order,
    pub(super) reply: SyncSender<Result<(), String>>,
}

impl Pending {
    pub(super) fn answer(self, outcome: Result<(), String>) {
        // The browser may have left. Otherwise, there is room for the one reply.
        let _ = self.reply.try_send(outcome);
    }
}
