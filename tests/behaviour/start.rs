//! The command `start`: from the beginning, after a stop, after the program's end, and where it is refused.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Idle, Parked, Run, Stop};
use cophase_files::report::{describe, notable};
use cophase_tests::scripted::{HZ, command, program, scripted, stands_at_park_phase};

/// If this fails, a program is played from its start after each stop, or skips a piece.
#[test]
fn start_resumes_after_stops_and_restarts_after_the_end() {
    let plain = scripted("");
    let stopped =
        scripted(&(command(0.0, "start") + &command(1.3, "stop") + &command(3.0, "start")));
    assert_eq!(
        stopped.states(),
        [Homing, Run, Stop, Parked, Run, Stop, Parked]
    );
    assert_eq!(
        program(&stopped),
        program(&plain),
        "it goes on where it was"
    );
    stands_at_park_phase(stopped.last());

    let end_s = plain.last().start_ns as f64 * 1e-9;
    let again = scripted(&(command(0.0, "start") + &command(end_s + 0.5, "start")));
    assert_eq!(
        again.states(),
        [Homing, Run, Stop, Parked, Run, Stop, Parked]
    );
    let twice = [program(&plain), program(&plain)].concat();
    assert_eq!(program(&again), twice, "it begins again");
    stands_at_park_phase(again.last());
    stands_at_park_phase(again.at(end_s + 0.4));
    let turns = again.last().phase.since(plain.last().phase);
    assert_eq!(
        turns.frac().to_bits(),
        0,
        "whole turns from one parking to the next"
    );
}

/// If this fails, the fact that a crank stands on the wrong side is lost. The next homing then tilts the platform by it until all indices
/// are detected.
#[test]
fn start_refuses_a_crank_beyond_the_homing_range() {
    let stuck = "[drift]\ntilt_limit_mrad = 3\n\
        [[fault]]\nat_s = 2.1\nkind = \"stuck\"\naxis = 0\nfor_s = 0.1\n";
    let twice = command(0.0, "start") + &command(5.0, "reset") + &command(6.0, "start");
    let refused = scripted(&(stuck.to_owned() + &twice));
    assert_eq!(refused.states(), [Homing, Run, Stop, Fault, Idle, Fault]);
    let fault = refused.last().fault.expect("it is refused");
    assert_eq!(
        (fault.kind, fault.axis),
        (FaultKind::HomingRangeExceeded, Some(0))
    );
    assert_eq!(refused.last().phase, refused.at(4.9).phase, "nothing moves");

    // After a reset without turning the crank back, the start is refused once more, now by the result of homing.
    let again = twice + &command(7.0, "reset") + &command(8.0, "start");
    let homed = scripted(&(stuck.to_owned() + &again));
    assert_eq!(
        homed.states(),
        [
            Homing, Run, Stop, Fault, Idle, Fault, Idle, Homing, Stop, Fault
        ]
    );
    let fault = homed.last().fault.expect("it is refused");
    assert_eq!(
        (fault.kind, fault.axis),
        (FaultKind::HomingRangeExceeded, Some(0))
    );
}

/// If this fails, an operator whose start does nothing learns neither why nor what to do.
#[test]
fn start_that_comes_in_a_stop_is_reported_with_what_to_do() {
    let stop_s = 1.5;
    let start_s = 1.55;
    let watched =
        scripted(&(command(0.0, "start") + &command(stop_s, "stop") + &command(start_s, "start")));
    assert_eq!(watched.at(start_s).state, Stop);
    assert_eq!(watched.states(), [Homing, Run, Stop, Parked]);
    let events = notable(&watched.outcome.record.events);
    let mut said = events
        .iter()
        .map(|event| (event.t_s, describe(&event.what)))
        .filter(|(_, what)| what.starts_with("refused: "));
    let (t_s, what) = said.next().expect("an event");
    // The loop reads the command at a deadline, and its answer is played from the next one on.
    assert!((start_s..=start_s + 2.0 / HZ).contains(&t_s), "{t_s} s");
    assert!(
        what.contains("`start`") && what.contains("in state stop"),
        "{what}"
    );
    assert!(
        what.contains("possible in state idle") && what.contains("or parked"),
        "{what}"
    );
    assert_eq!(said.next(), None);
}
