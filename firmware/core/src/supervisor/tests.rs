//! Every state with every input: the next state, and the state of the drives.

use super::*;

const SAFE: SafetyInputs = SafetyInputs {
    enable: true,
    stop: false,
};

fn in_state(state: State) -> Supervisor {
    let mut supervisor = Supervisor::new(0, 2, false);
    let mut go = |command, input| {
        supervisor.step(SAFE, command, &input);
    };
    let homed = SupervisorInput {
        homed: true,
        ..SupervisorInput::default()
    };
    let at_rest = SupervisorInput {
        at_rest: true,
        ..SupervisorInput::default()
    };
    let broken = SupervisorInput {
        fault: Some(Fault::new(FaultKind::Tilt)),
        ..SupervisorInput::default()
    };
    let path: &[(Option<Command>, SupervisorInput)] = match state {
        State::Idle => &[],
        State::Homing => &[(Some(Command::Start), SupervisorInput::default())],
        State::Run => &[
            (Some(Command::Start), SupervisorInput::default()),
            (None, homed),
        ],
        State::Stop => &[
            (Some(Command::Start), SupervisorInput::default()),
            (None, homed),
            (Some(Command::Stop), homed),
        ],
        State::Parked => &[
            (Some(Command::Start), SupervisorInput::default()),
            (None, homed),
            (Some(Command::Stop), homed),
            (None, at_rest),
        ],
        State::Fault => &[
            (Some(Command::Start), SupervisorInput::default()),
            (None, homed),
            (None, broken),
            (None, at_rest),
        ],
    };
    for &(command, input) in path {
        go(command, input);
    }
    assert_eq!(supervisor.state(), state);
    supervisor
}

const STATES: [State; 6] = State::ALL;

/// If this fails, a state whose number is kept over a reset is decoded as another.
#[test]
fn states_are_listed_by_number() {
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

/// Makes one step from every state under every combination of inputs.
fn for_every_step(
    mut check: impl FnMut(State, SafetyInputs, Option<Command>, SupervisorInput, &Supervisor, Action),
) {
    for state in STATES {
        for command in COMMANDS {
            for bits in 0_u8..64 {
                let bit = |n: u8| bits & (1 << n) != 0;
                let inputs = SafetyInputs {
                    enable: bit(0),
                    stop: bit(1),
                };
                let input = SupervisorInput {
                    fault: bit(2).then_some(Fault::new(FaultKind::DriveAlarm)),
                    at_rest: bit(3),
                    homed: bit(4),
                    program_done: bit(5),
                    ..SupervisorInput::default()
                };
                let mut supervisor = in_state(state);
                let action = supervisor.step(inputs, command, &input);
                check(state, inputs, command, input, &supervisor, action);
            }
        }
    }
}

#[test]
fn no_motion_starts_without_enable_or_with_stop() {
    for_every_step(|state, inputs, _, _, after, _| {
        let started = !matches!(state, State::Homing | State::Run | State::Stop)
            && matches!(after.state(), State::Homing | State::Run);
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
fn a_fault_stops_the_machine_until_a_reset() {
    for_every_step(|state, inputs, command, input, after, _| {
        if input.fault.is_some()
            && matches!(
                state,
                State::Homing | State::Run | State::Stop | State::Parked
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
fn no_motion_is_commanded_while_drives_are_off() {
    for_every_step(|_, _, _, _, after, action| {
        assert!(
            after.drives_enabled() || action == Action::Stand,
            "{:?}",
            after.state()
        );
    });
}

#[test]
fn a_stop_is_obeyed_in_every_moving_state() {
    for_every_step(|state, inputs, command, _, after, action| {
        let moving = matches!(state, State::Homing | State::Run | State::Stop);
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

/// If this fails, a later fault, which may be a consequence, hides the first one.
#[test]
fn the_first_fault_is_kept() {
    let mut supervisor = in_state(State::Run);
    let input = |kind| SupervisorInput {
        fault: Some(Fault::new(kind)),
        ..SupervisorInput::default()
    };
    supervisor.step(SAFE, None, &input(FaultKind::Tilt));
    supervisor.step(SAFE, None, &input(FaultKind::IndexMissing));
    assert_eq!(supervisor.fault().unwrap().kind, FaultKind::Tilt);
}

/// If this fails, a report keeps the first diagnosis, or loses the time of the fault.
#[test]
fn a_superseding_fault_replaces_the_kind_but_not_the_tick() {
    let mut supervisor = in_state(State::Run);
    let input = |kind, supersedes, tick| SupervisorInput {
        fault: Some(Fault::new(kind)),
        supersedes,
        tick,
        at_rest: tick == 9,
        ..SupervisorInput::default()
    };
    supervisor.step(SAFE, None, &input(FaultKind::Tilt, false, 7));
    let better = Fault::new(FaultKind::Stuck).on_axis(2);
    let refined = SupervisorInput {
        fault: Some(better),
        ..input(FaultKind::Stuck, true, 8)
    };
    supervisor.step(SAFE, None, &refined);
    let reported = supervisor.fault().unwrap();
    assert_eq!(
        (reported.kind, reported.axis, reported.tick),
        (FaultKind::Stuck, Some(2), 7)
    );
    // The diagnosis may still come at rest. Without a fault there is nothing to rename.
    supervisor.step(
        SAFE,
        None,
        &SupervisorInput {
            at_rest: true,
            ..SupervisorInput::default()
        },
    );
    assert_eq!(supervisor.state(), State::Fault);
    supervisor.step(SAFE, None, &input(FaultKind::Slip, true, 9));
    assert_eq!(supervisor.fault().unwrap().kind, FaultKind::Slip);
    supervisor.step(SAFE, Some(Command::Reset), &SupervisorInput::default());
    supervisor.step(SAFE, None, &input(FaultKind::Slip, true, 10));
    assert_eq!(supervisor.fault(), None);
}

/// If this fails, the stop waits for an axis that runs away, which does not come to rest with the others.
#[test]
fn a_disabling_fault_switches_drives_off_even_during_a_stop() {
    let disables = SupervisorInput {
        fault: Some(Fault::new(FaultKind::Runaway)),
        reaction: Reaction::Disable,
        ..SupervisorInput::default()
    };
    for state in [State::Homing, State::Run, State::Stop, State::Parked] {
        let mut supervisor = in_state(state);
        assert_eq!(supervisor.step(SAFE, None, &disables), Action::Stand);
        assert_eq!(supervisor.state(), State::Fault);
        assert_eq!(supervisor.fault().unwrap().kind, FaultKind::Runaway);
    }
    let mut supervisor = in_state(State::Run);
    let stops = SupervisorInput {
        fault: Some(Fault::new(FaultKind::Tilt)),
        ..SupervisorInput::default()
    };
    assert_eq!(supervisor.step(SAFE, None, &stops), Action::StopFast);
    assert_eq!(supervisor.step(SAFE, None, &disables), Action::Stand);
    assert_eq!(
        supervisor.fault().unwrap().kind,
        FaultKind::Tilt,
        "the first"
    );
}

/// Returns a machine in the fault state after a stop in which it had these faults, one after the other. If `supersedes`, the second fault
/// is the first one under a better name.
fn stopped_by(faults: &[Reaction], supersedes: bool, has_brake: bool) -> Supervisor {
    let mut supervisor = in_state(State::Run);
    supervisor.has_brake = has_brake;
    supervisor.cuts = has_brake;
    for (i, &reaction) in faults.iter().enumerate() {
        let input = SupervisorInput {
            fault: Some(Fault::new(FaultKind::Tilt)),
            reaction,
            supersedes: supersedes && i > 0,
            ..SupervisorInput::default()
        };
        supervisor.step(SAFE, None, &input);
    }
    let at_rest = SupervisorInput {
        at_rest: true,
        ..SupervisorInput::default()
    };
    supervisor.step(SAFE, None, &at_rest);
    assert_eq!(supervisor.state(), State::Fault);
    supervisor
}

/// If this fails, a platform falls after a fault in which every motor could hold, or a drive presses a jammed crank.
#[test]
fn the_hardest_reaction_of_a_stop_decides_whether_the_drives_hold() {
    use Reaction::{Disable, StopAndCut, StopAndHold};
    for (faults, holds) in [
        (&[StopAndHold][..], true),
        (&[StopAndHold, StopAndHold], true),
        (&[StopAndCut], false),
        (&[StopAndHold, StopAndCut], false),
        (&[StopAndCut, StopAndHold], false),
        (&[StopAndHold, Disable], false),
    ] {
        for supersedes in [false, true] {
            let held = stopped_by(faults, supersedes, false).drives_enabled();
            assert_eq!(held, holds, "{faults:?}, {supersedes}");
            let braked = stopped_by(faults, supersedes, true).drives_enabled();
            assert!(!braked, "a brake holds: {faults:?}, {supersedes}");
        }
    }
}

/// If this fails, the drives of a machine that holds after a fault cannot be switched off, or stay on unnoticed.
#[test]
fn enable_loss_a_harder_fault_or_a_reset_ends_holding() {
    let quiet = SupervisorInput::default();
    let fault = |reaction| SupervisorInput {
        fault: Some(Fault::new(FaultKind::DriveAlarm)),
        reaction,
        ..quiet
    };
    let open = SafetyInputs {
        enable: false,
        ..SAFE
    };
    let stop = SafetyInputs { stop: true, ..SAFE };
    for (inputs, command, input, state, holds) in [
        (SAFE, None, quiet, State::Fault, true),
        (stop, Some(Command::StopNow), quiet, State::Fault, true),
        (SAFE, Some(Command::Start), quiet, State::Fault, true),
        (SAFE, None, fault(Reaction::StopAndHold), State::Fault, true),
        (SAFE, None, fault(Reaction::StopAndCut), State::Fault, false),
        (SAFE, None, fault(Reaction::Disable), State::Fault, false),
        (open, None, quiet, State::Fault, false),
        (SAFE, Some(Command::Reset), quiet, State::Idle, false),
        (open, Some(Command::Reset), quiet, State::Idle, false),
        // A new fault is not reset by a command that was given before the fault was visible.
        (
            SAFE,
            Some(Command::Reset),
            fault(Reaction::StopAndCut),
            State::Fault,
            false,
        ),
    ] {
        let mut supervisor = stopped_by(&[Reaction::StopAndHold], false, false);
        let say = std::format!("{inputs:?} {command:?} {input:?}");
        assert_eq!(
            supervisor.step(inputs, command, &input),
            Action::Stand,
            "{say}"
        );
        assert_eq!(
            (supervisor.state(), supervisor.drives_enabled()),
            (state, holds),
            "{say}"
        );
        let latched = supervisor.fault().map(|fault| fault.kind);
        let expected = (state == State::Fault).then_some(FaultKind::Tilt);
        assert_eq!(latched, expected, "the first fault stays: {say}");
        // Drives that are off stay off, for any input.
        supervisor.step(SAFE, None, &quiet);
        assert_eq!(supervisor.drives_enabled(), holds, "{say}");
    }
}

/// If this fails, the machine runs before every index has been detected, for some sequence of inputs.
#[test]
fn nothing_runs_before_homing() {
    let commands = [
        None,
        Some(Command::Start),
        Some(Command::Stop),
        Some(Command::Reset),
    ];
    // All sequences of five ticks, each with a command and a shaft that is at rest or not.
    for sequence in 0..8_u32.pow(5) {
        let mut supervisor = Supervisor::new(0, 2, false);
        for tick in 0..5 {
            let choice = sequence / 8_u32.pow(tick) % 8;
            let input = SupervisorInput {
                at_rest: choice >= 4,
                ..SupervisorInput::default()
            };
            supervisor.step(SAFE, commands[choice as usize % 4], &input);
            assert_ne!(supervisor.state(), State::Run, "sequence {sequence:o}");
        }
    }
}

/// If this fails, a hold outlives its run, and the next start does not play the program.
#[test]
fn a_hold_does_not_outlive_its_run() {
    let mut supervisor = in_state(State::Run);
    let homed = SupervisorInput {
        homed: true,
        at_rest: true,
        ..SupervisorInput::default()
    };
    let mut step = |command| supervisor.step(SAFE, command, &homed);
    assert_eq!(step(Some(Command::Hold)), Action::Hold);
    step(Some(Command::Stop));
    assert_eq!(step(None), Action::Park);
    assert_eq!(step(Some(Command::Start)), Action::Play);
}
