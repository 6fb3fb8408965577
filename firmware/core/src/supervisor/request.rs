//! Requests: the situations in which each command is possible, and the answer to one that is not.
//!
//! This table is the only one. The supervisor consults it in the tick in which a command comes, and the link's server with the latest
//! sample of that same loop. So the two cannot disagree, but for the time between the sample and the tick. A command that is not possible
//! has no effect, and is reported as a [`RefusedCommand`], wherever it came from.

use core::fmt;

use super::{Command, SafetyInputs, State};

/// The part of the machine's state that decides which commands are possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Situation {
    /// State of the machine.
    pub state: State,
    /// Enable and stop inputs.
    pub inputs: SafetyInputs,
    /// True while a jog turns the machine, false while it plays the program.
    pub jogs: bool,
    /// True if homing is over.
    pub homed: bool,
    /// True if a fault or the end of the program takes the machine out of its state in this tick.
    pub ends: bool,
}

impl Situation {
    /// A homed machine in a state that lasts, with the enable input closed and the stop input inactive.
    pub const fn permitting(state: State) -> Self {
        Self {
            state,
            inputs: SafetyInputs {
                enable: true,
                stop: false,
            },
            jogs: false,
            homed: true,
            ends: false,
        }
    }
}

impl Command {
    /// Checks that the command is possible.
    ///
    /// # Errors
    /// The reason why it is not.
    pub const fn check(self, situation: &Situation) -> Result<(), RefusalReason> {
        let Situation {
            state,
            inputs,
            jogs,
            homed,
            ends,
        } = *situation;
        match (self, state) {
            // A machine that stands has stopped already.
            (Self::Stop | Self::StopNow | Self::ResetPeak | Self::Override(_), _) => return Ok(()),
            (Self::Jog, State::Run) if !jogs => return Err(RefusalReason::ProgramRuns),
            (Self::Jog, State::Parked) if !homed => return Err(RefusalReason::NotHomed),
            (Self::Hold | Self::Resume, State::Run) if jogs => return Err(RefusalReason::Jogs),
            (Self::Start, State::Idle | State::Parked)
            | (Self::Home, State::Idle)
            | (Self::Jog, State::Parked | State::Run)
            | (Self::Hold | Self::Resume, State::Run) => {
                if !inputs.enable {
                    return Err(RefusalReason::EnableOpen);
                }
                if inputs.stop {
                    return Err(RefusalReason::StopActive);
                }
            }
            (Self::Reset, State::Fault) => {}
            _ => return Err(RefusalReason::State),
        }
        if ends {
            return Err(RefusalReason::Ends);
        }
        Ok(())
    }

    /// States in which the command is possible. A jog that is repeated is possible while it runs, too.
    pub fn states(self) -> impl Iterator<Item = State> {
        let is_possible = move |state: &State| self.check(&Situation::permitting(*state)).is_ok();
        State::ALL.into_iter().filter(is_possible)
    }

    /// Name of the command, as in a scene's `[[command]]` and in `cophase link`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Home => "home",
            Self::Jog => "jog",
            Self::Stop => "stop",
            Self::StopNow => "stop-now",
            Self::Hold => "hold",
            Self::Resume => "resume",
            Self::Reset => "reset",
            Self::ResetPeak => "reset-peak",
            Self::Override(_) => "override",
        }
    }

    /// Commands that can be refused, each at the index of its number.
    pub const REFUSABLE: [Self; 6] = [
        Self::Start,
        Self::Home,
        Self::Jog,
        Self::Hold,
        Self::Resume,
        Self::Reset,
    ];
}

/// Reason why a command is not possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum RefusalReason {
    /// The command belongs to another state.
    State = 0,
    /// The enable input is open.
    EnableOpen = 1,
    /// The stop input is active.
    StopActive = 2,
    /// Homing was interrupted.
    NotHomed = 3,
    /// A program runs.
    ProgramRuns = 4,
    /// A jog runs.
    Jogs = 5,
    /// A fault or the end of the program came in the same tick.
    Ends = 6,
}

impl RefusalReason {
    /// All reasons, each at the index of its number.
    pub const ALL: [Self; 7] = [
        Self::State,
        Self::EnableOpen,
        Self::StopActive,
        Self::NotHomed,
        Self::ProgramRuns,
        Self::Jogs,
        Self::Ends,
    ];

    /// The reason, and what to do about it.
    pub const fn text(self) -> &'static str {
        match self {
            Self::State => "the command belongs to another state",
            Self::EnableOpen => "the enable input is open; close it first",
            Self::StopActive => "the stop input is active; release it first",
            Self::NotHomed => {
                "homing was interrupted; `start` homes the machine again, or open and close the enable input, then `home`"
            }
            Self::ProgramRuns => "a program runs; `stop` it first",
            Self::Jogs => "the machine jogs and plays no program; `start` the program first",
            Self::Ends => "the machine left this state in the same tick; see the events beside it",
        }
    }
}

impl fmt::Display for RefusalReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

/// A command that was not possible, and had no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(4))] // It is copied by words, and so is all that may hold one.
pub struct RefusedCommand {
    /// The command.
    pub command: Command,
    /// State of the machine when it came.
    pub state: State,
    /// Reason of the refusal.
    pub reason: RefusalReason,
}

/// Length of an encoded refused command, bytes.
pub const REFUSED_COMMAND_BYTES: usize = 3;

impl RefusedCommand {
    /// Encodes it as the numbers of command, state and reason.
    pub fn to_bytes(&self) -> [u8; REFUSED_COMMAND_BYTES] {
        let mut commands = Command::REFUSABLE.iter();
        // A command that is never refused gets the number of none.
        let number = commands.position(|&command| command == self.command);
        let number = number.unwrap_or(Command::REFUSABLE.len());
        [number as u8, self.state as u8, self.reason as u8]
    }

    /// Decodes it; none if a number is unknown.
    pub fn from_bytes(bytes: &[u8; REFUSED_COMMAND_BYTES]) -> Option<Self> {
        let [command, state, reason] = bytes.map(usize::from);
        Some(Self {
            command: *Command::REFUSABLE.get(command)?,
            state: *State::ALL.get(state)?,
            reason: *RefusalReason::ALL.get(reason)?,
        })
    }
}

impl fmt::Display for RefusedCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            command,
            state,
            reason,
        } = self;
        let (command, state) = (command.name(), state.name());
        write!(f, "`{command}` was not possible in state {state}")?;
        match reason {
            RefusalReason::State => Ok(()),
            reason => write!(f, ": {reason}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a host shows another command, state or reason than the controller reported.
    #[test]
    fn a_refused_command_is_decoded_as_it_was_encoded() {
        for (number, reason) in RefusalReason::ALL.into_iter().enumerate() {
            assert_eq!(reason as usize, number);
            for command in Command::REFUSABLE {
                for state in State::ALL {
                    let refused = RefusedCommand {
                        command,
                        state,
                        reason,
                    };
                    let bytes = refused.to_bytes();
                    assert_eq!(RefusedCommand::from_bytes(&bytes), Some(refused));
                }
            }
        }
        assert_eq!(RefusedCommand::from_bytes(&[6, 0, 0]), None);
        assert_eq!(RefusedCommand::from_bytes(&[0, 6, 0]), None);
        assert_eq!(RefusedCommand::from_bytes(&[0, 0, 7]), None);
    }
}
