//! Refusal of bad settings, and use of accepted ones.

use super::sample::{LEVEL, settings};
use super::*;
use crate::axes::CamTableSettings;
use crate::program::SegmentSettings;
use heapless::Vec;
use std::string::ToString;

fn refused(settings: &Settings) -> std::string::String {
    settings.controller().unwrap_err().to_string()
}

/// If this fails, firmware runs another program than the given one.
#[test]
fn the_controller_runs_the_program_of_its_settings() {
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

/// If this fails, bring-up turns another crank, or none.
#[test]
fn keep_axis_keeps_the_settings_of_one_axis() {
    for number in 0..MAX_AXES {
        let mut kept = settings(MAX_AXES);
        kept.correction.prove_wiring = true;
        for (i, axis) in kept.axes.iter_mut().enumerate() {
            axis.steps_per_turn = 3200 + i as u32;
        }
        let axis = kept.axes[number];
        assert!(kept.keep_axis(number));
        assert_eq!(kept.axes, [axis]);
        let controller = kept.controller().unwrap();
        assert_eq!(controller.axis_count(), 1);
        assert_eq!(controller.program().0.duration(), 200);
    }
    let mut three = settings(3);
    assert!(!three.keep_axis(3));
    assert_eq!(three, settings(3));
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
    sample::platform(&mut trimmed).allow_commanded_tilt = true;
    for trim_deg in [5.0, -5.0, 0.1] {
        trimmed.trims_turns = Vec::from_array([0.0, trim_deg / 360.0]);
        trimmed.controller().unwrap();
    }
    for (trim_deg, said) in [
        (5.001, "5.001° is outside -5 to 5°"),
        (
            f64::NAN,
            "NaN is not a finite number; give one from -5 to 5°",
        ),
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

/// Settings of two axes, of which the second follows a table through these points.
fn on_a_cam(net_turns: i32, points_turns: &[f64]) -> Settings {
    let mut settings = settings(2);
    settings.machine = MachineSettings::Shafts(ShaftSettings { length_m: 0.02 });
    settings.cams = heapless::Vec::from_array([CamSettings {
        net_turns,
        max_speed_hz: 1000.0,
        max_acceleration_hz_per_s: 1e6,
        points_turns: points_turns.iter().copied().collect(),
    }]);
    settings.axes[1].follower = FollowerSettings::CamTable(CamTableSettings {
        table: 0,
        shift_turns: 0.0,
    });
    settings.axes[1].index_turns = None;
    settings
}

/// If this fails, an axis follows no table, or one that no motor can follow.
#[test]
fn bad_cam_tables_are_refused_with_their_key() {
    let lift = [0.0, 1.0, 2.0, 1.0];
    on_a_cam(0, &lift).controller().unwrap();

    let short = on_a_cam(0, &lift[..3]);
    assert_eq!(
        refused(&short),
        "cam_table.points (number 0): 3 is outside 4 to 96"
    );
    let infinite = on_a_cam(0, &[0.0, 1.0, f64::NAN, 1.0]);
    assert!(refused(&infinite).starts_with("cam_table.points (number 0): NaN is not a finite"));
    let mut missing = on_a_cam(0, &lift);
    missing.cams.clear();
    assert!(refused(&missing).starts_with("axes.cam (number 1): there is no table 0"));
    let steep = on_a_cam(0, &[0.0, 0.0, 500.0, 0.0]);
    assert!(refused(&steep).starts_with("cam_table.points (number 0): the table is too steep"));

    // The steepest part is 2 turns in half a turn of the master, half as much again at the middle: 20 rev/s make 120 rev/s. At 3200 steps a
    // turn that is 384,000 steps/s, and pulses of 400 ns and the guard leave some 700,000.
    let mut fast = on_a_cam(0, &lift);
    fast.controller().unwrap();
    fast.axes[1].steps_per_turn = 12_800;
    let said = refused(&fast);
    assert!(
        said.starts_with("axes.cam (number 1): at limits.speed_hz = 20 rev/s the table"),
        "{said}"
    );
    fast.axes[1].steps_per_turn = 50_000;
    fast.axes[1].drive = DriveKind::Servo;
    fast.controller().unwrap();
}

/// If this fails, a table whose net travel was forgotten is accepted, and the axis flies back within one step of the table.
#[test]
fn a_table_without_its_net_travel_is_refused_with_the_one_it_fits() {
    let line = |count: usize, turns: f64| -> std::vec::Vec<f64> {
        let place = |i: usize| turns * i as f64 / count as f64;
        // As a file gives it, with six decimals.
        (0..count)
            .map(|i| libm::round(place(i) * 1e6) / 1e6)
            .collect()
    };
    let indexing = |count: usize| -> std::vec::Vec<f64> {
        let cycloid = |u: f64| u - libm::sin(core::f64::consts::TAU * u) / core::f64::consts::TAU;
        // A turn over a third of the master's, then a rest.
        (0..count)
            .map(|i| cycloid((3.0 * i as f64 / count as f64).min(1.0)))
            .collect()
    };
    for (given, meant, points) in [
        (0, 4, line(36, 4.0)),
        (0, 1, line(4, 1.0)),
        (1, -2, line(96, -2.0)),
        (7, 900, line(96, 900.0)),
        (0, 1, indexing(96)),
        (0, 1, indexing(24)),
    ] {
        let said = refused(&on_a_cam(given, &points));
        assert!(
            said.starts_with("cam_table.net_turns (number 0): the table jumps by "),
            "{said}"
        );
        let question = std::format!("did you mean net_turns = {meant}?");
        assert!(said.contains(&question), "{said}");
        let mut corrected = on_a_cam(meant, &points);
        corrected.limits.speed_hz = 0.1;
        corrected.limits.homing_speed_hz = 0.1;
        corrected.program[0] = EntrySettings::Segment(SegmentSettings {
            amax_mps2: 0.001,
            ..LEVEL
        });
        corrected.axes[1].steps_per_turn = 200;
        corrected.check().unwrap();
    }
}

/// If this fails, a table is refused as one that jumps, although it comes back as steeply elsewhere, or over several points.
#[test]
fn tables_that_come_back_steeply_have_no_jump() {
    for points in [
        &[0.0, 1.0, 2.0, 1.0][..],
        &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0],
        &[0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 4.0, 2.0],
        &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 4.0, 2.0],
        &[0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.3],
    ] {
        on_a_cam(0, points).check().unwrap();
    }
}

/// If this fails, a table moves an axis faster, or accelerates it harder, than its motor can.
///
/// The table is y = 0.5 sin 2πx in 96 points. The spline's slope is within 1e-6 of π, and its second derivative within (2π/96)²/12 = 4e-4
/// of 2π². At 20 rev/s the axis reaches 20 π = 62.83 rev/s, and π times the shaft's acceleration, 20 rev/s², beyond 800 π² = 7,896 rev/s².
#[test]
fn a_table_keeps_to_the_limits_of_its_axes() {
    let points: std::vec::Vec<f64> = (0..96)
        .map(|i| 0.5 * libm::sin(core::f64::consts::TAU * f64::from(i) / 96.0))
        .collect();
    let mut limited = on_a_cam(0, &points);
    limited.cams[0].max_speed_hz = 62.9;
    limited.cams[0].max_acceleration_hz_per_s = 7990.0;
    limited.check().unwrap();
    limited.cams[0].max_speed_hz = 62.8;
    let said = refused(&limited);
    assert!(
        said.starts_with("cam_table.max_speed_hz (number 0): at limits.speed_hz = 20 rev/s the table moves its axes at up to 62.83 rev/s"),
        "{said}"
    );
    limited.cams[0].max_speed_hz = 62.9;
    limited.cams[0].max_acceleration_hz_per_s = 7890.0;
    let said = refused(&limited);
    assert!(
        said.starts_with("cam_table.max_acceleration_hz_per_s (number 0): at limits.speed_hz = 20 rev/s the table accelerates its axes by up to 79"),
        "{said}"
    );
    limited.cams[0].max_acceleration_hz_per_s = f64::NAN;
    assert!(
        refused(&limited).contains("NaN is not a finite"),
        "{}",
        refused(&limited)
    );
}

/// If this fails, an index is accepted where the axis turns back over its flag, and its pulses stop a sound machine.
#[test]
fn an_index_requires_a_table_that_rises_one_turn() {
    for (net_turns, points, accepted) in [
        (1, [0.0, 0.3, 0.5, 0.7], true),
        (0, [0.0, 0.3, 0.5, 0.3], false),
        (1, [0.0, 0.6, 0.4, 0.7], false),
        (2, [0.0, 0.5, 1.0, 1.5], false),
        (-1, [0.0, -0.25, -0.5, -0.75], false),
    ] {
        let mut settings = on_a_cam(net_turns, &points);
        settings.controller().unwrap();
        settings.axes[1].index_turns = Some(0.0);
        match settings.controller() {
            Ok(_) => assert!(accepted, "{points:?}"),
            Err(error) => {
                assert!(!accepted, "{points:?}: {error}");
                let said = error.to_string();
                assert!(
                    said.starts_with("axes.index (number 1): the axis does not pass"),
                    "{said}"
                );
                assert!(said.contains("index = false"), "{said}");
            }
        }
    }
}

/// If this fails, a machine whose clock was not set makes steps at a wrong rate.
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
