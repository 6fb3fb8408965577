//! Tests of a whole tick, for effects that unit tests of its parts cannot show.

mod commands;

use super::*;
use crate::axes::FollowerSettings;
use crate::monitor::IndexPulse;
use crate::program::{EntrySettings, SegmentSettings, Shape};
use crate::settings::{
    BandSettings, DriveKind, LimitSettings, MachineSettings, Settings, ShaftSettings, sample,
};
use crate::signals::Feedback;
use crate::supervisor::{Command, State};

const HZ: u32 = 2000;

/// Shafts without a platform: a servo, and a servo that is reversed and geared down.
fn settings() -> Settings {
    let mut settings = sample::settings(2);
    for axis in &mut settings.axes {
        axis.drive = DriveKind::Servo;
        axis.steps_per_turn = 4096;
        axis.cycle_steps = 0;
        axis.trim_limit_turns = 0.01;
        axis.trim_rate_hz = 0.01;
        axis.rotor_inertia_kgm2 = 1e-3;
    }
    settings.axes[1].reversed = true;
    settings.axes[1].follower = FollowerSettings::gear((1, 2));
    settings.machine = MachineSettings::Shafts(ShaftSettings { length_m: 0.026 });
    settings.limits = LimitSettings {
        speed_hz: 20.0,
        acceleration_hz_per_s: 40.0,
        jerk_hz_per_s2: 1000.0,
        stop_acceleration_hz_per_s: 40.0,
        stop_jerk_hz_per_s2: 1000.0,
        homing_speed_hz: 5.0,
        bands: [BandSettings {
            from_hz: 8.0,
            to_hz: 10.0,
        }]
        .into_iter()
        .collect(),
    };
    settings.settle_s = 0.0;
    settings
}

/// A controller with a program of one ramp to `amax_mps2`.
fn controller(settings: &Settings, amax_mps2: f64) -> Controller {
    let mut settings = settings.clone();
    let segment = SegmentSettings {
        amax_mps2,
        ramp_s: 1.0,
        hold_s: 4.0,
        shape: Shape::Smooth,
    };
    settings.program = heapless::Vec::from_array([EntrySettings::Segment(segment)]);
    settings.controller().unwrap()
}

/// Returns the feedback of motors that have made all commanded steps, with a command.
fn followed(controller: &Controller, command: Option<Command>) -> Feedback {
    let mut feedback = Feedback::with_command(command);
    let counts = feedback.encoder.iter_mut().zip(&controller.channels);
    for (axis, (count, channel)) in counts.enumerate() {
        let steps = controller.output.telemetry.steps(axis) as i32;
        *count = if channel.reversed { -steps } else { steps };
    }
    feedback
}

/// Plays ticks. If `detected`, there is an index pulse from every axis eight ticks before their end.
fn play(controller: &mut Controller, command: Option<Command>, ticks: u32, detected: bool) {
    for tick in 0..ticks {
        let mut feedback = followed(controller, command.filter(|_| tick == 0));
        if detected && tick + 8 == ticks {
            feedback.index = [Some(IndexPulse { cycle: 0 }); MAX_AXES].into();
        }
        controller.tick(&feedback);
    }
}

/// Starts a machine, and plays ticks until it runs. Each axis has an index pulse in the tick after its command has made a turn more.
fn home(controller: &mut Controller) {
    let phases = |controller: &Controller| -> [Phase; MAX_AXES] {
        core::array::from_fn(|axis| controller.output.telemetry.axis_phase(axis))
    };
    let left = phases(controller);
    let turns = |controller: &Controller| {
        let now = phases(controller);
        let made = |axis: usize| now[axis].since(left[axis]).to_num::<f64>().floor();
        core::array::from_fn::<_, MAX_AXES, _>(made)
    };
    let (mut command, mut before) = (Some(Command::Start), turns(controller));
    for _ in 0..10 * HZ {
        let made = turns(controller);
        let mut feedback = followed(controller, command.take());
        for axis in 0..controller.axis_count() {
            let passes = made[axis] > before[axis];
            feedback
                .index
                .set(axis, passes.then_some(IndexPulse { cycle: 0 }));
        }
        before = made;
        controller.tick(&feedback);
        if controller.output.telemetry.state == State::Run {
            return;
        }
    }
    panic!("it does not run: {:?}", controller.output.telemetry.fault);
}

/// If this fails, the next plan is written over pulses that the step hardware is still reading.
#[test]
fn pulses_of_a_tick_stay_in_memory_while_the_next_tick_is_planned() {
    let mut controller = controller(&sample::settings(3), 2.0);
    let mut place = |axis| {
        let output = controller.tick(&Feedback::with_command(None));
        assert!(!output.runs(axis).is_empty());
        assert!(output.runs(3).is_empty() && output.runs(MAX_AXES).is_empty());
        output.runs(axis).as_ptr()
    };
    let places = [place(1), place(1), place(1)];
    assert_ne!(places[0], places[1]);
    assert_eq!(places[0], places[2]);
}

/// Returns a controller in run, without sensors, so that a test need not simulate them.
fn running(amax_mps2: f64) -> Controller {
    let mut settings = settings();
    for axis in &mut settings.axes {
        axis.index_turns = None;
    }
    let mut controller = controller(&settings, amax_mps2);
    play(&mut controller, Some(Command::Start), 1000, false);
    assert_eq!(controller.output.telemetry.state, State::Run);
    controller
}

#[test]
fn a_drive_alarm_stops_the_machine_and_names_its_axis() {
    let mut controller = running(100.0);
    let mut feedback = Feedback::with_command(None);
    feedback.alarms = 1 << 1;
    let telemetry = controller.tick(&feedback).telemetry.clone();
    let fault = telemetry.fault.expect("a fault");
    assert_eq!((fault.kind, fault.axis), (FaultKind::DriveAlarm, Some(1)));
    assert_eq!((telemetry.state, fault.tick), (State::Stop, 1000));
}

/// If this fails, a board with open alarm inputs stops a machine that does not have those axes.
#[test]
fn an_alarm_of_an_axis_that_is_not_there_is_ignored() {
    let mut controller = running(100.0);
    let mut feedback = Feedback::with_command(None);
    feedback.alarms = !0 << 2;
    let telemetry = controller.tick(&feedback).telemetry.clone();
    assert_eq!((telemetry.state, telemetry.fault), (State::Run, None));
}

/// If this fails, a machine runs in a forbidden band, or its operator gets no event or a false one.
#[test]
fn a_level_in_a_band_is_held_at_its_nearer_edge_and_reported() {
    // 8.5 rev/s and 9.5 rev/s: R (1 + λ) ω²
    for (hz, edge_hz) in [(8.5_f64, 8.0), (9.5, 10.0)] {
        let amax_mps2 = 0.02 * 1.3 * (core::f64::consts::TAU * hz).powi(2);
        let mut controller = running(amax_mps2);
        play(&mut controller, None, 4000, false);
        let motion = controller.output.telemetry.motion;
        assert!(motion.held_at_band && !motion.crossing_band);
        let actual_hz = motion.speed.to_num::<f64>() * f64::from(HZ);
        assert!((actual_hz - edge_hz).abs() < 1e-9, "{actual_hz} rev/s");
    }
    let mut outside = running(40.0);
    play(&mut outside, None, 4000, false);
    assert!(!outside.output.telemetry.motion.held_at_band);
}

#[test]
fn the_program_continues_from_the_seek_position() {
    let mut controller = running(100.0);
    controller.seek(5 * u64::from(HZ) - 10);
    assert_eq!(controller.program().1.remaining(controller.program().0), 10);
    play(&mut controller, None, 11, false);
    assert_eq!(
        controller.output.telemetry.state,
        State::Stop,
        "the program is over"
    );
}

/// If this fails, the machine uses index readings from before the drives were off, although the cranks may have been turned since.
#[test]
fn every_start_from_idle_homes_again() {
    let mut controller = controller(&settings(), 100.0);
    home(&mut controller);
    assert_eq!(controller.output.telemetry.state, State::Run);
    let mut lost = Feedback::with_command(None);
    lost.inputs.enable = false;
    controller.tick(&lost);
    play(&mut controller, Some(Command::Reset), 1, false);
    play(&mut controller, Some(Command::Start), 100, false);
    assert_eq!(controller.output.telemetry.state, State::Homing);
}

/// Returns a controller after the enable input was lost in a run, with the drives off.
fn lost(settings: &Settings) -> Controller {
    let mut controller = controller(settings, 100.0);
    home(&mut controller);
    assert_eq!(controller.output.telemetry.state, State::Run);
    let mut lost = followed(&controller, None);
    lost.inputs.enable = false;
    controller.tick(&lost);
    assert_eq!(controller.output.telemetry.state, State::Fault);
    controller
}

/// If this fails, a crank that was turned by hand while its encoder was read is moved together with the others, and may bend the rods. The
/// fault names the crank. After a reset, homing finds it again.
#[test]
fn a_start_beyond_the_homing_range_is_refused() {
    let mut settings = settings();
    for axis in &mut settings.axes {
        axis.encoder = true;
    }
    let mut controller = lost(&settings);
    let mut feedback = followed(&controller, None);
    // Its encoder counts backwards, as the axis is reversed.
    for _ in 0..256 {
        feedback.encoder[1] -= 4;
        controller.tick(&feedback);
    }
    // Its filtered phase error follows.
    for _ in 0..100 {
        controller.tick(&feedback);
    }
    let mut tick = |command| {
        feedback.command = command;
        controller.tick(&feedback).clone()
    };
    tick(Some(Command::Reset));
    let refused = tick(Some(Command::Start));
    assert_eq!(refused.telemetry.state, State::Fault);
    let fault = refused.telemetry.fault.expect("it is refused");
    assert_eq!(
        (fault.kind, fault.axis),
        (FaultKind::HomingRangeExceeded, Some(1))
    );
    assert!(
        (fault.size.to_num::<f64>() - 0.25).abs() < 0.01,
        "{fault:?}"
    );
    assert_eq!(
        refused.telemetry.event.map(|event| event.kind),
        Some(fault.kind)
    );
    for _ in 0..100 {
        let stands = tick(None);
        assert!(!stands.drives_enabled && stands.telemetry.motion.at_rest);
    }
    assert_eq!(tick(Some(Command::Reset)).telemetry.state, State::Idle);
    assert_eq!(tick(Some(Command::Start)).telemetry.state, State::Homing);
}

/// If this fails, pulses of cranks that no drive holds are compared with each other, and a machine that coasted is refused.
#[test]
fn homing_discards_index_positions_if_cranks_turn_without_drives() {
    let mut controller = lost(&settings());
    play(&mut controller, None, 10, false);
    assert!(controller.homing.has_found());
    play(&mut controller, None, 10, true);
    assert!(!controller.homing.has_found());
}

/// If this fails, trims of an interrupted homing run remain. Without a correction, the next homing must take back even those below the
/// error of a reading.
#[test]
fn trims_of_an_interrupted_wiring_proof_are_reverted() {
    let mut settings = settings();
    for axis in &mut settings.axes {
        axis.index_turns = None;
    }
    settings.correction.prove_wiring = true;
    let mut controller = controller(&settings, 100.0);
    let tolerance = controller.monitor.tolerance(0);
    let trim = |controller: &Controller| controller.offsets.now()[0].abs();
    play(&mut controller, Some(Command::Start), 1, false);
    let mut was_tilted = false;
    while trim(&controller) > tolerance / 2 || !was_tilted {
        was_tilted |= trim(&controller) > tolerance;
        play(&mut controller, None, 1, false);
        assert_eq!(controller.output.telemetry.state, State::Homing);
    }
    assert!(trim(&controller) > 0, "it is on its way");
    let mut lost = Feedback::with_command(None);
    lost.inputs.enable = false;
    controller.tick(&lost);
    assert_eq!(controller.output.telemetry.state, State::Fault);
    play(&mut controller, Some(Command::Reset), 1, false);
    play(&mut controller, Some(Command::Start), 4000, false);
    assert_eq!(controller.output.telemetry.state, State::Run);
    assert_eq!(trim(&controller), 0);
}

/// If this fails, a geared and reversed servo gets a wrong setpoint. It makes half of the travel and of the acceleration, with the opposite
/// sign.
#[test]
fn setpoints_have_the_motors_direction_and_gear_ratio() {
    let controller = running(200.0);
    let [plain, turned, ..] = controller.output.setpoints;
    let motion = controller.output.telemetry.motion;
    assert!(motion.acceleration > 0);
    assert_eq!(plain.velocity, motion.speed);
    let half = Turns::from_bits(motion.speed.to_bits() / 2);
    assert!((turned.velocity + half).abs() <= Turns::DELTA, "{turned:?}");
    // With the crank at the same phase, the geared axis's own share is J α″/2.
    let alpha =
        motion.acceleration.to_num::<f64>() * f64::from(HZ).powi(2) * core::f64::consts::TAU;
    let forward = controller.channels[1].feed_forward.expect("a servo");
    let phase = controller.output.telemetry.axis_phase(1);
    let still = forward.torque(phase, half, Turns::ZERO).to_num::<f64>();
    let s_term = forward
        .torque(
            phase,
            Turns::ZERO,
            Turns::from_bits(motion.acceleration.to_bits() / 2),
        )
        .to_num::<f64>()
        - forward
            .torque(phase, Turns::ZERO, Turns::ZERO)
            .to_num::<f64>();
    assert!((-turned.torque.to_num::<f64>() - (still + s_term)).abs() < 1e-3);
    assert!(
        s_term > 0.9 * 1e-3 * alpha / 2.0,
        "the rotor takes its part"
    );
}
