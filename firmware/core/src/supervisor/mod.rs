//! Supervisor: the state of the machine, and its meaning for shaft and drives.
//!
//! ```text
//!            start             all indices found         program done, stop
//!   idle ───────────► homing ──────────────────► run ───────────────────────► stop ──► parked
//!    ▲                  │                         │ ▲                           │        │ │
//!    │                  │ stop, fault             │ └───────────── start ───────┼────────┘ │
//!    │                  └──────────► stop ◄───────┘ fault                       ▼          │
//!    ├───────────────────────── reset ◄──────────────────────────────────── fault ◄── any ─┤
//!    │                                                        enable lost while moving,    │
//!    │                                                        fault that disables          │
//!    └──────────────────────────────────────── enable opened ◄─────────────────────────────┘
//! ```
//!
//! Every stop is coordinated: the shaft stops, and with it all axes, in phase (stop category 1 or 2). There are two
//! exceptions, in which the drives are off in the same tick (stop category 0). The enable input opens while anything
//! moves, or the table of reactions requires it. A parked machine whose enable input opens is idle, as this is no fault.
//!
//! A fault *latches*: the first is kept, with its data, until a reset. A later diagnosis may give it a better name, but does not change its
//! time. The drives are on in homing, run, stop and parked. In the fault state they are on, too, while the machine *holds*: after a
//! coordinated stop whose faults all hold, until a reset, a loss of the enable input, or a fault that cuts or disables. A reaction becomes
//! harder with later faults, and never milder.
//!
//! A command is obeyed, or refused with a reason that is reported: [`Command::check`] has the table.

mod fault;
mod kind;
mod reaction;
mod request;

pub use fault::{FAULT_BYTES, Fault};
pub use kind::{FaultKind, KINDS, Row};
pub use reaction::Reaction;
pub use request::{REFUSED_COMMAND_BYTES, RefusalReason, RefusedCommand, Situation};

use core::hash::Hash;

use crate::units::Phase;

/// State of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// Drives off, waiting for a start.
    #[default]
    Idle,
    /// Drives on, turning at homing speed until every index has been found.
    Homing,
    /// Following the program.
    Run,
    /// Stopping, all axes together.
    Stop,
    /// At rest, drives on.
    Parked,
    /// At rest until a reset. The drives hold, or are off: [`Supervisor::drives_enabled`].
    Fault,
}

impl State {
    /// All states, each at the index of its number.
    pub const ALL: [Self; 6] = [
        Self::Idle,
        Self::Homing,
        Self::Run,
        Self::Stop,
        Self::Parked,
        Self::Fault,
    ];

    /// Name of the state, in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Homing => "homing",
            Self::Run => "run",
            Self::Stop => "stop",
            Self::Parked => "parked",
            Self::Fault => "fault",
        }
    }
}

/// Digital inputs that permit the machine to move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SafetyInputs {
    /// True if the drives may be on. A broken wire reads false.
    pub enable: bool,
    /// True if the machine must stop. A broken wire reads true.
    pub stop: bool,
}

/// Command of an operator or a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Run the program. From idle the machine homes first. When parked it continues, or starts again if it was over.
    Start,
    /// Home an idle machine, and park.
    Home,
    /// Turn a parked machine at homing speed, for [`JOG_S`]. A repetition restarts this time.
    Jog,
    /// Stop at the parking phase.
    Stop,
    /// Stop as fast as the limits allow, at any phase.
    StopNow,
    /// Stop the program's time; the shaft keeps its speed.
    Hold,
    /// Resume the program's time.
    Resume,
    /// Leave the fault state.
    Reset,
    /// Reset the largest phase errors.
    ResetPeak,
    /// Scale the program's amplitude, in thousandths.
    Override(u16),
}

/// Time for which one [`Command::Jog`] turns the machine, seconds. An operator who jogs repeats the command, so the machine stops if the
/// operator is gone.
pub const JOG_S: f64 = 0.5;

/// Input of the supervisor from the rest of the loop, for the tick that is over.
#[derive(Clone, Copy, Debug)]
pub struct SupervisorInput {
    /// Fault with which the machine must not continue.
    pub fault: Option<Fault>,
    /// Reaction to the fault: one that stops. An event with a milder reaction is reported and is no fault.
    pub reaction: Reaction,
    /// True if the fault is the latched one under a better name.
    pub supersedes: bool,
    /// True if the shaft is at rest, at the end of its stop.
    pub at_rest: bool,
    /// True if homing is over: every index has been detected, and the cranks are levelled as far as the settings require.
    pub homed: bool,
    /// True if the program is over.
    pub program_done: bool,
    /// Control ticks since power-up.
    pub tick: u64,
    /// Phase of the master.
    pub phase: Phase,
}

impl Default for SupervisorInput {
    /// Input without a fault; the reaction to one would be to stop and hold.
    fn default() -> Self {
        Self {
            fault: None,
            reaction: Reaction::StopAndHold,
            supersedes: false,
            at_rest: false,
            homed: false,
            program_done: false,
            tick: 0,
            phase: Phase::ZERO,
        }
    }
}

/// Action of the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Stand still; the drives are off, have just been switched on, or hold after a fault.
    Stand,
    /// Turn at homing speed.
    Home,
    /// Follow the program.
    Play,
    /// Keep the speed while the program's time stands still.
    Hold,
    /// Stop at the parking phase.
    Park,
    /// Stop as fast as the limits allow.
    StopFast,
}

/// State machine of the supervisor.
#[derive(Clone, Debug)]
pub struct Supervisor {
    state: State,
    fault: Option<Fault>,
    /// True if the fault state has the drives off. Always true with a brake. Otherwise false, until a fault or a loss of the enable input
    /// does not let them hold.
    cuts: bool,
    /// True if a brake holds the cranks while the drives are off, so that every fault cuts.
    has_brake: bool,
    holding: bool,
    /// True if the present or last stop is as fast as the limits allow, and does not wait for the parking phase.
    stops_now: bool,
    /// True if homing ends parked.
    only_homes: bool,
    /// Remaining ticks of a jog; zero while the machine plays the program.
    jogging: u32,
    jog_ticks: u32,
    /// Ticks for which the drives settle after they were switched on.
    settle_ticks: u32,
    settling: u32,
    /// Command of the last tick, if it was not possible.
    refused: Option<RefusedCommand>,
}

impl Supervisor {
    /// Constants, which no tick changes.
    pub(crate) fn constants(&self) -> impl Hash + use<> {
        let Self {
            state: _,
            fault: _,
            cuts: _,
            has_brake,
            holding: _,
            stops_now: _,
            only_homes: _,
            jogging: _,
            jog_ticks,
            settle_ticks,
            settling: _,
            refused: _,
        } = *self;
        (has_brake, jog_ticks, settle_ticks)
    }

    /// Supervisor in the idle state. The drives need `settle_ticks` after they are switched on, and one jog lasts
    /// `jog_ticks`. With a brake, every fault switches the drives off once the machine is at rest.
    pub const fn new(settle_ticks: u32, jog_ticks: u32, has_brake: bool) -> Self {
        Self {
            state: State::Idle,
            fault: None,
            cuts: has_brake,
            has_brake,
            holding: false,
            stops_now: false,
            only_homes: false,
            jogging: 0,
            jog_ticks,
            settle_ticks,
            settling: 0,
            refused: None,
        }
    }

    /// State of the machine.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Latched fault.
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// True if a fault has latched.
    pub const fn has_fault(&self) -> bool {
        self.fault.is_some()
    }

    /// True if the drives must be on.
    pub const fn drives_enabled(&self) -> bool {
        match self.state {
            State::Idle => false,
            State::Homing | State::Run | State::Stop | State::Parked => true,
            State::Fault => !self.cuts,
        }
    }

    /// True if the drives are on and no fault has stopped the machine.
    pub const fn operates(&self) -> bool {
        self.drives_enabled() && !matches!(self.state, State::Fault)
    }

    /// True if the drives hold cranks at rest: parked, or after a fault.
    pub const fn holds(&self) -> bool {
        matches!(self.state, State::Parked | State::Fault) && self.drives_enabled()
    }

    /// True if the fault state has the drives off, whether it has been reached or not.
    pub const fn cuts(&self) -> bool {
        self.cuts
    }

    /// Goes to the fault state from any state with the drives off, for faults that are known before anything moves.
    pub const fn begin_with(&mut self, fault: Fault) {
        self.state = self.cut();
        self.fault = Some(fault);
    }

    /// Fault state with the drives off.
    const fn cut(&mut self) -> State {
        self.cuts = true;
        State::Fault
    }

    /// Updates the state for one tick, and returns the action of the shaft. The answer to the command is [`Self::refused`].
    pub fn step(
        &mut self,
        inputs: SafetyInputs,
        command: Option<Command>,
        input: &SupervisorInput,
    ) -> Action {
        let is_faulted = input.fault.is_some() && self.drives_enabled();
        if let Some(fault) = &input.fault {
            self.latch(fault, input);
        }
        // In most ticks there is no command, neither now nor in the tick before.
        let mut command = command;
        if command.is_some() || self.refused.is_some() {
            self.refused = self.refuse(command, inputs, input, is_faulted);
            command = command.filter(|_| self.refused.is_none());
        }
        self.state = self.next_state(inputs, command, input, is_faulted);
        self.action()
    }

    /// Command of the last tick, if it was not possible.
    pub const fn refused(&self) -> Option<RefusedCommand> {
        self.refused
    }

    /// True while a jog turns the machine.
    pub const fn jogs(&self) -> bool {
        self.jogging > 0 && matches!(self.state, State::Run)
    }

    /// Refuses a command that is not possible.
    #[inline(never)] // seldom
    fn refuse(
        &self,
        command: Option<Command>,
        inputs: SafetyInputs,
        input: &SupervisorInput,
        is_faulted: bool,
    ) -> Option<RefusedCommand> {
        let command = command?;
        let state = self.state;
        let ends = match state {
            // A reset in the same tick as a new fault was meant for the fault before.
            State::Fault => is_faulted,
            State::Run if !self.jogs() && input.program_done => true,
            _ => self.fault.is_some(),
        };
        let situation = Situation {
            state,
            inputs,
            jogs: self.jogs(),
            homed: input.homed,
            ends,
        };
        command
            .check(&situation)
            .err()
            .map(|reason| RefusedCommand {
                command,
                state,
                reason,
            })
    }

    /// Keeps the first fault, as later ones may be its consequences. Only a better name replaces it. Each may make the
    /// reaction harder.
    #[inline(never)]
    fn latch(&mut self, fault: &Fault, input: &SupervisorInput) {
        let on = self.drives_enabled();
        self.cuts |= on && input.reaction.cuts();
        match &mut self.fault {
            Some(first) if input.supersedes => {
                *first = Fault {
                    tick: first.tick,
                    phase: first.phase,
                    ..*fault
                };
            }
            None if on => self.fault = Some(fault.at(input.tick, input.phase)),
            _ => {}
        }
    }

    #[inline(never)]
    fn lose_enable(&mut self, input: &SupervisorInput) -> State {
        let lost = Fault::new(FaultKind::EnableLost).at(input.tick, input.phase);
        self.fault.get_or_insert(lost);
        self.cut()
    }

    /// Returns the next state. A command is one that is possible.
    fn next_state(
        &mut self,
        inputs: SafetyInputs,
        command: Option<Command>,
        input: &SupervisorInput,
        is_faulted: bool,
    ) -> State {
        self.stops_now |= command == Some(Command::StopNow);
        let stop = inputs.stop || matches!(command, Some(Command::Stop | Command::StopNow));
        let moving = matches!(self.state, State::Homing | State::Run | State::Stop);
        if moving && !inputs.enable {
            return self.lose_enable(input);
        }
        // A later fault may require the drives to be off in this tick, whichever fault was the first.
        if is_faulted && input.reaction == Reaction::Disable {
            return self.cut();
        }
        match self.state {
            State::Idle if matches!(command, Some(Command::Start | Command::Home)) => {
                self.settling = self.settle_ticks;
                self.begin();
                self.only_homes = command == Some(Command::Home);
                State::Homing
            }
            State::Idle => State::Idle,
            State::Homing | State::Run if self.fault.is_some() || stop => State::Stop,
            State::Homing if self.settling > 0 => {
                self.settling -= 1;
                State::Homing
            }
            State::Homing if input.homed && self.only_homes => State::Stop,
            State::Homing if input.homed => State::Run,
            State::Homing => State::Homing,
            State::Run if self.jogging > 0 => self.jog_on(command),
            State::Run if input.program_done => State::Stop,
            State::Run => {
                match command {
                    Some(Command::Hold) => self.holding = true,
                    Some(Command::Resume) => self.holding = false,
                    _ => {}
                }
                State::Run
            }
            State::Stop if !input.at_rest => State::Stop,
            State::Stop if self.fault.is_some() => State::Fault,
            State::Stop => State::Parked,
            State::Parked if self.fault.is_some() && !inputs.enable => self.cut(),
            State::Parked if self.fault.is_some() => State::Fault,
            State::Parked if !inputs.enable => State::Idle,
            State::Parked if command == Some(Command::Jog) => {
                self.begin();
                self.jogging = self.jog_ticks;
                State::Run
            }
            State::Parked if command == Some(Command::Start) => {
                self.begin();
                // The machine may have been stopped before homing was over.
                if input.homed {
                    State::Run
                } else {
                    State::Homing
                }
            }
            State::Parked => State::Parked,
            State::Fault if command == Some(Command::Reset) => {
                self.fault = None;
                self.cuts = self.has_brake;
                State::Idle
            }
            State::Fault if !inputs.enable => self.cut(),
            State::Fault => State::Fault,
        }
    }

    /// Resets the modes of the last motion: hold, immediate stop, homing only, and jog.
    const fn begin(&mut self) {
        self.holding = false;
        self.stops_now = false;
        self.only_homes = false;
        self.jogging = 0;
    }

    const fn jog_on(&mut self, command: Option<Command>) -> State {
        self.jogging = match command {
            Some(Command::Jog) => self.jog_ticks,
            _ => self.jogging - 1,
        };
        if self.jogging == 0 {
            State::Stop
        } else {
            State::Run
        }
    }

    fn action(&self) -> Action {
        match self.state {
            State::Idle | State::Fault => Action::Stand,
            State::Homing if self.settling > 0 => Action::Stand,
            State::Homing => Action::Home,
            State::Run if self.jogging > 0 => Action::Home,
            State::Run if self.holding => Action::Hold,
            State::Run => Action::Play,
            State::Stop | State::Parked if self.fault.is_some() || self.stops_now => {
                Action::StopFast
            }
            State::Stop | State::Parked => Action::Park,
        }
    }
}

#[cfg(test)]
mod model;
#[cfg(test)]
mod tests;
