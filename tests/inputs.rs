//! Alarms and safety inputs that are active between two readings only.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Parked, Run, Stop};
use cophase_tests::scripted::{HZ, input, scripted};

/// A moment in the middle of the program, and between two readings.
const AMID_S: f64 = 1.5 + 0.2 / HZ;

fn fault(kind: &str, at_s: f64, for_s: f64) -> String {
    let axis = if kind == "drive-alarm" {
        "axis = 1\n"
    } else {
        ""
    };
    format!("[[fault]]\nkind = \"{kind}\"\nat_s = {at_s}\nfor_s = {for_s}\n{axis}")
}

/// If this fails, an alarm of a drive is lost because it is over when the loop reads it.
#[test]
fn an_alarm_shorter_than_a_tick_stops_the_machine() {
    for for_s in [1e-6, 100e-6] {
        let watched = scripted(&fault("drive-alarm", AMID_S, for_s));
        assert_eq!(watched.states(), [Homing, Run, Stop, Fault], "{for_s} s");
        let fault = watched.outcome.fault.expect("an alarm");
        assert_eq!((fault.kind, fault.axis), (FaultKind::DriveAlarm, Some(1)));
        // It is read at the next deadline, and not again at those after it.
        assert_eq!(fault.tick, (AMID_S * HZ).ceil() as u64);
    }
}

/// If this fails, a stop that is requested by a short pulse is not obeyed.
#[test]
fn a_stop_shorter_than_a_tick_parks_the_machine() {
    let to_s = AMID_S + 100e-6;
    let pulse = input(AMID_S, "stop", true) + &input(to_s, "stop", false);
    for short in [pulse, fault("stop-input", AMID_S, 100e-6)] {
        assert_eq!(
            scripted(&short).states(),
            [Homing, Run, Stop, Parked],
            "{short}"
        );
    }
}

/// If this fails, the simulated enable input loses what the board's guard detects, or detects what it takes for noise.
#[test]
fn a_loss_of_enable_between_two_readings_counts_from_ten_microseconds_on() {
    let loss = |for_s: f64| input(AMID_S, "enable", false) + &input(AMID_S + for_s, "enable", true);
    for lost in [
        loss(10e-6),
        loss(100e-6),
        fault("enable-loss", AMID_S, 10e-6),
    ] {
        let watched = scripted(&lost);
        assert_eq!(watched.states(), [Homing, Run, Fault], "{lost}");
        assert_eq!(watched.outcome.fault.unwrap().kind, FaultKind::EnableLost);
    }
    let noise = scripted(&loss(8e-6));
    assert_eq!(noise.states(), [Homing, Run, Stop, Parked]);
}
