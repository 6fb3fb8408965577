//! Parking: a program or a stop ends at the parking phase, at the first passage that can be reached.
//!
//! Unit tests: `firmware/motion/src/shaft/tests/`.

use cophase_core::supervisor::State::{Homing, Parked, Run, Stop};
use cophase_core::units::Phase;
use cophase_tests::scripted::{ONE_TURN, command, program, scripted, stands_at_park_phase};

use super::fault_stop::{USUAL, each_machine, machine, min_ticks};

/// If this fails, a machine does not come to rest by itself, or comes to rest elsewhere than commanded.
#[test]
fn program_ends_parked_at_the_parking_phase() {
    let watched = scripted("");
    assert_eq!(watched.states(), [Homing, Run, Stop, Parked]);
    stands_at_park_phase(watched.last());
    assert_eq!(watched.outcome.fault, None);
    assert_eq!(program(&watched).len(), 3300 * 2);
}

/// If this fails, a stop that comes while the shaft accelerates jerks it, or misses the phase.
#[test]
fn stop_amid_a_ramp_parks() {
    for at_s in [0.7, 0.9, 1.1, 2.6, 3.0] {
        let watched = scripted(&command(at_s, "stop"));
        let before = watched.at(at_s);
        assert_eq!(before.state, Run, "{at_s} s");
        assert_ne!(
            watched.at(at_s - 0.01).speed,
            before.speed,
            "{at_s} s is amid a ramp"
        );
        assert_eq!(watched.states(), [Homing, Run, Stop, Parked]);
        stands_at_park_phase(watched.last());
    }
}

/// If this fails, a stop that comes before the first index pulse is lost.
#[test]
fn stop_while_homing_parks() {
    for at_s in [0.01, 0.1, 0.2] {
        let watched = scripted(&command(at_s, "stop"));
        assert_eq!(watched.states()[..2], [Homing, Stop], "{at_s} s");
        assert!(!watched.states().contains(&Run), "{at_s} s");
        assert_eq!(watched.last().state, Parked);
        if at_s > 0.02 {
            stands_at_park_phase(watched.last());
        } else {
            assert_eq!(
                watched.last().phase,
                Phase::ZERO,
                "nothing had moved: nothing moves"
            );
        }
    }
}

/// If this fails, a machine commanded to park passes the phase at which all its cranks could already stand.
#[test]
fn stop_at_a_phase_uses_the_first_passage() {
    let park = (33.3 / 360.0 * ONE_TURN).round();
    each_machine(|axes, drive| {
        for step in 0..8 {
            let at_s = 2.3 + 0.0061 * f64::from(step);
            let watched = machine(axes, drive, &command(at_s, "stop"));
            let at = watched.ticks.iter().position(|tick| tick.state == Stop);
            let (at, ticks) = (at.expect("a stop"), &watched.ticks);
            let (last, before) = (ticks[at - 1], ticks[at - 2]);
            assert_eq!(last.speed, before.speed, "at a constant speed");
            let speed = last.speed as f64;
            let moved = ticks[at..].iter().take_while(|tick| tick.speed > 0).count();
            let ramp = min_ticks(USUAL, speed, 0.0);
            // The nearest phase that can be reached, and the first passage after that.
            let distance = speed * (ramp / 2.0 - 1.0);
            let ahead = (park - last.phase.within_turn().to_bits() as f64).rem_euclid(ONE_TURN);
            let first = ahead + ((distance - ahead) / ONE_TURN).ceil() * ONE_TURN;
            let (over, spare) = (
                moved as f64 - ramp - (first - distance) / speed,
                (first - distance) / speed,
            );
            let end = watched.last();
            assert_eq!(
                (end.state, end.phase.within_turn().to_bits() as f64),
                (Parked, park)
            );
            // If that phase is nearer than a ramp of whole ticks can reach, the stop is at the next passage.
            let late = if spare <= 2.0 { ONE_TURN / speed } else { 0.0 };
            assert!(
                (-2.01..=2.01 + late).contains(&over),
                "{axes} {drive}s at {at_s} s: {over}"
            );
        }
    });
}
