//! The command `reset` after a fault.
//!
//! Unit tests: `firmware/core/src/supervisor/tests.rs`. What a reset does to drives that hold: `stop_category.rs`.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Idle, Parked, Run, Stop};
use cophase_tests::scripted::{command, scripted, stands_at_park_phase};

/// If this fails, the machine runs on in spite of a fault, or a fault needs the power switched off.
#[test]
fn reset_after_a_fault_lets_the_machine_start_again() {
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
