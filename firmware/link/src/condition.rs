//! Conditions of requests: the states of the machine in which each request is possible.

use cophase_core::supervisor::State;

use crate::message::{File, Refusal, Request};

/// Condition of the machine for a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// The machine is in one of these states.
    In(&'static [State]),
    /// The drives are off.
    DrivesOff,
}

impl Condition {
    const ANY: Self = Self::In(&State::ALL);
    const AT_REST: Self = Self::In(&[State::Idle, State::Parked]);

    /// Checks a machine in a state, with its drives on or off.
    ///
    /// # Errors
    /// [`Refusal::State`] if the machine does not meet the condition.
    #[expect(
        clippy::result_large_err,
        reason = "a refusal holds its text, as there is no heap"
    )]
    pub fn check(self, state: State, drives_are_on: bool) -> Result<(), Refusal> {
        let is_met = match self {
            Self::In(states) => states.contains(&state),
            Self::DrivesOff => !drives_are_on,
        };
        if is_met {
            Ok(())
        } else {
            Err(Refusal::State { state: state as u8 })
        }
    }
}

impl Request<'_> {
    /// Condition of the machine for this request. A jog that is repeated while the machine jogs has none, and the end of a file has that of
    /// the file ([`File::condition`]).
    pub const fn condition(&self) -> Condition {
        match self {
            Self::Arm | Self::Start => Condition::AT_REST,
            Self::Home | Self::Output { .. } => Condition::In(&[State::Idle]),
            Self::Jog => Condition::In(&[State::Parked]),
            Self::Hold | Self::Resume => Condition::In(&[State::Run]),
            Self::Reset => Condition::In(&[State::Fault]),
            Self::Restart | Self::Unlock | Self::OnlyAxis(_) => Condition::DrivesOff,
            Self::Identify { .. }
            | Self::Read { .. }
            | Self::BeginWrite { .. }
            | Self::Write { .. }
            | Self::FinishWrite
            | Self::Control(_)
            | Self::Disarm
            | Self::Stop(_)
            | Self::Override { .. }
            | Self::Counters
            | Self::Events { .. }
            | Self::Stream { .. }
            | Self::StreamStatus { .. }
            | Self::ResetPeak
            | Self::Inputs => Condition::ANY,
        }
    }
}

impl File {
    /// Condition of the machine for the end of a file that is written, at which it takes effect or is stored.
    pub const fn condition(self) -> Condition {
        match self {
            Self::Program => Condition::AT_REST,
            Self::Settings => Condition::DrivesOff,
        }
    }
}
