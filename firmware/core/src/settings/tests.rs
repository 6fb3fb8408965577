//! Refusal of bad settings, and use of accepted ones.

use super::sample::{LEVEL, settings};
use super::*;
use crate::program::SegmentSettings;
use heapless::Vec;
use std::string::ToString;

fn refused(settings: &Settings) -> std::string::String {
    settings.controller().unwrap_err().to_string()
}

/// If this were wrong, firmware would run another program than the given one.
#[test]
fn the_program_is_the_given_one() {
    let controller = settings(3).controller().unwrap();
    assert_eq!(controller.program().0.duration(), 3 * 3 * 2000);
}

#[test]
fn a_number_of_axes_out_of_range_is_refused() {
    let mut none = settings(1);
    assert_eq!(none.controller().unwrap().axis_count(), 1);
    none.axes.clear();
    assert_eq!(refused(&none), "axes.count: 0 is outside 1 to 6");
}

#[test]
fn errors_name_their_entry() {
    let mut broken = settings(2);
    broken.limits.speed_hz = f64::NAN;
    assert!(refused(&broken).starts_with("limits.speed_hz: NaN"));

    let mut broken = settings(2);
    broken.axes[1].steps_per_turn = 3;
    assert!(refused(&broken).starts_with("axes.steps_per_turn (number 1): 3 is outside"));

    let mut broken = settings(2);
    let high = SegmentSettings {
        amax_mps2: -1.0,
        ..LEVEL
    };
    broken.program.push(EntrySettings::Segment(high)).unwrap();
    assert!(refused(&broken).starts_with("program.amax_mps2 (number 2): -1 m/s² is outside"));

    let mut broken = settings(2);
    broken.program[1] = EntrySettings::Repeat { first: 1, times: 3 };
    assert!(refused(&broken).starts_with("program.segments (number 1): the repeat block is empty"));

    let mut broken = settings(2);
    broken.program.clear();
    assert!(refused(&broken).starts_with("program: the program has no segments"));
}

#[test]
fn trims_are_set_within_their_limit() {
    let mut trimmed = settings(2);
    for trim_deg in [5.0, -5.0, 0.1] {
        trimmed.trims_turns = Vec::from_array([0.0, trim_deg / 360.0]);
        trimmed.controller().unwrap();
    }
    for (trim_deg, said) in [
        (5.001, "5.001° is outside -5 to 5°"),
        (f64::NAN, "NaN° is outside"),
    ] {
        trimmed.trims_turns = Vec::from_array([0.0, trim_deg / 360.0]);
        let whole = refused(&trimmed);
        assert!(
            whole.starts_with(&std::format!("axes.trim_deg (number 1): {said}")),
            "{whole}"
        );
    }
    trimmed.trims_turns = Vec::from_array([0.0, 0.0, 0.01]);
    assert!(
        refused(&trimmed).starts_with("axes.trim_deg (number 2)"),
        "an axis that is not there"
    );
}

#[test]
fn a_long_name_is_cut_between_characters() {
    assert_eq!(short_name("default"), "default");
    assert_eq!(short_name(&"ü".repeat(20)).len(), NAME_BYTES);
    assert_eq!(
        short_name(&std::format!("a{}", "ü".repeat(20))).len(),
        NAME_BYTES - 1
    );
}

/// If it were accepted, a machine whose clock nobody set would step at a wrong rate.
#[test]
fn a_clock_without_whole_ticks_is_refused() {
    let mut clocked = settings(2);
    for clock_hz in [125_000_000, 48_000_000] {
        clocked.clock_hz = clock_hz;
        clocked.controller().unwrap();
        assert_eq!(clocked.tick_cycles(), clock_hz / 2000);
    }
    for clock_hz in [Settings::new().clock_hz, 125_000_001] {
        clocked.clock_hz = clock_hz;
        let said = refused(&clocked);
        assert!(said.starts_with("clock_hz: "), "{said}");
        assert!(said.contains(&std::format!("{clock_hz} Hz")), "{said}");
    }
}
