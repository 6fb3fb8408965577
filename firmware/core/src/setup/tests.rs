use super::*;
use crate::program::{SegmentSettings, Shape};
use crate::settings::{DriveKind, Platform};
use std::string::ToString;

const AXIS: AxisSettings = AxisSettings {
    drive: DriveKind::Stepper,
    steps_per_turn: 3200,
    reversed: false,
    ratio: (1, 1),
    offset_turns: 0.0,
    index_turns: Some(0.0),
    index_width_turns: 0.0,
    index_delay_s: 0.0,
    encoder: false,
    cycle_steps: 0,
    trim_limit_turns: 5.0 / 360.0,
    trim_rate_hz: 1.0 / 360.0,
    rotor_inertia_kgm2: 0.0,
};

const LEVEL: SegmentSettings = SegmentSettings {
    amax_mps2: 100.0,
    ramp_s: 1.0,
    hold_s: 2.0,
    shape: Shape::Smooth,
};

fn setup(axes: usize) -> Setup {
    Setup {
        index: IndexSettings { width_us: 2.0 },
        name: short_name("bench"),
        tick_hz: 2000,
        machine: MachineSettings {
            crank_radius_m: 0.02,
            lambda: 0.3,
            load_kg: 5.0,
            platform: Platform::Above,
            gravity_mps2: 9.80665,
            mount_radius_m: 0.25,
        },
        limits: LimitSettings {
            speed_hz: 20.0,
            acceleration_hz_per_s: 20.0,
            jerk_hz_per_s2: 200.0,
            stop_acceleration_hz_per_s: 20.0,
            stop_jerk_hz_per_s2: 200.0,
            creep_hz: 1.0,
            bands: Vec::new(),
        },
        pulse: PulseSettings {
            width_ns: 400.0,
            dir_setup_ns: 500.0,
            dir_hold_ns: 500.0,
        },
        axes: core::iter::repeat_n(AXIS, axes).collect(),
        trims_turns: Vec::new(),
        drift: DriftSettings {
            tilt_limit_mrad: 3.0,
            warp_limit_deg: 3.0,
            common_limit_deg: 15.0,
            reading_deg: 0.25,
            lag_s: 0.0,
        },
        correction: CorrectionSettings::NONE,
        park_turns: 0.5,
        settle_s: 0.1,
        program: Vec::from_array([
            EntrySettings::Segment(LEVEL),
            EntrySettings::Repeat { first: 0, times: 3 },
        ]),
    }
}

fn refused<const N: usize>(setup: &Setup) -> std::string::String {
    setup.controller::<N>().unwrap_err().to_string()
}

/// Were it wrong, an image would run another program than the one it was given.
#[test]
fn the_program_is_the_one_that_is_told() {
    let controller = setup(3).controller::<3>().unwrap();
    assert_eq!(controller.program().0.duration(), 3 * 3 * 2000);
}

/// Were it wrong, a setup of another machine would move this one, or panic on the board.
#[test]
fn another_number_of_axes_is_refused() {
    for axes in [2, 4, 5, 6] {
        let said = refused::<3>(&setup(axes));
        assert!(said.starts_with("axes.count: "), "{said}");
        assert!(
            said.contains(&std::format!("settings of {axes} axes")),
            "{said}"
        );
        assert!(said.contains("loop of 3"), "{said}");
    }
    for axes in [0, 1] {
        let said = refused::<2>(&setup(axes));
        assert_eq!(said, std::format!("axes.count: {axes} is outside 2 to 6"));
    }
}

#[test]
fn what_is_wrong_is_said_of_its_entry() {
    let mut broken = setup(2);
    broken.limits.speed_hz = f64::NAN;
    assert!(refused::<2>(&broken).starts_with("limits.speed_hz: NaN"));

    let mut broken = setup(2);
    broken.axes[1].steps_per_turn = 3;
    assert!(refused::<2>(&broken).starts_with("axes.steps_per_turn (number 1): 3 is outside"));

    let mut broken = setup(2);
    let high = SegmentSettings {
        amax_mps2: -1.0,
        ..LEVEL
    };
    broken.program.push(EntrySettings::Segment(high)).unwrap();
    assert!(refused::<2>(&broken).starts_with("program.amax_mps2 (number 2): -1 m/s² is outside"));

    let mut broken = setup(2);
    broken.program[1] = EntrySettings::Repeat { first: 1, times: 3 };
    assert!(
        refused::<2>(&broken).starts_with("program.segments (number 1): the repeat block is empty")
    );

    let mut broken = setup(2);
    broken.program.clear();
    assert!(refused::<2>(&broken).starts_with("program: the program has no segments"));
}

#[test]
fn trims_are_set_within_their_limit() {
    let mut trimmed = setup(2);
    for trim_deg in [5.0, -5.0, 0.1] {
        trimmed.trims_turns = Vec::from_array([0.0, trim_deg / 360.0]);
        trimmed.controller::<2>().unwrap();
    }
    for (trim_deg, said) in [
        (5.001, "5.001° is outside -5 to 5°"),
        (f64::NAN, "NaN° is outside"),
    ] {
        trimmed.trims_turns = Vec::from_array([0.0, trim_deg / 360.0]);
        let whole = refused::<2>(&trimmed);
        assert!(
            whole.starts_with(&std::format!("axes.trim_deg (number 1): {said}")),
            "{whole}"
        );
    }
    trimmed.trims_turns = Vec::from_array([0.0, 0.0, 0.01]);
    assert!(
        refused::<2>(&trimmed).starts_with("axes.trim_deg (number 2)"),
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
