//! The supervisor: which state the machine is in, and what that means for shaft and drives.
//!
//! ```text
//!            start             all indices seen          program done, stop
//!   idle ───────────► align ───────────────────► run ───────────────────────► stop ──► parked
//!    ▲                  │                         │ ▲                           │        │ │
//!    │                  │ stop, fault             │ └───────────── start ───────┼────────┘ │
//!    │                  └──────────► stop ◄───────┘ fault                       ▼          │
//!    ├───────────────────────── reset ◄──────────────────────────────────── fault ◄── any ─┤
//!    │                                                        enable lost while moving,    │
//!    │                                                        fault that disables          │
//!    └──────────────────────────────────────── enable taken away ◄─────────────────────────┘
//! ```
//!
//! Every stop is coordinated: the shaft stops, and with it all axes, in phase. There are two exceptions: where the
//! enable input is taken away while anything moves, and where the table of reactions says so, the drives are off the
//! same tick. A parked machine whose enable is taken away is idle, as nothing is wrong with it.
//!
//! A fault *latches*: the first is kept, with what was seen, until a reset. What is learnt about it later may give it a
//! better name, never another time. The drives are on in align, run, stop and parked, and in no other state.

mod fault;
pub mod reaction;

pub use fault::{FAULT_BYTES, Fault, FaultKind};
pub use reaction::{Reaction, reaction};

use crate::units::Phase;

/// What the machine is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// Drives off, waiting for a start.
    #[default]
    Idle,
    /// Drives on, turning slowly until every index has been seen.
    Align,
    /// Following the program.
    Run,
    /// Coming to rest, all axes together.
    Stop,
    /// At rest, drives on.
    Parked,
    /// At rest, drives off, until a reset.
    Fault,
}

impl State {
    /// All of them; each at the place that it has as a number.
    pub const ALL: [Self; 6] = [
        Self::Idle,
        Self::Align,
        Self::Run,
        Self::Stop,
        Self::Parked,
        Self::Fault,
    ];

    /// The state's name, in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Align => "align",
            Self::Run => "run",
            Self::Stop => "stop",
            Self::Parked => "parked",
            Self::Fault => "fault",
        }
    }
}

/// The digital inputs that decide whether the machine may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SafetyInputs {
    /// The drives may be on. A broken wire reads false.
    pub enable: bool,
    /// The machine shall stop. A broken wire reads true.
    pub stop: bool,
}

/// What an operator, or a host, may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Run the program: from idle, align first; when parked, go on (or from the start, if it was over).
    Start,
    /// Stop at the parking phase.
    Stop,
    /// Let the program's time stand still; the shaft keeps its speed.
    Hold,
    /// Let it go on.
    Resume,
    /// Leave the fault state.
    Reset,
    /// Forget the largest drifts so far.
    ResetPeak,
}

/// What the rest of the loop reports, of the tick that is over.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Something is wrong that the machine must not go on with.
    pub fault: Option<Fault>,
    /// What is to be done about it: to stop, or to disable. What is milder is told, and no fault.
    pub reaction: Reaction,
    /// The fault is the one that latched, better named.
    pub refines: bool,
    /// The shaft stands where it was to stop.
    pub at_rest: bool,
    /// Align is over: every index has been heard, and the cranks are together as far as that is asked for.
    pub aligned: bool,
    /// The program is over.
    pub program_done: bool,
    /// Control ticks since power-up.
    pub tick: u64,
    /// The master's phase.
    pub phase: Phase,
}

impl Default for Seen {
    /// Nothing; and were it a fault, it would stop the machine.
    fn default() -> Self {
        Self {
            fault: None,
            reaction: Reaction::Stop,
            refines: false,
            at_rest: false,
            aligned: false,
            program_done: false,
            tick: 0,
            phase: Phase::ZERO,
        }
    }
}

/// What the shaft is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Stand; the drives are off or have just been switched on.
    Stand,
    /// Turn slowly.
    Creep,
    /// Follow the program.
    Play,
    /// Keep the speed, the program's time standing still.
    Hold,
    /// Stop at the parking phase.
    Park,
    /// Stop as fast as the limits allow.
    StopFast,
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Supervisor {
    state: State,
    fault: Option<Fault>,
    holding: bool,
    /// Ticks for which drives that were just switched on are given time.
    settle_ticks: u32,
    settling: u32,
}

impl Supervisor {
    /// Idle. `settle_ticks` is how long drives need from being switched on.
    pub const fn new(settle_ticks: u32) -> Self {
        Self {
            state: State::Idle,
            fault: None,
            holding: false,
            settle_ticks,
            settling: 0,
        }
    }

    /// What the machine is doing.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The fault that latched.
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Whether one has.
    pub const fn has_fault(&self) -> bool {
        self.fault.is_some()
    }

    /// Whether the drives are to be on.
    pub const fn drives_enabled(&self) -> bool {
        matches!(
            self.state,
            State::Align | State::Run | State::Stop | State::Parked
        )
    }

    /// Goes to the fault state, whatever the state was: for what is known before the first tick.
    pub const fn begin_with(&mut self, fault: Fault) {
        self.state = State::Fault;
        self.fault = Some(fault);
    }

    /// Decides on one tick.
    pub fn step(&mut self, inputs: SafetyInputs, command: Option<Command>, seen: &Seen) -> Action {
        self.latch(seen);
        self.state = self.next_state(inputs, command, seen);
        self.action()
    }

    /// Keeps the first fault; what follows from it is not what began it, unless it is a better name for that.
    fn latch(&mut self, seen: &Seen) {
        let Some(fault) = seen.fault else {
            return;
        };
        let on = self.drives_enabled();
        match &mut self.fault {
            Some(first) if seen.refines => {
                *first = Fault {
                    tick: first.tick,
                    phase: first.phase,
                    ..fault
                };
            }
            None if on => self.fault = Some(fault.at(seen.tick, seen.phase)),
            _ => {}
        }
    }

    fn next_state(&mut self, inputs: SafetyInputs, command: Option<Command>, seen: &Seen) -> State {
        let stop = inputs.stop || command == Some(Command::Stop);
        let moving = matches!(self.state, State::Align | State::Run | State::Stop);
        if moving && !inputs.enable {
            let lost = Fault::new(FaultKind::EnableLost).at(seen.tick, seen.phase);
            self.fault.get_or_insert(lost);
            return State::Fault;
        }
        // Whichever fault is the first, a later one may be what must not go on for another tick.
        let disable = seen.fault.is_some() && seen.reaction == Reaction::Disable;
        if disable && self.drives_enabled() {
            return State::Fault;
        }
        match self.state {
            State::Idle if command == Some(Command::Start) && inputs.enable && !inputs.stop => {
                self.settling = self.settle_ticks;
                self.holding = false;
                State::Align
            }
            State::Idle => State::Idle,
            State::Align | State::Run if self.fault.is_some() || stop => State::Stop,
            State::Align if self.settling > 0 => {
                self.settling -= 1;
                State::Align
            }
            State::Align if seen.aligned => State::Run,
            State::Align => State::Align,
            State::Run if seen.program_done => State::Stop,
            State::Run => {
                match command {
                    Some(Command::Hold) => self.holding = true,
                    Some(Command::Resume) => self.holding = false,
                    _ => {}
                }
                State::Run
            }
            State::Stop if !seen.at_rest => State::Stop,
            State::Stop if self.fault.is_some() => State::Fault,
            State::Stop => State::Parked,
            State::Parked if self.fault.is_some() => State::Fault,
            State::Parked if !inputs.enable => State::Idle,
            State::Parked if !inputs.stop && command == Some(Command::Start) => {
                self.holding = false;
                // It may have been stopped before it was aligned.
                if seen.aligned {
                    State::Run
                } else {
                    State::Align
                }
            }
            State::Parked => State::Parked,
            State::Fault if command == Some(Command::Reset) => {
                self.fault = None;
                State::Idle
            }
            State::Fault => State::Fault,
        }
    }

    fn action(&self) -> Action {
        match self.state {
            State::Idle | State::Fault => Action::Stand,
            State::Align if self.settling > 0 => Action::Stand,
            State::Align => Action::Creep,
            State::Run if self.holding => Action::Hold,
            State::Run => Action::Play,
            State::Stop | State::Parked if self.fault.is_some() => Action::StopFast,
            State::Stop | State::Parked => Action::Park,
        }
    }
}

#[cfg(test)]
mod model;
#[cfg(test)]
mod tests;
