//! Remedy for a request that is not possible in the present state of the machine.

use cophase_core::supervisor::State;
use cophase_link::Condition;

/// Returns how a machine gets into a state; empty where no request leads there.
const fn begins(state: State) -> &'static str {
    match state {
        State::Idle => {
            "after `reset`, or when the enable input of a parked machine opens and closes"
        }
        State::Homing => "after `home` or `start`",
        State::Run => "after `start`, once homing is over",
        State::Stop => "after `stop`",
        State::Parked => "once `home` or `stop` is done",
        State::Fault => "",
    }
}

/// Returns when a request of this condition is possible, and how the machine gets there.
pub(super) fn remedy(condition: Condition) -> String {
    let (before, states) = match condition {
        Condition::In(states) => ("", states),
        Condition::DrivesOff => ("while the drives are off: ", &[State::Idle][..]),
    };
    let reached = |state: &State| match begins(*state) {
        "" => state.name().to_owned(),
        begins => format!("{} ({begins})", state.name()),
    };
    let states: Vec<_> = states.iter().map(reached).collect();
    format!("{before}in state {}", states.join(" or "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_core::supervisor::{
        Command, Fault, FaultKind, SafetyInputs, Supervisor, SupervisorInput,
    };
    use cophase_link::message::{File, Request};

    const CLOSED: SafetyInputs = SafetyInputs {
        enable: true,
        stop: false,
    };
    const OPEN: SafetyInputs = SafetyInputs {
        enable: false,
        stop: false,
    };

    fn at_rest() -> SupervisorInput {
        SupervisorInput {
            at_rest: true,
            homed: true,
            ..SupervisorInput::default()
        }
    }

    /// Supervisor of a machine in a state. After a fault, its drives hold.
    fn supervisor_in(state: State) -> Supervisor {
        let mut supervisor = Supervisor::new(0, 1, false);
        let start = (Some(Command::Start), at_rest());
        let wait = (None, at_rest());
        let stop = (Some(Command::Stop), at_rest());
        let fault = SupervisorInput {
            fault: Some(Fault::new(FaultKind::Tilt)),
            ..at_rest()
        };
        let steps = match state {
            State::Idle => vec![],
            State::Homing => vec![start],
            State::Run => vec![start, wait],
            State::Stop => vec![start, wait, stop],
            State::Parked => vec![start, wait, stop, wait],
            State::Fault => vec![start, wait, (None, fault), wait],
        };
        for (command, input) in steps {
            supervisor.step(CLOSED, command, &input);
        }
        assert_eq!(supervisor.state(), state);
        supervisor
    }

    #[test]
    fn a_remedy_names_the_states_and_what_leads_to_them() {
        let idle =
            "idle (after `reset`, or when the enable input of a parked machine opens and closes)";
        let parked = "parked (once `home` or `stop` is done)";
        for (condition, expected) in [
            (
                Request::Start.condition(),
                format!("in state {idle} or {parked}"),
            ),
            (Request::Jog.condition(), format!("in state {parked}")),
            (
                Request::Hold.condition(),
                "in state run (after `start`, once homing is over)".to_owned(),
            ),
            (Request::Reset.condition(), "in state fault".to_owned()),
            (
                File::Settings.condition(),
                format!("while the drives are off: in state {idle}"),
            ),
        ] {
            assert_eq!(remedy(condition), expected);
        }
    }

    /// If this fails, a remedy does not lead to the state of which it is said.
    #[test]
    fn states_are_reached_as_remedies_say() {
        let step = |from: State, inputs: SafetyInputs, command: Option<Command>| {
            let mut supervisor = supervisor_in(from);
            supervisor.step(inputs, command, &at_rest());
            supervisor.state()
        };
        assert_eq!(
            step(State::Fault, CLOSED, Some(Command::Reset)),
            State::Idle
        );
        assert_eq!(step(State::Parked, OPEN, None), State::Idle);
        for command in [Command::Home, Command::Start] {
            assert_eq!(step(State::Idle, CLOSED, Some(command)), State::Homing);
        }
        assert_eq!(step(State::Homing, CLOSED, None), State::Run);
        for from in [State::Homing, State::Run] {
            assert_eq!(step(from, CLOSED, Some(Command::Stop)), State::Stop);
        }
        assert_eq!(step(State::Stop, CLOSED, None), State::Parked);
    }

    /// If this fails, the link refuses a command that the supervisor would obey, or lets one pass that it ignores.
    #[test]
    fn the_supervisor_obeys_the_commands_that_the_link_lets_pass() {
        for (request, command) in [
            (Request::Start, Command::Start),
            (Request::Home, Command::Home),
            (Request::Jog, Command::Jog),
            (Request::Hold, Command::Hold),
            (Request::Reset, Command::Reset),
        ] {
            for state in State::ALL {
                let after = |command: Option<Command>| {
                    let mut supervisor = supervisor_in(state);
                    supervisor.step(CLOSED, command, &at_rest());
                    format!("{supervisor:?}")
                };
                let is_obeyed = after(Some(command)) != after(None);
                let is_possible = request.condition().check(state, true).is_ok();
                assert_eq!(is_obeyed, is_possible, "{request:?} in {state:?}");
            }
        }
    }
}
