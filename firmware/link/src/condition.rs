//! Conditions of requests: the situations of the machine in which each request is possible.

use cophase_core::supervisor::{Command, RefusalReason, Situation, State};

use crate::message::{File, Refusal, Request, StopKind};

/// Condition of the machine for a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// The supervisor would obey this command ([`Command::check`]).
    Command(Command),
    /// The machine is in one of these states.
    In(&'static [State]),
    /// The drives are off.
    DrivesOff,
}

impl Condition {
    const ANY: Self = Self::In(&State::ALL);

    /// Checks a machine in a situation, with its drives on or off.
    ///
    /// # Errors
    /// The reason why the machine does not meet the condition.
    #[expect(
        clippy::result_large_err,
        reason = "a refusal holds its text, as there is no heap"
    )]
    pub fn check(self, situation: &Situation, drives_are_on: bool) -> Result<(), Refusal> {
        let state = situation.state;
        let is_met = match self {
            Self::Command(command) => {
                return command
                    .check(situation)
                    .map_err(|reason| refusal(reason, state));
            }
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

const fn refusal(reason: RefusalReason, state: State) -> Refusal {
    match reason {
        RefusalReason::State | RefusalReason::Ends => Refusal::State { state: state as u8 },
        RefusalReason::EnableOpen => Refusal::EnableOpen,
        RefusalReason::StopActive => Refusal::StopActive,
        RefusalReason::NotHomed => Refusal::NotHomed,
        RefusalReason::ProgramRuns => Refusal::ProgramRuns,
        RefusalReason::Jogs => Refusal::Jogs,
    }
}

impl Request<'_> {
    /// Command that the request gives to the loop.
    pub const fn command(&self) -> Option<Command> {
        Some(match self {
            Self::Start => Command::Start,
            Self::Home => Command::Home,
            Self::Jog => Command::Jog,
            Self::Stop(StopKind::AtPhase) => Command::Stop,
            Self::Stop(StopKind::Now) => Command::StopNow,
            Self::Hold => Command::Hold,
            Self::Resume => Command::Resume,
            Self::Reset => Command::Reset,
            Self::ResetPeak => Command::ResetPeak,
            Self::Override { permille } => Command::Override(*permille),
            _ => return None,
        })
    }

    /// Condition of the machine for this request. The end of a file has that of the file ([`File::condition`]).
    pub const fn condition(&self) -> Condition {
        if let Some(command) = self.command() {
            return Condition::Command(command);
        }
        match self {
            // Every motion begins where a start is possible.
            Self::Arm => Condition::Command(Command::Start),
            Self::Output { .. } => Condition::In(&[State::Idle]),
            Self::Restart | Self::Unlock | Self::OnlyAxis(_) => Condition::DrivesOff,
            _ => Condition::ANY,
        }
    }
}

impl File {
    /// Condition of the machine for the end of a file that is written, at which it takes effect or is stored.
    pub const fn condition(self) -> Condition {
        match self {
            Self::Program => Condition::In(&[State::Idle, State::Parked]),
            Self::Settings => Condition::DrivesOff,
        }
    }
}
