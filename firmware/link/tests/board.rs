//! Settings that the board accepts. `tests/emulator/run cost` shows that it can run them.

mod support;

use cophase_core::settings::DriveKind;
use cophase_link::Settings;
use cophase_link::board::{Unfit, check};
use support::settings;

fn steppers(axes: usize, tick_hz: u32, steps_per_turn: u32) -> Settings {
    let mut settings = settings(axes, 0, 1);
    settings.tick_hz = tick_hz;
    for axis in &mut settings.axes {
        axis.drive = DriveKind::Stepper;
        axis.steps_per_turn = steps_per_turn;
    }
    settings
}

/// Highest tick rate, Hz, that settings and board accept.
fn most_hz(axes: usize, steps_per_turn: u32) -> u32 {
    match check(&steppers(axes, 10_000, steps_per_turn)) {
        Ok(()) => 10_000,
        Err(Unfit::TickTooShort {
            tick_hz: 10_000,
            axes: given,
            most_hz,
        }) if given == axes => most_hz,
        Err(other) => panic!("{axes} axes: {other}"),
    }
}

#[test]
fn the_rate_that_is_named_is_the_highest_that_is_accepted() {
    let rates = |above: u32| (above + 1..=10_000).filter(|hz| 1_000_000 % hz == 0);
    for axes in 2..=6 {
        for steps_per_turn in [200, 3200, 50_000] {
            let most = most_hz(axes, steps_per_turn);
            assert_eq!(check(&steppers(axes, most, steps_per_turn)), Ok(()));
            for hz in rates(most) {
                assert!(
                    check(&steppers(axes, hz, steps_per_turn)).is_err(),
                    "{hz} Hz"
                );
            }
        }
    }
}

/// If this were wrong, the usual rate would be refused, or a machine accepted that misses every second deadline.
#[test]
fn more_axes_and_more_steps_leave_less_room() {
    for axes in 2..=6 {
        assert!(most_hz(axes, 3200) >= 2000, "{axes} axes");
        assert!(most_hz(axes, 50_000) <= most_hz(axes, 200), "{axes} axes");
    }
    assert!(most_hz(6, 50_000) < most_hz(2, 50_000));
    assert!(most_hz(6, 3200) < 10_000);
}

#[test]
fn the_first_servo_that_takes_setpoints_is_named() {
    let mut settings = steppers(4, 2000, 3200);
    settings.axes[1].drive = DriveKind::PulseServo;
    assert_eq!(check(&settings), Ok(()));
    settings.axes[2].drive = DriveKind::Servo;
    settings.axes[3].drive = DriveKind::Servo;
    assert_eq!(check(&settings), Err(Unfit::Servo(2)));
}

/// If it were accepted, the loop would report a motor as stuck whose encoder nobody reads.
#[test]
fn the_first_encoder_is_named() {
    let mut settings = steppers(4, 2000, 3200);
    settings.axes[1].encoder = true;
    assert_eq!(check(&settings), Err(Unfit::Encoder(1)));
    let said = Unfit::Encoder(1).to_string();
    assert!(said.starts_with("axis 1 has an encoder"), "{said}");
}
