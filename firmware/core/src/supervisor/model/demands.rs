//! Demands on every tick of the supervisor, stated only on its inputs and outputs.

use crate::supervisor::{
    Action, Command, Reaction, SafetyInputs, State, Supervisor, SupervisorInput,
};

/// Input of one tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input {
    pub(super) inputs: SafetyInputs,
    pub(super) command: Option<Command>,
    pub(super) observed: SupervisorInput,
}

impl Input {
    fn disables(&self) -> bool {
        self.observed.fault.is_some() && self.observed.reaction == Reaction::Disable
    }

    fn stops(&self) -> bool {
        self.inputs.stop || matches!(self.command, Some(Command::Stop | Command::StopNow))
    }
}

/// Operator action that the machine needs after a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Owed {
    Nothing,
    /// A fault occurred: an operator must reset.
    Reset,
    /// The operator has reset, and must start.
    Start,
}

impl Owed {
    /// Action needed after a tick that began with the given states of drives and motion.
    fn after(self, drives: bool, moving: bool, input: &Input) -> Self {
        let faulted =
            (drives && input.observed.fault.is_some()) || (moving && !input.inputs.enable);
        match (self, input.command) {
            _ if faulted => Self::Reset,
            (Self::Reset, Some(Command::Reset)) if !drives => Self::Start,
            (Self::Start, Some(Command::Start | Command::Home)) => Self::Nothing,
            (owed, _) => owed,
        }
    }
}

const fn moving(state: State) -> bool {
    matches!(state, State::Homing | State::Run | State::Stop)
}

/// Checks all demands on one tick. `owed` is the action needed before it.
pub(super) fn check(
    before: &Supervisor,
    owed: Owed,
    input: &Input,
    after: &Supervisor,
    action: Action,
) -> Owed {
    let (from, to) = (before.state, after.state);
    let owes = owed.after(before.drives_enabled(), moving(from), input);
    let drives = after.drives_enabled();
    let jogs = to == State::Run && after.jogging > 0;
    let say = |what: &str| std::format!("{what}: {from:?} to {to:?}, {action:?}, by {input:?}");

    // Drives. Faults while they are off do not count, as the machine may be turned by hand. A fault that persists is
    // detected in the next tick.
    assert!(
        drives != matches!(to, State::Idle | State::Fault),
        "{}",
        say("drives")
    );
    assert!(
        input.inputs.enable || !drives,
        "{}",
        say("drives without enable")
    );
    assert!(
        drives || action == Action::Stand,
        "{}",
        say("driven, and off")
    );
    assert!(
        !(input.disables() && before.drives_enabled() && drives),
        "{}",
        say("not disabled")
    );
    let starts = matches!(input.command, Some(Command::Start | Command::Home));
    let started = starts && !input.inputs.stop;
    assert!(
        before.drives_enabled() || !drives || (from == State::Idle && started),
        "{}",
        say("drives that nobody started")
    );

    // Faults.
    if owes != Owed::Nothing {
        assert!(
            !matches!(to, State::Homing | State::Run | State::Parked),
            "{}",
            say("runs on after a fault")
        );
        assert!(
            matches!(action, Action::StopFast | Action::Stand),
            "{}",
            say("a fault's stop is the fastest")
        );
    }
    assert_eq!(
        after.fault.is_some(),
        owes == Owed::Reset,
        "{}",
        say("latched")
    );
    assert!(
        to != State::Fault || after.fault.is_some(),
        "{}",
        say("a fault without a name")
    );

    // Stops.
    let parked = matches!(action, Action::Park | Action::StopFast | Action::Stand);
    assert!(
        !input.stops() || parked,
        "{}",
        say("a stop that is not obeyed")
    );
    assert!(
        from == State::Stop || to != State::Stop || moving(from),
        "{}",
        say("a stop out of nothing")
    );
    assert!(
        from != State::Stop
            || !input.inputs.enable
            || input.disables()
            || input.observed.at_rest == (to != State::Stop),
        "{}",
        say("a stop is over at rest, and not before")
    );

    // Running.
    let ran_on = from == State::Run && to == State::Run;
    assert!(
        to != State::Run || ran_on || input.observed.homed,
        "{}",
        say("runs without homing")
    );
    assert!(
        !ran_on || before.jogging > 0 || !input.observed.program_done,
        "{}",
        say("runs beyond the program's end")
    );
    assert!(
        to != State::Run || ran_on || action == if jogs { Action::Home } else { Action::Play },
        "{}",
        say("a hold without a command")
    );
    assert!(
        (action == Action::Home) == (jogs || to == State::Homing && after.settling == 0),
        "{}",
        say("homing speed exactly in homing and jogs")
    );
    let may_begin = from == State::Parked && input.command == Some(Command::Jog);
    assert!(
        !jogs || may_begin || (ran_on && before.jogging > 0),
        "{}",
        say("a jog without a command")
    );
    assert!(
        from != State::Homing || to != State::Run || !before.only_homes,
        "{}",
        say("runs after a command to home")
    );
    let is_stopping = matches!(to, State::Stop);
    assert!(
        input.command != Some(Command::StopNow) || !is_stopping || action == Action::StopFast,
        "{}",
        say("an immediate stop that waits for the phase")
    );
    owes
}
