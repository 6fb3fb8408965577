//! The enable input: without it the drives are off, and get no pulses. Stop category 0 of IEC 60204-1.
//!
//! Unit tests: `firmware/core/src/supervisor/tests.rs`.

use cophase_core::supervisor::FaultKind;
use cophase_core::supervisor::State::{Fault, Homing, Parked, Run, Stop};
use cophase_files::trace::{Every, Window};
use cophase_tests::record;
use cophase_tests::scripted::{AMID_S, HZ, ONE_TURN, command, fault, input, machine, scripted};

/// If this fails, the drives push on after their enable is removed, or come back by themselves.
#[test]
fn enable_lost_at_speed_cuts_the_drives_the_same_tick() {
    let lost_s = 2.0;
    let happens = command(0.0, "start")
        + &input(lost_s, "enable", false)
        + &input(2.2, "enable", true)
        + &command(2.4, "start");
    let watched = scripted(&happens);
    assert!(
        watched.at(lost_s - 0.01).speed as f64 / ONE_TURN * HZ > 15.0,
        "at speed"
    );
    assert_eq!(watched.states(), [Homing, Run, Fault]);
    for tick in &watched.ticks {
        assert_eq!(
            tick.drives_enabled,
            (1..2_000_000_000).contains(&tick.start_ns),
            "{tick:?}"
        );
        if tick.start_ns > 2_000_000_000 {
            assert_eq!((tick.state, tick.speed), (Fault, 0), "a start is no reset");
        }
    }
    let fault = watched
        .outcome
        .fault
        .expect("a fault, and so exit status 1");
    assert_eq!(fault.kind, FaultKind::EnableLost);
    assert_eq!(fault.tick as f64, lost_s * HZ, "it is dated");
    assert_eq!(watched.last().fault, Some(fault), "it is latched");
}

/// If this fails, an idle machine's trim is stepped into drives that are off, and is lost there.
#[test]
fn drives_that_are_off_get_no_pulses() {
    let scene = machine()
        .axis(0, "trim_deg", 2)
        .with(&command(4.0, "start"))
        .checked();
    let run = record(&scene, Every::Ticks(1), Window::All);
    let edges = run.edges();
    let rises = |from_ns, to_ns| edges.wire("step_0").cut(from_ns, to_ns).rises().count();
    assert_eq!(rises(0, 4_000_000_000), 0);
    assert!(
        rises(4_000_000_000, 5_000_000_000) > 17,
        "the trim is made once the machine moves"
    );
}

/// If this fails, the simulated enable input loses what the board's guard detects, or detects what it takes for noise.
#[test]
fn enable_loss_counts_from_ten_microseconds_on() {
    let loss = |for_s: f64| input(AMID_S, "enable", false) + &input(AMID_S + for_s, "enable", true);
    for lost in [
        loss(10e-6),
        loss(100e-6),
        fault("enable-loss", AMID_S, "for_s = 10e-6"),
    ] {
        let watched = scripted(&lost);
        assert_eq!(watched.states(), [Homing, Run, Fault], "{lost}");
        assert_eq!(watched.outcome.fault.unwrap().kind, FaultKind::EnableLost);
    }
    let noise = scripted(&loss(8e-6));
    assert_eq!(noise.states(), [Homing, Run, Stop, Parked]);
}
