//! Conformance tests: each test checks one property of every board. `tests/emulator/run deadlines` shows that a board can run the
//! settings that it accepts.

use std::ops::Range;

use crate::support::{self, settings};
use cophase_core::settings::{AxisSettings, DriveKind};
use cophase_core::units::MAX_AXES;
use cophase_link::Settings;
use cophase_link::board::{AnyBoard, BOARDS, Board, Rp2040, Unfit, check};

/// A board that does not exist: with another clock and another cost, four axes, and encoder inputs for the first two.
struct Fictitious;

impl Board for Fictitious {
    const NAME: &'static str = "fictitious";
    const CLOCK_HZ: u32 = 48_000_000;
    const MAX_AXES: usize = 4;
    const MIN_LEAD_US: u32 = 25;

    fn check_axis(number: usize, axis: &AxisSettings) -> Result<(), Unfit> {
        if axis.drive == DriveKind::Servo {
            return Err(Unfit::Servo(number));
        }
        if axis.encoder && number >= 2 {
            return Err(Unfit::Encoder(number));
        }
        Ok(())
    }

    fn tick_cycles(settings: &Settings, tick_hz: u32) -> f64 {
        let step_cycles = |axis: &AxisSettings| {
            let steps_hz = settings.limits.speed_hz * f64::from(axis.steps_per_turn);
            900.0 + 5.0 * steps_hz / f64::from(tick_hz)
        };
        3000.0 + settings.axes.iter().map(step_cycles).sum::<f64>()
    }
}

/// The boards of the list, and one that exists only here. No test can rely on a property that only one of them has.
fn boards() -> impl Iterator<Item = AnyBoard> {
    let fictitious = AnyBoard::of::<Fictitious>();
    BOARDS.iter().copied().chain([fictitious])
}

/// Tick rates that settings can have, from the highest down, Hz.
fn rates() -> impl Iterator<Item = u32> {
    (500..=10_000).rev().filter(|hz| 1_000_000 % hz == 0)
}

const STEPS_PER_TURN: [u32; 3] = [200, 3200, 50_000];

fn steppers(axes: usize, tick_hz: u32, steps_per_turn: u32) -> Settings {
    let mut settings = settings(axes, 0, 1);
    settings.tick_hz = tick_hz;
    for axis in &mut settings.axes {
        axis.drive = DriveKind::Stepper;
        axis.steps_per_turn = steps_per_turn;
    }
    settings
}

/// Highest tick rate, Hz, that the board accepts.
fn max_hz(board: AnyBoard, axes: usize, steps_per_turn: u32) -> u32 {
    match (board.check)(&steppers(axes, 10_000, steps_per_turn)) {
        Ok(()) => 10_000,
        Err(Unfit::TickTooShort {
            tick_hz: 10_000,
            axes: given,
            max_hz,
        }) if given == axes => max_hz,
        Err(other) => panic!("{}, {axes} axes: {other}", board.name),
    }
}

/// If this fails, the message names a wrong tick rate. With a lower one users lose speed, and the board refuses a higher one too.
#[test]
fn the_message_names_the_highest_accepted_tick_rate() {
    for board in boards() {
        for axes in 1..=board.max_axes {
            for steps_per_turn in STEPS_PER_TURN {
                let max = max_hz(board, axes, steps_per_turn);
                for hz in rates() {
                    let accepted = (board.check)(&steppers(axes, hz, steps_per_turn)).is_ok();
                    let said = format!("{}, {axes} axes, {hz} of {max} Hz", board.name);
                    assert_eq!(accepted, hz <= max, "{said}");
                }
            }
        }
    }
}

/// If this fails, the usual rate is refused, or a machine is accepted that misses every second deadline.
#[test]
fn more_axes_or_steps_lower_the_highest_tick_rate() {
    for board in boards() {
        let max = |axes, steps_per_turn| max_hz(board, axes, steps_per_turn);
        for axes in 1..=board.max_axes {
            let rates_hz = STEPS_PER_TURN.map(|steps_per_turn| max(axes, steps_per_turn));
            assert!(rates_hz.is_sorted_by(|less, more| less >= more));
            assert!(max(axes, 3200) >= 2000, "{}, {axes} axes", board.name);
            for steps_per_turn in STEPS_PER_TURN.into_iter().filter(|_| axes > 1) {
                assert!(max(axes, steps_per_turn) <= max(axes - 1, steps_per_turn));
            }
        }
        let (last, steps) = (board.max_axes, STEPS_PER_TURN[2]);
        assert!(max(last, steps) < max(1, steps), "{}", board.name);
    }
}

/// If this fails, the bound leaves out work that only some settings request. Their longest tick then misses a deadline.
#[test]
fn work_that_settings_request_lengthens_the_longest_tick() {
    let longest = |change: fn(&mut Settings)| {
        let mut settings = steppers(6, 2000, 3200);
        change(&mut settings);
        Rp2040::tick_cycles(&settings, 2000)
    };
    let alike = longest(|_| {});
    let faster = longest(|settings| settings.limits.speed_hz *= 2.0);
    assert!(faster > alike);
    let offset_faster = longest(|settings| settings.axes[5].trim_rate_hz *= 10.0);
    assert!(offset_faster > alike);
    let fractions = longest(|settings| {
        for axis in &mut settings.axes {
            (axis.gear.motor_turns, axis.gear.crank_turns) = (999, 1000);
        }
    });
    assert!(fractions > alike);
    let proof = longest(|settings| settings.correction.prove_wiring = true);
    assert!(proof > alike);
    let corrected = |settings: &mut Settings| {
        settings.axes[0].gear.crank_turns = 999;
        settings.correction.gain = 0.5;
    };
    let without = |settings: &mut Settings| settings.axes[0].gear.crank_turns = 999;
    assert!(longest(corrected) > longest(without));
}

/// If this fails, ticks of hardware and timer drift apart, or the controller refuses settings that the board accepts.
#[test]
fn a_tick_has_whole_cycles_of_the_clock() {
    for board in boards() {
        for hz in rates() {
            let mut settings = steppers(1, hz, 200);
            if (board.check)(&settings).is_ok() {
                settings.clock_hz = board.clock_hz;
                assert_eq!(support::check(&settings), Ok(()), "{}, {hz} Hz", board.name);
                assert_eq!(settings.tick_cycles() * hz, board.clock_hz);
            }
        }
    }
}

/// If this fails, the message names another axis, or none, and a user cannot find the setting to change.
#[test]
fn the_first_axis_that_the_board_cannot_run_is_named() {
    for board in boards() {
        for drive in [DriveKind::Stepper, DriveKind::PulseServo, DriveKind::Servo] {
            for encoder in [false, true] {
                let axes = board.max_axes;
                let with = |numbers: Range<usize>| {
                    let mut settings = steppers(axes, 500, 200);
                    for axis in &mut settings.axes[numbers] {
                        (axis.drive, axis.encoder) = (drive, encoder);
                    }
                    (board.check)(&settings)
                };
                for first in 0..axes {
                    let mut alone = (first..axes).map(|number| with(number..number + 1));
                    let expected = alone.find(Result::is_err).unwrap_or(Ok(()));
                    assert_eq!(with(first..axes), expected, "{}", board.name);
                    if let Err(unfit) = with(first..first + 1) {
                        let said = unfit.to_string();
                        assert!(said.starts_with(&format!("axis {first} ")), "{said}");
                    }
                }
            }
        }
    }
}

/// If this fails, the steps of some axes have no pins.
#[test]
fn too_many_axes_are_refused() {
    for board in boards() {
        let max = board.max_axes;
        assert_eq!((board.check)(&steppers(max, 500, 200)), Ok(()));
        if let axes @ ..=MAX_AXES = max + 1 {
            let refused = (board.check)(&steppers(axes, 500, 200));
            assert_eq!(refused, Err(Unfit::TooManyAxes { axes, max }));
        }
    }
}

/// Capabilities of each board, beside its conformance. If this fails, a board accepts an encoder that it does not read, and the loop
/// reports its motor as stuck.
#[test]
fn each_board_has_its_own_capabilities() {
    let mut settings = steppers(4, 500, 200);
    settings.axes[0].drive = DriveKind::PulseServo;
    settings.axes[1].encoder = true;
    assert_eq!(check::<Rp2040>(&settings), Err(Unfit::Encoder(1)));
    assert_eq!(check::<Fictitious>(&settings), Ok(()));
    settings.axes[2].encoder = true;
    assert_eq!(check::<Fictitious>(&settings), Err(Unfit::Encoder(2)));
    settings.axes[1].encoder = false;
    settings.axes[1].drive = DriveKind::Servo;
    assert_eq!(check::<Rp2040>(&settings), Err(Unfit::Servo(1)));
    assert_eq!(check::<Fictitious>(&settings), Err(Unfit::Servo(1)));
}
