//! Remedy for a request that is not possible in the present state of the machine.
//!
//! The controller's own rules decide: the link has the condition of each request, and a search on the core's supervisor finds the shortest
//! path from the present state to one that meets it.

use std::collections::VecDeque;

use cophase_core::supervisor::{
    Command, Fault, FaultKind, SafetyInputs, State, Supervisor, SupervisorInput,
};
use cophase_link::Condition;

/// Limit on the length of a path. No state is as far from another one.
const MAX_STEPS: usize = 5;

/// Step on the path from one state to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// Whatever the machine does now is over: homing, or a stop.
    Wait,
    Send(&'static str, Command),
    OpenEnable,
    Fail,
}

const HOME: Step = Step::Send("home", Command::Home);
const START: Step = Step::Send("start", Command::Start);
const STOP: Step = Step::Send("stop", Command::Stop);
const RESET: Step = Step::Send("reset", Command::Reset);

impl Step {
    /// Returns the supervisor after this step.
    fn after(self, before: &Supervisor) -> Supervisor {
        let inputs = SafetyInputs {
            enable: self != Self::OpenEnable,
            stop: false,
        };
        let command = match self {
            Self::Send(_, command) => Some(command),
            _ => None,
        };
        let input = SupervisorInput {
            fault: (self == Self::Fail).then(|| Fault::new(FaultKind::Tilt)),
            at_rest: true,
            homed: true,
            ..SupervisorInput::default()
        };
        let mut after = before.clone();
        after.step(inputs, command, &input);
        after
    }
}

/// Returns the shortest path from a supervisor to one that is a goal, and that supervisor. Of paths of the same length, it is the one whose
/// steps come first.
fn search(
    from: Supervisor,
    steps: &[Step],
    is_goal: impl Fn(&Supervisor) -> bool,
) -> Option<(Supervisor, Vec<Step>)> {
    let mut open = VecDeque::from([(from, Vec::new())]);
    while let Some((supervisor, path)) = open.pop_front() {
        if is_goal(&supervisor) {
            return Some((supervisor, path));
        }
        if path.len() == MAX_STEPS {
            continue;
        }
        for &step in steps {
            let after = step.after(&supervisor);
            // A fault is no remedy.
            if step == Step::Fail || supervisor.has_fault() || !after.has_fault() {
                open.push_back((after, [&path[..], &[step]].concat()));
            }
        }
    }
    None
}

/// Returns the supervisor of a machine in a state. After a fault, its drives hold.
fn supervisor_in(state: State) -> Option<Supervisor> {
    let begin = Supervisor::new(0, 1, false);
    let steps = [Step::Wait, START, STOP, Step::Fail];
    search(begin, &steps, |supervisor| supervisor.state() == state).map(|(found, _)| found)
}

/// Returns the condition of a request that was refused in a state, and how to meet it.
pub(super) fn remedy(condition: Condition, state: State) -> String {
    let path = supervisor_in(state).and_then(|from| {
        let steps = [Step::Wait, HOME, START, STOP, RESET, Step::OpenEnable];
        search(from, &steps, |supervisor| {
            let drives_are_on = supervisor.drives_enabled();
            condition.check(supervisor.state(), drives_are_on).is_ok()
        })
    });
    let Some((_, path)) = path else {
        return condition.to_string();
    };
    let parts: Vec<String> = path
        .iter()
        .filter_map(|step| match step {
            Step::Send(name, _) => Some(format!("send `{name}`")),
            Step::OpenEnable => Some("open and close the enable input".to_owned()),
            Step::Wait | Step::Fail => None,
        })
        .collect();
    if parts.is_empty() {
        format!("{condition}: wait for it")
    } else {
        format!("{condition}: first {}", parts.join(", then "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_link::message::{File, Request};

    const STOP_AND_OPEN: &str = "first send `stop`, then open and close the enable input";
    const OPEN: &str = "first open and close the enable input";

    /// Every condition in every state in which it is not met: a wrong remedy moves a machine in vain, or makes a fault.
    #[test]
    fn remedies_lead_to_the_request() {
        let at_rest = "in state idle or parked";
        let table: [(Condition, &str, [&str; 6]); 6] = [
            (
                Request::Start.condition(),
                at_rest,
                [
                    "",
                    "first send `stop`",
                    "first send `stop`",
                    "wait for it",
                    "",
                    "first send `reset`",
                ],
            ),
            (
                Request::Home.condition(),
                "in state idle",
                [
                    "",
                    STOP_AND_OPEN,
                    STOP_AND_OPEN,
                    OPEN,
                    OPEN,
                    "first send `reset`",
                ],
            ),
            (
                Request::Jog.condition(),
                "in state parked",
                [
                    "first send `home`",
                    "first send `stop`",
                    "first send `stop`",
                    "wait for it",
                    "",
                    "first send `reset`, then send `home`",
                ],
            ),
            (
                Request::Hold.condition(),
                "in state run",
                [
                    "first send `start`",
                    "wait for it",
                    "",
                    "first send `start`",
                    "first send `start`",
                    "first send `reset`, then send `start`",
                ],
            ),
            (
                Request::Reset.condition(),
                "in state fault",
                ["", "", "", "", "", ""],
            ),
            (
                File::Settings.condition(),
                "while the drives are off",
                [
                    "",
                    STOP_AND_OPEN,
                    STOP_AND_OPEN,
                    OPEN,
                    OPEN,
                    "first send `reset`",
                ],
            ),
        ];
        for (condition, place, remedies) in table {
            for (state, expected) in State::ALL.into_iter().zip(remedies) {
                let is_on = !matches!(state, State::Idle);
                if condition.check(state, is_on).is_ok() {
                    continue;
                }
                let expected = if expected.is_empty() {
                    place.to_owned()
                } else {
                    format!("{place}: {expected}")
                };
                assert_eq!(remedy(condition, state), expected, "{state:?}");
            }
        }
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
                let supervisor = supervisor_in(state).unwrap();
                assert_eq!(supervisor.state(), state);
                let after = |step: Step| format!("{:?}", step.after(&supervisor));
                let is_obeyed = after(Step::Send("", command)) != after(Step::Wait);
                let is_possible = request.condition().check(state, true).is_ok();
                assert_eq!(is_obeyed, is_possible, "{request:?} in {state:?}");
            }
        }
    }
}
