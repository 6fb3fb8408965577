//! What is required of every tick of the supervisor, by one who sees only what goes in and comes out.

use super::*;

/// What an onlooker holds against the machine after a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Owed {
    Nothing,
    /// A fault was detected: an operator must reset.
    Reset,
    /// … has reset: and must start.
    Start,
}

impl Owed {
    /// What is owed after a tick that began with the drives on, or off, and the machine in motion, or not.
    fn after(self, drives: bool, moving: bool, input: &Input) -> Self {
        let faulted =
            (drives && input.observed.fault.is_some()) || (moving && !input.inputs.enable);
        match (self, input.command) {
            _ if faulted => Self::Reset,
            (Self::Reset, Some(Command::Reset)) if !drives => Self::Start,
            (Self::Start, Some(Command::Start)) => Self::Nothing,
            (owed, _) => owed,
        }
    }
}

const fn moving(state: State) -> bool {
    matches!(state, State::Homing | State::Run | State::Stop)
}

/// Everything that is required of one tick. `owed` is what was owed before it.
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
    let say = |what: &str| std::format!("{what}: {from:?} to {to:?}, {action:?}, by {input:?}");

    // Drives. What is detected while they are off is not held against a machine that may be turned by hand: a fault that is
    // one still is detected in the next tick.
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
    let started = input.command == Some(Command::Start) && !input.inputs.stop;
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
        say("runs unaligned")
    );
    assert!(
        !ran_on || !input.observed.program_done,
        "{}",
        say("runs past the program's end")
    );
    assert!(
        to != State::Run || ran_on || action == Action::Play,
        "{}",
        say("a hold that nobody asked for")
    );
    assert!(
        (action == Action::Home) == (to == State::Homing && after.settling == 0),
        "{}",
        say("creeps")
    );
    owes
}
