//! The supervisor's whole graph: every state that any sequence of ticks can reach, under every input.
//!
//! What decides about the next tick is the state, whether a fault is latched, whether the program is held, and how long
//! the drives still settle; which fault it is decides nothing. That is a finite set, so it is searched until nothing new
//! is found, which covers sequences of every length. Beside it goes what an onlooker knows who sees only inputs and drives:
//! whether the machine owes a reset, or a start after it.
//!
//! That the set is complete is checked the other way round: all sequences of [`DEPTH`] single events are played on the
//! supervisor itself, merging nothing, under the same demands.

mod demands;

use super::*;
use demands::{Owed, check};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::vec::Vec;

/// Ticks for which the drives settle: more than one, so that what happens amid settling is met too.
const SETTLE: u32 = 2;

/// Length of the sequences that are played one by one.
const DEPTH: u32 = 6;

/// What one tick brings.
#[derive(Clone, Copy, Debug)]
struct Input {
    inputs: SafetyInputs,
    command: Option<Command>,
    seen: Seen,
}

impl Input {
    fn disables(&self) -> bool {
        self.seen.fault.is_some() && self.seen.reaction == Reaction::Disable
    }

    fn stops(&self) -> bool {
        self.inputs.stop || self.command == Some(Command::Stop)
    }
}

const COMMANDS: [Option<Command>; 7] = [
    None,
    Some(Command::Start),
    Some(Command::Stop),
    Some(Command::Hold),
    Some(Command::Resume),
    Some(Command::Reset),
    Some(Command::ResetPeak),
];

/// All that one tick can bring: 1,120 of them.
fn all_inputs() -> Vec<Input> {
    let faults = [
        (None, false),
        (Some(Reaction::Stop), false),
        (Some(Reaction::Disable), false),
        (Some(Reaction::Stop), true),
        (Some(Reaction::Disable), true),
    ];
    let mut all = Vec::new();
    for command in COMMANDS {
        for (reaction, refines) in faults {
            for bits in 0_u8..32 {
                let bit = |n: u8| bits & (1 << n) != 0;
                all.push(Input {
                    inputs: SafetyInputs {
                        enable: bit(0),
                        stop: bit(1),
                    },
                    command,
                    seen: Seen {
                        fault: reaction.map(|_| Fault::new(FaultKind::Stuck)),
                        reaction: reaction.unwrap_or(Reaction::Stop),
                        refines,
                        at_rest: bit(2),
                        aligned: bit(3),
                        program_done: bit(4),
                        ..Seen::default()
                    },
                });
            }
        }
    }
    all
}

/// All that decides about the next tick.
type Key = (u8, bool, bool, u32, Owed);

fn key(supervisor: &Supervisor, owed: Owed) -> Key {
    let Supervisor {
        state,
        fault,
        holding,
        settling,
        settle_ticks: _,
    } = *supervisor;
    (state as u8, fault.is_some(), holding, settling, owed)
}

/// The reachable set: what is reached in one tick from each, having checked every tick.
fn explore(inputs: &[Input]) -> BTreeMap<Key, BTreeSet<Key>> {
    let mut graph = BTreeMap::new();
    let mut open = VecDeque::from([(Supervisor::new(SETTLE), Owed::Nothing)]);
    let mut restarted = Supervisor::new(SETTLE);
    restarted.begin_with(Fault::new(FaultKind::Restarted));
    open.push_back((restarted, Owed::Reset));
    while let Some((supervisor, owed)) = open.pop_front() {
        let from = key(&supervisor, owed);
        if graph.contains_key(&from) {
            continue;
        }
        let mut next = BTreeSet::new();
        for input in inputs {
            let mut after = supervisor.clone();
            let action = after.step(input.inputs, input.command, &input.seen);
            let owed = check(&supervisor, owed, input, &after, action);
            if next.insert(key(&after, owed)) {
                open.push_back((after, owed));
            }
        }
        graph.insert(from, next);
    }
    graph
}

/// In how many ticks, at most, a state of the machine can be reached from each that is reachable.
fn ticks_to(graph: &BTreeMap<Key, BTreeSet<Key>>, goal: State) -> usize {
    let mut reached: BTreeSet<Key> = graph
        .keys()
        .filter(|key| key.0 == goal as u8)
        .copied()
        .collect();
    let mut ticks = 0;
    while reached.len() < graph.len() {
        let more: Vec<Key> = graph
            .iter()
            .filter(|(from, to)| !reached.contains(*from) && !to.is_disjoint(&reached))
            .map(|(from, _)| *from)
            .collect();
        assert!(!more.is_empty(), "no way to {goal:?} but from {reached:?}");
        reached.extend(more);
        ticks += 1;
    }
    ticks
}

/// Were it wrong, there would be some sequence of ticks, however long, after which the machine runs on with a fault, drives
/// are on that should not be, or the machine can be got nowhere any more but by taking its power away.
#[test]
fn no_sequence_of_any_length_breaks_a_demand_or_ends_in_a_dead_state() {
    let inputs = all_inputs();
    assert_eq!(inputs.len(), 1120);
    let graph = explore(&inputs);
    for state in State::ALL {
        let ticks = ticks_to(&graph, state);
        std::println!("{} is at most {ticks} ticks away", state.name());
        assert!(
            graph.keys().any(|key| key.0 == state as u8),
            "{state:?} is never reached"
        );
    }
    std::println!(
        "{} states, {} ticks looked at",
        graph.len(),
        graph.len() * inputs.len()
    );
}

/// One thing that happens in a tick; safety inputs and what is seen of the machine stay as they are until they change.
const EVENTS: [fn(&mut Input); 16] = [
    |_| {},
    |input| input.command = Some(Command::Start),
    |input| input.command = Some(Command::Stop),
    |input| input.command = Some(Command::Hold),
    |input| input.command = Some(Command::Resume),
    |input| input.command = Some(Command::Reset),
    |input| input.inputs.enable = !input.inputs.enable,
    |input| input.inputs.stop = !input.inputs.stop,
    |input| input.seen.at_rest = !input.seen.at_rest,
    |input| input.seen.aligned = !input.seen.aligned,
    |input| input.seen.program_done = !input.seen.program_done,
    |input| input.seen.fault = Some(Fault::new(FaultKind::Tilt)),
    |input| {
        input.seen.fault = Some(Fault::new(FaultKind::Runaway));
        input.seen.reaction = Reaction::Disable;
    },
    |input| {
        input.seen.fault = Some(Fault::new(FaultKind::Stuck));
        input.seen.refines = true;
    },
    // The usual course of things, so that six events are a long story.
    |input| {
        input.command = Some(Command::Start);
        input.seen.aligned = true;
    },
    |input| {
        input.command = Some(Command::Stop);
        input.seen.at_rest = true;
    },
];

/// The same demands on every sequence of single events, on the supervisor itself: what it keeps is in the model, or there
/// would be a state here that is not there.
#[test]
fn all_sequences_of_six_events_stay_within_the_graph() {
    let graph = explore(&all_inputs());
    let calm = Input {
        inputs: SafetyInputs {
            enable: true,
            stop: false,
        },
        command: None,
        seen: Seen::default(),
    };
    let mut ticks = 0_u64;
    let mut stack = std::vec![(Supervisor::new(SETTLE), Owed::Nothing, calm, 0)];
    while let Some((supervisor, owed, held, depth)) = stack.pop() {
        for event in EVENTS {
            let mut input = held;
            event(&mut input);
            let mut after = supervisor.clone();
            let action = after.step(input.inputs, input.command, &input.seen);
            let owed = check(&supervisor, owed, &input, &after, action);
            assert!(
                graph.contains_key(&key(&after, owed)),
                "not in the graph: {after:?}"
            );
            ticks += 1;
            if depth + 1 < DEPTH {
                let held = Input {
                    command: None,
                    seen: Seen {
                        fault: None,
                        reaction: Reaction::Stop,
                        refines: false,
                        ..input.seen
                    },
                    ..input
                };
                stack.push((after, owed, held, depth + 1));
            }
        }
    }
    std::println!(
        "{ticks} ticks, {} sequences",
        (EVENTS.len() as u64).pow(DEPTH)
    );
}
