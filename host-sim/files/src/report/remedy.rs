//! Remedy for a command that is not possible in the present state of the machine.

use cophase_core::supervisor::State;

/// Returns how a machine gets into a state; empty where no command leads there.
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

/// Returns in which states something is possible, and how the machine gets there.
pub fn remedy(states: impl IntoIterator<Item = State>) -> String {
    let reached = |state: State| match begins(state) {
        "" => state.name().to_owned(),
        begins => format!("{} ({begins})", state.name()),
    };
    let states: Vec<_> = states.into_iter().map(reached).collect();
    format!("in state {}", states.join(" or "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_core::supervisor::{
        Command, Fault, FaultKind, SafetyInputs, Supervisor, SupervisorInput,
    };

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
        for (command, expected) in [
            (Command::Start, format!("in state {idle} or {parked}")),
            (Command::Jog, format!("in state {parked}")),
            (
                Command::Hold,
                "in state run (after `start`, once homing is over)".to_owned(),
            ),
            (Command::Reset, "in state fault".to_owned()),
        ] {
            assert_eq!(remedy(command.states()), expected);
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
}
