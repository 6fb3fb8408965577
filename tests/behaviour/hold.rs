//! The commands `hold` and `resume`.
//!
//! Unit tests: `firmware/core/src/supervisor/tests.rs`.

use cophase_core::supervisor::State::{Homing, Parked, Run, Stop};
use cophase_tests::Tick;
use cophase_tests::scripted::{command, program, scripted, stands_at_park_phase};

/// If this fails, a hold loses a piece of the program, or does not hold.
#[test]
fn hold_keeps_the_speed_and_the_place_in_the_program() {
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
