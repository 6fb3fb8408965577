//! Complete graph of the supervisor: every state that any sequence of ticks can reach, under every input.
//!
//! These things decide the next tick: the state, whether a fault is latched, whether the fault state has the drives off,
//! whether there is a brake, whether the program is held, whether the stop is the fastest, whether the machine only homes,
//! and the remaining times of settling and of a jog. The kind of the fault decides nothing. This set is finite, so it is
//! searched until nothing new is found, which covers sequences of every length. The model also keeps the knowledge of an
//! observer of inputs and drives: whether the machine needs a reset, or a start after it, and whether a fault has come
//! that must not be held.
//!
//! A second test checks that the set is complete. It plays all sequences of [`DEPTH`] single events on the supervisor
//! itself, without merging states, under the same demands.

mod demands;

use super::*;
use demands::{Input, Owed, check, demand_an_answer};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::vec::Vec;

/// Ticks for which the drives settle: more than one, so that events during settling are covered.
const SETTLE: u32 = 2;

/// Ticks of one jog: more than one, so that events during a jog are covered.
const JOG: u32 = 2;

/// Length of the sequences that are played one by one.
const DEPTH: u32 = 6;

const COMMANDS: [Option<Command>; 11] = [
    None,
    Some(Command::Start),
    Some(Command::Stop),
    Some(Command::Hold),
    Some(Command::Resume),
    Some(Command::Reset),
    Some(Command::ResetPeak),
    Some(Command::Home),
    Some(Command::Jog),
    Some(Command::StopNow),
    Some(Command::Override(500)),
];

/// All possible inputs of one tick: 2,464 of them.
fn all_inputs() -> Vec<Input> {
    let faults = [
        (None, false),
        (Some(Reaction::StopAndHold), false),
        (Some(Reaction::StopAndCut), false),
        (Some(Reaction::Disable), false),
        (Some(Reaction::StopAndHold), true),
        (Some(Reaction::StopAndCut), true),
        (Some(Reaction::Disable), true),
    ];
    let mut all = Vec::new();
    for command in COMMANDS {
        for (reaction, supersedes) in faults {
            for bits in 0_u8..32 {
                let bit = |n: u8| bits & (1 << n) != 0;
                all.push(Input {
                    inputs: SafetyInputs {
                        enable: bit(0),
                        stop: bit(1),
                    },
                    command,
                    observed: SupervisorInput {
                        fault: reaction.map(|_| Fault::new(FaultKind::Stuck)),
                        reaction: reaction.unwrap_or(Reaction::StopAndHold),
                        supersedes,
                        at_rest: bit(2),
                        homed: bit(3),
                        program_done: bit(4),
                        ..SupervisorInput::default()
                    },
                });
            }
        }
    }
    all
}

/// Everything that decides the next tick.
type Key = (u8, [bool; 3], [bool; 3], [u32; 2], Owed);

fn key(supervisor: &Supervisor, owed: Owed) -> Key {
    let Supervisor {
        state,
        fault,
        cuts,
        has_brake,
        holding,
        stops_now,
        only_homes,
        jogging,
        settling,
        settle_ticks: _,
        jog_ticks: _,
        refused: _,
    } = *supervisor;
    let modes = [holding, stops_now, only_homes];
    (
        state as u8,
        [fault.is_some(), cuts, has_brake],
        modes,
        [settling, jogging],
        owed,
    )
}

/// Explores the reachable set and checks every tick; returns the successors of each state.
fn explore(inputs: &[Input]) -> BTreeMap<Key, BTreeSet<Key>> {
    let mut graph = BTreeMap::new();
    let mut open = VecDeque::new();
    for has_brake in [false, true] {
        let fresh = Supervisor::new(SETTLE, JOG, has_brake);
        let mut after_reset = fresh.clone();
        after_reset.begin_with(Fault::new(FaultKind::WatchdogReset));
        open.push_back((fresh, Owed::Nothing));
        open.push_back((after_reset, Owed::Reset { may_hold: false }));
    }
    while let Some((supervisor, owed)) = open.pop_front() {
        let from = key(&supervisor, owed);
        if graph.contains_key(&from) {
            continue;
        }
        let mut next = BTreeSet::new();
        for input in inputs {
            let mut after = supervisor.clone();
            let action = after.step(input.inputs, input.command, &input.observed);
            let owed = check(&supervisor, owed, input, &after, action);
            demand_an_answer(&supervisor, input, &after, action);
            if next.insert(key(&after, owed)) {
                open.push_back((after, owed));
            }
        }
        graph.insert(from, next);
    }
    graph
}

/// Greatest number of ticks from any reachable state to a given state of the machine.
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

/// If this fails, the machine may run on with a fault, drives may be on that must be off, or only a power cycle may leave a state.
#[test]
fn no_sequence_of_any_length_breaks_a_demand_or_ends_in_a_dead_state() {
    let inputs = all_inputs();
    assert_eq!(inputs.len(), 2464);
    let graph = explore(&inputs);
    for state in State::ALL {
        let ticks = ticks_to(&graph, state);
        std::println!("{} is at most {ticks} ticks away", state.name());
        assert!(
            graph.keys().any(|key| key.0 == state as u8),
            "{state:?} is never reached"
        );
    }
    let fault = State::Fault as u8;
    let has_drives_on = |cuts: bool| graph.keys().any(|key| key.0 == fault && key.1[1] == cuts);
    assert!(has_drives_on(false) && has_drives_on(true), "held, and not");
    std::println!(
        "{} states, {} ticks checked",
        graph.len(),
        graph.len() * inputs.len()
    );
}

/// Single events in a tick. Safety inputs and observations of the machine keep their values until an event changes them.
const EVENTS: [fn(&mut Input); 20] = [
    |_| {},
    |input| input.command = Some(Command::Start),
    |input| input.command = Some(Command::Stop),
    |input| input.command = Some(Command::Hold),
    |input| input.command = Some(Command::Resume),
    |input| input.command = Some(Command::Reset),
    |input| input.command = Some(Command::Home),
    |input| input.command = Some(Command::Jog),
    |input| input.command = Some(Command::StopNow),
    |input| input.inputs.enable = !input.inputs.enable,
    |input| input.inputs.stop = !input.inputs.stop,
    |input| input.observed.at_rest = !input.observed.at_rest,
    |input| input.observed.homed = !input.observed.homed,
    |input| input.observed.program_done = !input.observed.program_done,
    |input| input.observed.fault = Some(Fault::new(FaultKind::Tilt)),
    |input| {
        input.observed.fault = Some(Fault::new(FaultKind::Runaway));
        input.observed.reaction = Reaction::Disable;
    },
    |input| {
        input.observed.fault = Some(Fault::new(FaultKind::DriveAlarm));
        input.observed.reaction = Reaction::StopAndCut;
    },
    |input| {
        input.observed.fault = Some(Fault::new(FaultKind::Stuck));
        input.observed.reaction = Reaction::StopAndCut;
        input.observed.supersedes = true;
    },
    // Usual combinations, so that six events make a long sequence.
    |input| {
        input.command = Some(Command::Start);
        input.observed.homed = true;
    },
    |input| {
        input.command = Some(Command::Stop);
        input.observed.at_rest = true;
    },
];

/// Checks the same demands on every sequence of single events, on the supervisor itself. If this fails with a state that is not in the
/// graph, the model lacks a part of the supervisor's state.
#[test]
fn all_sequences_of_six_events_stay_within_the_graph() {
    let graph = explore(&all_inputs());
    let quiet = Input {
        inputs: SafetyInputs {
            enable: true,
            stop: false,
        },
        command: None,
        observed: SupervisorInput::default(),
    };
    let mut ticks = 0_u64;
    let mut stack = std::vec![(Supervisor::new(SETTLE, JOG, false), Owed::Nothing, quiet, 0)];
    while let Some((supervisor, owed, held, depth)) = stack.pop() {
        for event in EVENTS {
            let mut input = held;
            event(&mut input);
            let mut after = supervisor.clone();
            let action = after.step(input.inputs, input.command, &input.observed);
            let owed = check(&supervisor, owed, &input, &after, action);
            assert!(
                graph.contains_key(&key(&after, owed)),
                "not in the graph: {after:?}"
            );
            ticks += 1;
            if depth + 1 < DEPTH {
                let held = Input {
                    command: None,
                    observed: SupervisorInput {
                        fault: None,
                        reaction: Reaction::StopAndHold,
                        supersedes: false,
                        ..input.observed
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
