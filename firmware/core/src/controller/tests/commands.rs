//! Commands of a host: homing, jogs, immediate stops, the override, another program.

use super::*;
use crate::mechanism::Mechanism as _;
use crate::supervisor::{JOG_S, RefusalReason};

/// If this fails, a host cannot home a machine without also starting its program.
#[test]
fn a_command_to_home_ends_parked_and_a_start_then_runs() {
    let mut settings = settings();
    for axis in &mut settings.axes {
        axis.index_turns = None;
    }
    let mut controller = controller(&settings, 100.0);
    play(&mut controller, Some(Command::Home), 6000, false);
    let telemetry = &controller.output.telemetry;
    assert_eq!(
        (telemetry.state, telemetry.program_ticks),
        (State::Parked, 0)
    );
    assert!(telemetry.homed);
    play(&mut controller, Some(Command::Start), 100, false);
    assert_eq!(controller.output.telemetry.state, State::Run);
}

/// If this fails, a machine keeps turning after its operator has gone.
#[test]
fn a_jog_turns_at_homing_speed_and_ends_unless_it_is_repeated() {
    let mut controller = running(100.0);
    play(&mut controller, Some(Command::Stop), 6000, false);
    assert_eq!(controller.output.telemetry.state, State::Parked);
    let program_ticks = controller.output.telemetry.program_ticks;
    let jog = JOG_S * f64::from(HZ);
    for _ in 0..4 {
        play(&mut controller, Some(Command::Jog), jog as u32 - 1, false);
        assert_eq!(controller.output.telemetry.state, State::Run);
    }
    let speed_hz = controller.output.telemetry.motion.speed.to_num::<f64>() * f64::from(HZ);
    let homing_hz = settings().limits.homing_speed_hz;
    assert!((speed_hz - homing_hz).abs() < 1e-6, "{speed_hz} rev/s");
    play(&mut controller, None, 6000, false);
    let telemetry = &controller.output.telemetry;
    assert_eq!(telemetry.state, State::Parked);
    assert_eq!(
        telemetry.program_ticks, program_ticks,
        "the program went on"
    );
}

/// If this fails, an immediate stop still waits for the parking phase and takes longer than needed.
#[test]
fn an_immediate_stop_is_shorter_than_a_parking_stop() {
    let ticks_to_park = |command| {
        let mut controller = running(100.0);
        play(&mut controller, None, 3000, false);
        let mut ticks = 0;
        play(&mut controller, Some(command), 1, false);
        while controller.output.telemetry.state != State::Parked {
            play(&mut controller, None, 1, false);
            ticks += 1;
            assert!(ticks < 20_000, "it never parks");
        }
        // The machine stays where it stopped.
        let phase = controller.output.telemetry.phase;
        play(&mut controller, None, 1000, false);
        assert_eq!(controller.output.telemetry.phase, phase);
        ticks
    };
    let (now, at_phase) = (
        ticks_to_park(Command::StopNow),
        ticks_to_park(Command::Stop),
    );
    assert!(now < at_phase, "{now} ticks, and {at_phase} at the phase");
}

/// If this fails, an override gives another amplitude than the one the operator set.
#[test]
fn an_override_scales_the_amplitude() {
    let mut controller = running(40.0);
    play(&mut controller, None, 1500, false);
    let amax = |controller: &Controller| {
        let telemetry = &controller.output.telemetry;
        let commanded = controller.mechanism().amax(telemetry.motion.speed);
        (
            telemetry.amax_requested.to_num::<f64>(),
            commanded.to_num::<f64>(),
        )
    };
    for (permille, expected) in [(500, 20.0), (1200, 48.0), (1000, 40.0)] {
        play(
            &mut controller,
            Some(Command::Override(permille)),
            2200,
            false,
        );
        let (requested, commanded) = amax(&controller);
        assert!(
            (requested - expected).abs() < 1e-6,
            "{permille}: {requested}"
        );
        assert!(
            (commanded - expected).abs() < 1e-3,
            "{permille}: {commanded}"
        );
        assert_eq!(controller.output.telemetry.override_permille, permille);
    }
}

/// If this fails, a program can change while the machine moves, or begins in the middle.
#[test]
fn a_program_is_loaded_while_the_machine_rests() {
    let mut other = crate::program::Program::new();
    let settings = settings();
    let mut builder = settings.program_builder(&mut other);
    let segment = crate::program::SegmentSettings {
        amax_mps2: 30.0,
        ramp_s: 1.0,
        hold_s: 1.0,
        shape: crate::program::Shape::Linear,
    };
    builder.segment(segment).unwrap();
    builder.finish().unwrap();
    let mut controller = running(100.0);
    assert!(!controller.load_program(&other));
    play(&mut controller, Some(Command::Stop), 6000, false);
    assert!(controller.load_program(&other));
    let (program, cursor) = controller.program();
    assert_eq!(
        (program.duration(), cursor.elapsed()),
        (2 * u64::from(HZ), 0)
    );
    play(&mut controller, Some(Command::Start), 3 * HZ / 2, false);
    let requested: f64 = controller.output.telemetry.amax_requested.to_num();
    assert!((requested - 30.0).abs() < 1e-9, "{requested}");
}

/// Returns the reason why a command was refused in the next tick, if it was.
fn reason(controller: &mut Controller, command: Command) -> Option<RefusalReason> {
    play(controller, Some(command), 1, false);
    let refused = controller.output.telemetry.refused?;
    assert_eq!(refused.command, command);
    Some(refused.reason)
}

/// If this fails, an operator who jogs a machine whose homing was interrupted waits for a motion that never comes.
#[test]
fn a_jog_after_an_interrupted_homing_is_refused() {
    let mut controller = controller(&sample::settings(2), 2.0);
    play(&mut controller, Some(Command::Home), 100, false);
    play(&mut controller, Some(Command::StopNow), 6000, false);
    let telemetry = &controller.output.telemetry;
    assert_eq!((telemetry.state, telemetry.homed), (State::Parked, false));
    assert_eq!(
        reason(&mut controller, Command::Jog),
        Some(RefusalReason::NotHomed)
    );
    assert_eq!(controller.output.telemetry.state, State::Parked);
}

/// If this fails, a jog while a program runs seems to be obeyed, or a hold while the machine jogs.
#[test]
fn a_jog_in_a_program_and_a_hold_in_a_jog_are_refused() {
    let mut controller = running(100.0);
    assert_eq!(
        reason(&mut controller, Command::Jog),
        Some(RefusalReason::ProgramRuns)
    );
    assert_eq!(reason(&mut controller, Command::Hold), None);
    assert_eq!(
        reason(&mut controller, Command::Home),
        Some(RefusalReason::State)
    );
    play(&mut controller, Some(Command::Stop), 6000, false);
    assert_eq!(reason(&mut controller, Command::Jog), None);
    assert_eq!(
        reason(&mut controller, Command::Hold),
        Some(RefusalReason::Jogs)
    );
    play(&mut controller, None, 1, false);
    assert_eq!(
        controller.output.telemetry.refused, None,
        "an event of one tick"
    );
}
