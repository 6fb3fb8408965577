//! Errors of requests: each has its place, the problem, and what to do.

use std::io;

use cophase_core::supervisor::State;
use cophase_files::report;
use cophase_link::Condition;
use cophase_link::message::{Refusal, Request};

/// Reason why a request has no reply of use.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LinkError {
    #[error("{request}: refused: {refusal}")]
    Refused {
        request: &'static str,
        refusal: Box<Refusal>,
    },
    #[error("{request}: refused: {refusal}; it is possible {remedy}")]
    NotNow {
        request: &'static str,
        refusal: Box<Refusal>,
        remedy: String,
    },
    #[error("{request}: no reply; {unknown}")]
    NoReply {
        request: &'static str,
        /// Effect that the request may have had, and how to find out.
        unknown: String,
    },
    #[error(
        "{0}: the controller sent another reply than requested; use the `cophase` of the firmware's version"
    )]
    Unexpected(&'static str),
    #[error("{request}: the line is lost: {error}; connect the controller again; {unknown}")]
    LostReply {
        request: &'static str,
        error: io::Error,
        unknown: String,
    },
    #[error(
        "{request}: the controller sent {problem}; use the `cophase` of the firmware's version, or connect another controller"
    )]
    Wrong {
        request: &'static str,
        problem: String,
    },
    #[error("the line is lost: {0}; connect the controller again")]
    Line(io::Error),
    #[error("{0}")]
    NoController(NoController),
    #[error("{0}")]
    Input(String),
}

/// Something else than a controller is at the other end of the line. A transport finds it out, and wraps it in [`io::Error`].
#[derive(Debug, thiserror::Error)]
#[error("--to {to}: {problem}; give the port at which the controller's server listens")]
pub(crate) struct NoController {
    pub(super) to: String,
    pub(super) problem: String,
}

impl From<io::Error> for LinkError {
    fn from(error: io::Error) -> Self {
        match error.downcast() {
            Ok(error) => Self::NoController(error),
            Err(error) => Self::Line(error),
        }
    }
}

impl LinkError {
    /// Creates the error of a request without a reply. `check` is what to check if the request has no effect.
    pub(super) fn no_reply(name: &'static str, request: &Request<'_>, check: &str) -> Self {
        Self::NoReply {
            request: name,
            unknown: unknown(request, check),
        }
    }

    /// Creates the error of a request whose line was lost before its reply.
    pub(super) fn lost_reply(
        name: &'static str,
        request: &Request<'_>,
        check: &str,
        error: io::Error,
    ) -> Self {
        Self::LostReply {
            request: name,
            error,
            unknown: unknown(request, check),
        }
    }

    /// Returns true if the controller cannot be reached, or does not answer.
    pub(crate) const fn is_of_line(&self) -> bool {
        matches!(
            self,
            Self::NoReply { .. } | Self::LostReply { .. } | Self::Line(_) | Self::NoController(_)
        )
    }

    /// Adds the remedy to a refusal that depends on the state of the machine.
    pub(super) fn with_remedy(self, condition: Condition) -> Self {
        match self {
            Self::Refused { request, refusal } if matches!(*refusal, Refusal::State { .. }) => {
                Self::NotNow {
                    request,
                    refusal,
                    remedy: remedy(condition),
                }
            }
            other => other,
        }
    }
}

/// Returns when a request of this condition is possible, and how the machine gets there.
fn remedy(condition: Condition) -> String {
    match condition {
        Condition::Command(command) => report::remedy(command.states()),
        Condition::In(states) => report::remedy(states.iter().copied()),
        Condition::DrivesOff => {
            format!(
                "while the drives are off: {}",
                report::remedy([State::Idle])
            )
        }
    }
}

/// Returns the effect that a request without a reply may have had, and how to find out.
fn unknown(request: &Request<'_>, check: &str) -> String {
    let unknown = match request {
        Request::Identify { .. }
        | Request::Read { .. }
        | Request::Counters
        | Request::Events { .. }
        | Request::Inputs => return format!("nothing has changed; {check}"),
        Request::Stream { .. } | Request::StreamStatus { .. } => {
            "the controller may send messages or not; repeat the command"
        }
        Request::BeginWrite { .. } | Request::Write { .. } => {
            "the file is incomplete, so the former one remains; load it again"
        }
        Request::FinishWrite => {
            "the file may be stored; `cophase link identify` shows the CRC-32 of the program, and after `cophase link restart` that of the settings"
        }
        Request::Restart | Request::OnlyAxis(_) => {
            "the controller may have restarted; `cophase link identify` shows whether it answers, and which axes run"
        }
        Request::Control(_) => {
            "this host may have control; `cophase link monitor` shows who has it"
        }
        Request::Arm => {
            "the machine may be armed for 30 s; `cophase link monitor` shows whether it is"
        }
        Request::Disarm => {
            "the machine may still be armed for 30 s; `cophase link monitor` shows whether it is"
        }
        Request::Start | Request::Home | Request::Jog => {
            "the machine may be running; `cophase link monitor` shows its state, `cophase link stop` or its STOP ends the motion"
        }
        Request::Stop(_) => {
            "the machine may still be running; press its STOP, and `cophase link monitor` shows its state"
        }
        Request::Hold | Request::Resume => {
            "the program may be on hold or not; `cophase link monitor` shows it"
        }
        Request::Reset => {
            "the fault may have ended; `cophase link monitor` shows the machine's state"
        }
        Request::Override { .. } => {
            "the override may have changed; `cophase link monitor` shows it"
        }
        Request::ResetPeak => "the largest phase errors may have been reset; repeat the command",
        Request::Unlock => {
            "bring-up may be unlocked for 10 minutes; `cophase link restart` ends it"
        }
        Request::Output { .. } => {
            "the output may be active for 1 s; keep clear of the machine until then"
        }
    };
    unknown.to_owned()
}
