//! Every way to continue from a standstill, through scenes: resume, start again, reset.
//!
//! [`cophase_tests::watch`] asserts at every tick of every one of these runs that all axes are in phase, to the bit. [`scripted`] asserts
//! that the shaft keeps its limits.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Idle, Parked, Run, Stop};
use cophase_tests::Tick;
use cophase_tests::scripted::{command, program, scripted, stands_at_park_phase};

/// If this fails, a hold loses a piece of the program, or does not hold.
#[test]
fn a_hold_keeps_the_speed_and_the_place_in_the_program() {
    let plain = scripted("");
    // During the ramp up, below the band, and in a steady hold.
    for (after_s, amid_ramp) in [(0.5, true), (1.85, false)] {
        // Homing takes two turns, at 4 rev/s.
        let at_s = 2.0 / 4.0 + after_s;
        let held = scripted(&(command(at_s, "hold") + &command(at_s + 0.7, "resume")));
        assert_eq!(program(&held), program(&plain), "{at_s} s");
        let holding: Vec<&Tick> = held.ticks.iter().filter(|tick| tick.holding).collect();
        assert_eq!(holding.len(), 1400, "{at_s} s");
        // Once the acceleration has ended, the speed is constant.
        let steady = holding[700].speed;
        assert!(steady > 0 && holding[700..].iter().all(|tick| tick.speed == steady));
        let before = plain.at(at_s);
        assert_eq!(before.speed != plain.at(at_s + 0.01).speed, amid_ramp);
        assert!(
            steady.abs_diff(before.speed) < (0.02 * before.speed as f64) as u64,
            "{at_s} s"
        );
        assert!(held.last().steps > plain.last().steps);
        stands_at_park_phase(held.last());
    }
    // A stop ends a hold.
    let stopped = scripted(&(command(2.1, "hold") + &command(2.5, "stop")));
    assert_eq!(stopped.states(), [Homing, Run, Stop, Parked]);
    stands_at_park_phase(stopped.last());
}

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

/// If this fails, the machine runs on in spite of a fault, or a fault needs the power switched off.
#[test]
fn a_reset_after_a_fault_lets_the_machine_start_again() {
    let late = "[[late]]\nat_s = 1.1\nby_us = 5000\n";
    let starts = command(0.0, "start") + &command(3.0, "start");
    let unreset = scripted(&(starts.clone() + late));
    assert_eq!(unreset.states(), [Homing, Run, Stop, Fault]);
    assert_eq!(
        unreset.last().fault.map(|fault| fault.kind),
        Some(FaultKind::Overrun)
    );

    // A reset during the stop is too early and has no effect.
    let early = scripted(&(starts.clone() + late + &command(1.2, "reset")));
    assert_eq!(early.states(), unreset.states());

    let reset = scripted(&(starts + late + &command(2.5, "reset")));
    assert_eq!(
        reset.states(),
        [Homing, Run, Stop, Fault, Idle, Homing, Run, Stop, Parked]
    );
    stands_at_park_phase(reset.last());
    assert_eq!(reset.last().fault, None);
    let kept = reset.outcome.fault.map(|fault| fault.kind);
    assert_eq!(
        kept,
        Some(FaultKind::Overrun),
        "that there was a fault is not forgotten"
    );
}

/// If this fails, the fact that a crank stands on the wrong side is lost. The next homing then tilts the platform by it until all indices
/// are detected.
#[test]
fn a_start_refuses_a_crank_beyond_the_homing_range() {
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
