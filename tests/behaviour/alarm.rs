//! Alarms of drives that are active between two readings only. How a machine stops for one: `stop_category.rs`, and for that of a servo on
//! STEP and DIR: `../machines/pulse_servo.rs`.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Run, Stop};
use cophase_tests::scripted::{AMID_S, HZ, fault, scripted};

/// If this fails, an alarm of a drive is lost because it is over when the loop reads it.
#[test]
fn alarm_shorter_than_a_tick_stops_the_machine() {
    for for_s in [1e-6, 100e-6] {
        let watched = scripted(&fault(
            "drive-alarm",
            AMID_S,
            &format!("axis = 1\nfor_s = {for_s}"),
        ));
        assert_eq!(watched.states(), [Homing, Run, Stop, Fault], "{for_s} s");
        let fault = watched.outcome.fault.expect("an alarm");
        assert_eq!((fault.kind, fault.axis), (FaultKind::DriveAlarm, Some(1)));
        // It is read at the next deadline, and not again at those after it.
        assert_eq!(fault.tick, (AMID_S * HZ).ceil() as u64);
    }
}
