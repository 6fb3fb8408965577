//! Demands on every tick of the supervisor, stated only on its inputs and outputs.

use super::key;
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
    /// A fault occurred: an operator must reset. Until then the drives may hold at rest, if no fault forbids it.
    Reset {
        may_hold: bool,
    },
    /// The operator has reset, and must start.
    Start,
}

impl Owed {
    /// Action needed after a tick of a supervisor in the state before it.
    fn after(self, before: &Supervisor, input: &Input) -> Self {
        let drives = before.drives_enabled();
        let fault = input.observed.fault.filter(|_| drives);
        let is_reset = input.command == Some(Command::Reset) && before.state == State::Fault;
        let may_hold = match self {
            Self::Reset { may_hold } => may_hold,
            Self::Nothing | Self::Start => !before.has_brake,
        };
        // A loss of the enable input is a fault of a machine that moves. A machine that holds must switch its drives off, too.
        let lost = drives && !input.inputs.enable;
        let is_hard = fault.is_some() && input.observed.reaction >= Reaction::StopAndCut;
        let has_fault = fault.is_some() || lost && moving(before.state);
        match (self, input.command) {
            (Self::Reset { .. }, _) if is_reset && fault.is_none() => Self::Start,
            (Self::Reset { .. }, _) => Self::Reset {
                may_hold: may_hold && !lost && !is_hard,
            },
            _ if has_fault => Self::Reset {
                may_hold: may_hold && !lost && !is_hard,
            },
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
    let owes = owed.after(before, input);
    let drives = after.drives_enabled();
    let jogs = to == State::Run && after.jogging > 0;
    let say = |what: &str| std::format!("{what}: {from:?} to {to:?}, {action:?}, by {input:?}");

    // Drives. Faults while they are off do not count, as the machine may be turned by hand. A fault that persists is
    // detected in the next tick.
    let may_hold = owes == Owed::Reset { may_hold: true };
    let expected = match to {
        State::Idle => false,
        State::Homing | State::Run | State::Stop | State::Parked => true,
        State::Fault => may_hold,
    };
    assert!(drives == expected, "{}", say("drives"));
    let has_stopped = match from {
        State::Stop => input.observed.at_rest,
        State::Parked => true,
        State::Fault => before.drives_enabled(),
        _ => false,
    };
    assert!(
        to != State::Fault || !drives || has_stopped,
        "{}",
        say("held without a coordinated stop")
    );
    let is_reset = from == State::Fault && to != State::Fault;
    assert!(
        !is_reset || (to == State::Idle && !drives && input.command == Some(Command::Reset)),
        "{}",
        say("left a fault otherwise than by a reset that switches the drives off")
    );
    assert!(
        input.inputs.enable || !drives,
        "{}",
        say("drives without enable")
    );
    assert!(
        (drives && to != State::Fault) || action == Action::Stand,
        "{}",
        say("driven, and off or held")
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
        matches!(owes, Owed::Reset { .. }),
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

/// Checks that a command is either obeyed or refused, against the same tick without the command. A command is obeyed if it makes a
/// difference, now or by a mode that it sets; and one that is refused makes none.
pub(super) fn demand_an_answer(
    before: &Supervisor,
    input: &Input,
    after: &Supervisor,
    action: Action,
) {
    let Some(command) = input.command else {
        assert_eq!(after.refused(), None, "nothing to refuse: {input:?}");
        return;
    };
    let mut without = before.clone();
    let untouched = without.step(input.inputs, None, &input.observed);
    let state = |supervisor| key(supervisor, Owed::Nothing);
    let makes_a_difference = state(after) != state(&without) || action != untouched;
    let say = |what: &str| std::format!("{what}: {command:?} in {before:?}, by {input:?}");
    if let Some(refused) = after.refused() {
        assert!(!makes_a_difference, "{}", say("refused, and obeyed"));
        assert_eq!((refused.command, refused.state), (command, before.state));
        return;
    }
    let is_obeyed_already = match command {
        // These change nothing in the supervisor itself.
        Command::ResetPeak | Command::Override(_) => true,
        // Nothing turns, or it is stopping already.
        Command::Stop | Command::StopNow => !matches!(after.state, State::Homing | State::Run),
        Command::Hold => before.holding,
        Command::Resume => !before.holding,
        // The jog has its whole time left.
        Command::Jog => after.jogging == after.jog_ticks,
        Command::Start | Command::Home | Command::Reset => false,
    };
    assert!(
        makes_a_difference || is_obeyed_already,
        "{}",
        say("dropped without a word")
    );
}
