//! The stop input stops like the command, whether it stays active or is over before it is read.

use cophase_core::supervisor::State::{Homing, Parked, Run, Stop};
use cophase_tests::scripted::{AMID_S, command, fault, input, scripted, stands_at_park_phase};
use cophase_tests::{Tick, Watched};

/// If this fails, the stop button acts differently from the command, or lets a start through.
#[test]
fn stop_input_acts_like_the_command_and_refuses_starts() {
    let commanded = scripted(&command(1.0, "stop"));
    let pressed = input(1.0, "stop", true);
    let held = scripted(&(pressed.clone() + &command(0.0, "start") + &command(3.0, "start")));
    assert_eq!(held.states(), [Homing, Run, Stop, Parked]);
    let moving = |watched: &Watched| -> Vec<Tick> {
        watched
            .ticks
            .iter()
            .take_while(|tick| tick.state != Parked)
            .copied()
            .collect()
    };
    assert_eq!(moving(&held), moving(&commanded));
    assert!(
        held.last().start_ns > 3_000_000_000,
        "the start was received, and not obeyed"
    );
    stands_at_park_phase(held.last());

    let freed = pressed + &input(2.5, "stop", false);
    let freed = scripted(&(freed + &command(0.0, "start") + &command(3.0, "start")));
    assert_eq!(
        freed.states(),
        [Homing, Run, Stop, Parked, Run, Stop, Parked]
    );
    stands_at_park_phase(freed.last());
}

/// If this fails, a stop that is requested by a short pulse is not obeyed.
#[test]
fn stop_shorter_than_a_tick_parks_the_machine() {
    let to_s = AMID_S + 100e-6;
    let pulse = input(AMID_S, "stop", true) + &input(to_s, "stop", false);
    for short in [pulse, fault("stop-input", AMID_S, "for_s = 100e-6")] {
        assert_eq!(
            scripted(&short).states(),
            [Homing, Run, Stop, Parked],
            "{short}"
        );
    }
}
