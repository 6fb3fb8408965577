//! Every state against every input: where it goes, and what that lets the drives do.

use super::*;

const SAFE: SafetyInputs = SafetyInputs {
    enable: true,
    stop: false,
};

fn in_state(state: State) -> Supervisor {
    let mut supervisor = Supervisor::new(0);
    let mut go = |command, seen| {
        supervisor.step(SAFE, command, &seen);
    };
    let aligned = Seen {
        aligned: true,
        ..Seen::default()
    };
    let at_rest = Seen {
        at_rest: true,
        ..Seen::default()
    };
    let broken = Seen {
        fault: Some(Fault::new(FaultKind::Tilt)),
        ..Seen::default()
    };
    let path: &[(Option<Command>, Seen)] = match state {
        State::Idle => &[],
        State::Align => &[(Some(Command::Start), Seen::default())],
        State::Run => &[(Some(Command::Start), Seen::default()), (None, aligned)],
        State::Stop => &[
            (Some(Command::Start), Seen::default()),
            (None, aligned),
            (Some(Command::Stop), aligned),
        ],
        State::Parked => &[
            (Some(Command::Start), Seen::default()),
            (None, aligned),
            (Some(Command::Stop), aligned),
            (None, at_rest),
        ],
        State::Fault => &[
            (Some(Command::Start), Seen::default()),
            (None, aligned),
            (None, broken),
            (None, at_rest),
        ],
    };
    for &(command, seen) in path {
        go(command, seen);
    }
    assert_eq!(supervisor.state(), state);
    supervisor
}

const STATES: [State; 6] = State::ALL;

/// A state is kept as its number over a restart, and told by it.
#[test]
fn every_state_is_at_its_number() {
    for (number, state) in State::ALL.into_iter().enumerate() {
        assert_eq!(state as usize, number);
    }
}
const COMMANDS: [Option<Command>; 6] = [
    None,
    Some(Command::Start),
    Some(Command::Stop),
    Some(Command::Hold),
    Some(Command::Resume),
    Some(Command::Reset),
];

/// One step from every state under every combination of inputs.
fn for_every_step(
    mut check: impl FnMut(State, SafetyInputs, Option<Command>, Seen, &Supervisor, Action),
) {
    for state in STATES {
        for command in COMMANDS {
            for bits in 0_u8..64 {
                let bit = |n: u8| bits & (1 << n) != 0;
                let inputs = SafetyInputs {
                    enable: bit(0),
                    stop: bit(1),
                };
                let seen = Seen {
                    fault: bit(2).then_some(Fault::new(FaultKind::DriveAlarm)),
                    at_rest: bit(3),
                    aligned: bit(4),
                    program_done: bit(5),
                    ..Seen::default()
                };
                let mut supervisor = in_state(state);
                let action = supervisor.step(inputs, command, &seen);
                check(state, inputs, command, seen, &supervisor, action);
            }
        }
    }
}

#[test]
fn nothing_starts_against_the_inputs() {
    for_every_step(|state, inputs, _, _, after, _| {
        let started = !matches!(state, State::Align | State::Run | State::Stop)
            && matches!(after.state(), State::Align | State::Run);
        assert!(
            !started || (inputs.enable && !inputs.stop),
            "{state:?} {inputs:?}"
        );
    });
}

#[test]
fn losing_enable_switches_off_at_once() {
    for_every_step(|state, inputs, _, _, after, _| {
        if !inputs.enable {
            assert!(!after.drives_enabled(), "{state:?} {:?}", after.state());
        }
    });
}

#[test]
fn a_fault_stops_and_only_a_reset_leaves_it() {
    for_every_step(|state, inputs, command, seen, after, _| {
        if seen.fault.is_some()
            && matches!(
                state,
                State::Align | State::Run | State::Stop | State::Parked
            )
        {
            assert!(
                matches!(after.state(), State::Stop | State::Fault),
                "{state:?}"
            );
            assert!(after.fault().is_some(), "{state:?} forgets its fault");
        }
        if state == State::Fault && after.state() != State::Fault {
            assert_eq!(
                (after.state(), command),
                (State::Idle, Some(Command::Reset)),
                "{inputs:?}"
            );
        }
    });
}

#[test]
fn drives_that_are_off_are_not_driven() {
    for_every_step(|_, _, _, _, after, action| {
        assert!(
            after.drives_enabled() || action == Action::Stand,
            "{:?}",
            after.state()
        );
    });
}

#[test]
fn a_stop_is_heeded_from_every_moving_state() {
    for_every_step(|state, inputs, command, _, after, action| {
        let moving = matches!(state, State::Align | State::Run | State::Stop);
        if moving && inputs.enable && (inputs.stop || command == Some(Command::Stop)) {
            assert!(matches!(
                after.state(),
                State::Stop | State::Parked | State::Fault
            ));
            assert!(matches!(
                action,
                Action::Park | Action::StopFast | Action::Stand
            ));
        }
    });
}

/// The first fault is the cause; later ones follow from it.
#[test]
fn the_first_fault_is_kept() {
    let mut supervisor = in_state(State::Run);
    let seen = |kind| Seen {
        fault: Some(Fault::new(kind)),
        ..Seen::default()
    };
    supervisor.step(SAFE, None, &seen(FaultKind::Tilt));
    supervisor.step(SAFE, None, &seen(FaultKind::IndexMissing));
    assert_eq!(supervisor.fault().unwrap().kind, FaultKind::Tilt);
}

/// Were it wrong, a report would keep the first guess, or lose when it all began.
#[test]
fn a_better_name_replaces_what_latched_and_not_when() {
    let mut supervisor = in_state(State::Run);
    let seen = |kind, refines, tick| Seen {
        fault: Some(Fault::new(kind)),
        refines,
        tick,
        at_rest: tick == 9,
        ..Seen::default()
    };
    supervisor.step(SAFE, None, &seen(FaultKind::Tilt, false, 7));
    let better = Fault::new(FaultKind::Stuck).on_axis(2);
    let refined = Seen {
        fault: Some(better),
        ..seen(FaultKind::Stuck, true, 8)
    };
    supervisor.step(SAFE, None, &refined);
    let told = supervisor.fault().unwrap();
    assert_eq!(
        (told.kind, told.axis, told.tick),
        (FaultKind::Stuck, Some(2), 7)
    );
    // At rest with the drives off it may still be learnt; without a fault there is nothing to name.
    supervisor.step(
        SAFE,
        None,
        &Seen {
            at_rest: true,
            ..Seen::default()
        },
    );
    assert_eq!(supervisor.state(), State::Fault);
    supervisor.step(SAFE, None, &seen(FaultKind::Slip, true, 9));
    assert_eq!(supervisor.fault().unwrap().kind, FaultKind::Slip);
    supervisor.step(SAFE, Some(Command::Reset), &Seen::default());
    supervisor.step(SAFE, None, &seen(FaultKind::Slip, true, 10));
    assert_eq!(supervisor.fault(), None);
}

/// Were it wrong, a runaway would be waited for: it does not come to rest with the others.
#[test]
fn a_fault_that_disables_switches_off_at_once_and_during_another_stop_too() {
    let disables = Seen {
        fault: Some(Fault::new(FaultKind::Runaway)),
        reaction: Reaction::Disable,
        ..Seen::default()
    };
    for state in [State::Align, State::Run, State::Stop, State::Parked] {
        let mut supervisor = in_state(state);
        assert_eq!(supervisor.step(SAFE, None, &disables), Action::Stand);
        assert_eq!(supervisor.state(), State::Fault);
        assert_eq!(supervisor.fault().unwrap().kind, FaultKind::Runaway);
    }
    let mut supervisor = in_state(State::Run);
    let stops = Seen {
        fault: Some(Fault::new(FaultKind::Tilt)),
        ..Seen::default()
    };
    assert_eq!(supervisor.step(SAFE, None, &stops), Action::StopFast);
    assert_eq!(supervisor.step(SAFE, None, &disables), Action::Stand);
    assert_eq!(
        supervisor.fault().unwrap().kind,
        FaultKind::Tilt,
        "the first"
    );
}

/// Whatever comes, in whatever order: the machine does not run before every index has been heard.
#[test]
fn nothing_runs_unaligned() {
    let commands = [
        None,
        Some(Command::Start),
        Some(Command::Stop),
        Some(Command::Reset),
    ];
    // All sequences of five ticks: a command, and whether the shaft has come to rest.
    for sequence in 0..8_u32.pow(5) {
        let mut supervisor = Supervisor::new(0);
        for tick in 0..5 {
            let choice = sequence / 8_u32.pow(tick) % 8;
            let seen = Seen {
                at_rest: choice >= 4,
                ..Seen::default()
            };
            supervisor.step(SAFE, commands[choice as usize % 4], &seen);
            assert_ne!(supervisor.state(), State::Run, "sequence {sequence:o}");
        }
    }
}

/// A hold ends with the run that it was asked in: the next start plays.
#[test]
fn a_hold_does_not_outlive_its_run() {
    let mut supervisor = in_state(State::Run);
    let aligned = Seen {
        aligned: true,
        at_rest: true,
        ..Seen::default()
    };
    let mut step = |command| supervisor.step(SAFE, command, &aligned);
    assert_eq!(step(Some(Command::Hold)), Action::Hold);
    step(Some(Command::Stop));
    assert_eq!(step(None), Action::Park);
    assert_eq!(step(Some(Command::Start)), Action::Play);
}
