//! `[axes]` and `[[axis]]`.

use cophase_core::settings::DriveKind;
use cophase_link::board::{Board, Rp2040};
use cophase_motion::pulse::PulseTiming;
use cophase_motion::settings::PulseSettings;
use cophase_scene::file::{Axes, AxisOverrides, CamTable, Drive, Fidelity, Limits, Pulse};
use host_sim::drives::DriveModel;

use crate::basis::{Basis, Kind};
use crate::source::Source;
use crate::{cam, motors};

/// Steps per turn that a scene may have.
const STEPS: (f64, f64) = (4.0, 1_048_576.0);

pub fn drive(source: &mut Source, kind: Kind, fidelity: Fidelity) -> Drive {
    match kind {
        // The quasi-static level compares the torques of steppers.
        _ if fidelity == Fidelity::QuasiStatic => Drive::Stepper,
        // Setpoints are for cranks, not for screws.
        Kind::Screws => source.one_of(&[Drive::Stepper, Drive::PulseServo]),
        _ => source.one_of(&[&[Drive::Stepper], DriveModel::DRIVES].concat()),
    }
}

/// Drive of the axes that have one of their own.
pub fn other_drive(source: &mut Source, common: Drive) -> Option<Drive> {
    let other = match common.kind() {
        DriveKind::Stepper | DriveKind::Servo => Drive::PulseServo,
        DriveKind::PulseServo => Drive::Stepper,
    };
    source.maybe(10, |source| source.one_of(&[other]))
}

/// Crank turns per master turn. Cranks under a platform turn once with the master, and screws follow tables.
pub fn ratio(source: &mut Source, kind: Kind) -> (u32, u32) {
    if kind != Kind::Shafts || !source.percent(50) {
        return (1, 1);
    }
    (part(source), part(source))
}

/// Belt or gearbox: motor turns and crank turns that belong together.
pub fn gear(source: &mut Source) -> (u32, u32) {
    if source.percent(60) {
        return (1, 1);
    }
    if source.percent(50) {
        return source.one_of(&[(57, 11), (50, 17), (20, 36), (3, 1), (10, 1)]);
    }
    (part(source), part(source))
}

/// A whole number of turns in a ratio.
pub fn part(source: &mut Source) -> u32 {
    if source.percent(5) {
        source.one_of(&[1, 1000])
    } else {
        1 + source.below(12) as u32
    }
}

pub fn axes(
    source: &mut Source,
    basis: &Basis,
    pulse: &Pulse,
    limits: &Limits,
    tables: &[CamTable],
    rises: bool,
) -> Axes {
    let has_sensors = basis.kind != Kind::Screws || rises;
    let trim_rate_deg_per_s = source.usual((0.3, 30.0), (1e-3, 360.0));
    let offset_hz = trim_rate_deg_per_s / 360.0 * basis.count as f64;
    let fastest_hz = basis.crank_hz() * cam::steepest(tables) + offset_hz;
    let (full_steps_per_turn, steps_per_turn) = steps(source, basis, pulse, fastest_hz);
    let motors = motors::motors(source, basis, limits, full_steps_per_turn);
    let mut axes = crate::plain::scene().axes;
    axes.count = basis.count;
    axes.drive = basis.drive;
    axes.steps_per_turn = steps_per_turn;
    // Refused where no axis is a stepper.
    axes.full_steps_per_turn = if basis.uses("axes.full_steps_per_turn") {
        full_steps_per_turn
    } else {
        200
    };
    axes.gear = basis.gear;
    axes.ratio = basis.ratio;
    axes.offset_deg = if source.percent(90) {
        0.0
    } else {
        source.number(-180.0, 180.0)
    };
    axes.index = has_sensors && source.percent(90);
    axes.index_deg = source.or_default(0.0, -180.0, 180.0);
    axes.index_width_deg = source.or_default(0.0, 0.0, 90.0);
    axes.index_delay_us = source.or_default(0.0, 0.0, 1000.0);
    axes.encoder = basis.has_encoder;
    axes.brake = source.percent(10);
    axes.trim_limit_deg = source.or_default(5.0, 0.0, 36.0);
    axes.trim_rate_deg_per_s = trim_rate_deg_per_s;
    axes.rotor_inertia_kgm2 = motors.rotor_inertia_kgm2;
    axes.friction_nm = motors.friction_nm;
    axes.damping_nms = motors.damping_nms;
    axes.pull_out = motors.pull_out;
    axes.servo = motors.servo;
    axes.induction = motors.induction;
    axes
}

/// Full steps and steps per turn: as many as the drives can make at their greatest speed.
fn steps(source: &mut Source, basis: &Basis, pulse: &Pulse, fastest_hz: f64) -> (u32, u32) {
    let full_steps = source.one_of(&[200, 200, 200, 400, 48, 4]);
    let settings = PulseSettings {
        width_ns: pulse.width_ns,
        dir_setup_ns: pulse.dir_setup_ns,
        dir_hold_ns: pulse.dir_hold_ns,
    };
    let motor_hz = fastest_hz * basis.motor_turns();
    // Per turn of the crank there are at least as many.
    let min = (STEPS.0 / basis.motor_turns()).max(STEPS.0).ceil();
    let max = (STEPS.1 / basis.motor_turns()).min(STEPS.1).max(min);
    let timing = PulseTiming::new(&settings, Rp2040::CLOCK_HZ, basis.tick_hz);
    let has_pulses = [Some(basis.drive), basis.other_drive]
        .into_iter()
        .flatten()
        .any(|drive| drive.kind().takes_pulses());
    let fits = |steps: u32| {
        let counts = PulseTiming::check_counts(steps, motor_hz, basis.tick_hz).is_ok();
        let pulses = timing
            .as_ref()
            .is_ok_and(|timing| timing.check_rate(steps, motor_hz, basis.tick_hz).is_ok());
        counts && (pulses || !has_pulses)
    };
    let mut steps = source.usual((400.0, 20_000.0), (min, max)) as u32;
    let min = min as u32;
    while !fits(steps) && steps > min {
        steps = (steps * 2 / 3).max(min);
    }
    if !basis.uses("axes.full_steps_per_turn") {
        return (full_steps, steps);
    }
    // A stepper has whole microsteps.
    let full_steps = if steps < full_steps { 4 } else { full_steps };
    (full_steps, (steps / full_steps).max(1) * full_steps)
}

/// Overrides of individual axes.
pub fn apart(
    source: &mut Source,
    basis: &Basis,
    axes: &Axes,
    tables: &[CamTable],
) -> Vec<AxisOverrides> {
    let all = (0..basis.count).map(|number| {
        let has_own = basis.kind == Kind::Screws
            || basis.other_drive.is_some() && number > 0
            || source.percent(35);
        has_own.then(|| one(source, basis, axes, tables, number))
    });
    all.flatten().collect()
}

fn one(
    source: &mut Source,
    basis: &Basis,
    axes: &Axes,
    tables: &[CamTable],
    number: usize,
) -> AxisOverrides {
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    let cam = (!names.is_empty()).then(|| source.one_of(&names).to_owned());
    // At the rigid level all cranks are at one angle.
    let is_free = !basis.is_rigid();
    let drive = basis
        .other_drive
        .filter(|_| number > 0 && source.percent(60));
    let is_stepper = drive.unwrap_or(basis.drive).kind().is_open_loop();
    let trim_deg = source.number(-axes.trim_limit_deg, axes.trim_limit_deg);
    let own_friction = source.usual((1e-3, 1.0), (0.0, 1000.0));
    let start_deg = source.usual((1e-3, 3.0), (-180.0, 180.0));
    let pull_out_scale = source.usual((0.3, 3.0), (0.0, 10.0));
    AxisOverrides {
        number,
        reversed: source.percent(30),
        drive,
        // A drive that can make the common number of steps can make fewer.
        steps_per_turn: source.maybe(15, |source| {
            let part = 1 + source.below(4) as u32;
            let full = axes.full_steps_per_turn;
            ((axes.steps_per_turn / part / full).max(1) * full).min(axes.steps_per_turn)
        }),
        drive_steps_per_turn: source
            .maybe(3, |_| 2 * axes.steps_per_turn)
            .filter(|_| is_stepper && cam.is_none()),
        gear: source.maybe(5, |_| (basis.gear.0, (basis.gear.1 + 1).min(1000))),
        ratio: source
            .maybe(20, |_| (basis.ratio.0, (basis.ratio.1 + 1).min(1000)))
            .filter(|_| basis.kind == Kind::Shafts),
        offset_deg: source
            .maybe(5, |source| source.usual((1e-3, 2.0), (-180.0, 180.0)))
            .filter(|_| is_free),
        index: source.maybe(10, |_| false),
        index_deg: source.maybe(30, |source| source.number(-180.0, 180.0)),
        cam_shift_deg: if cam.is_some() {
            source.number(-360.0, 360.0)
        } else {
            0.0
        },
        cam,
        trim_deg: if is_free && source.percent(20) {
            trim_deg
        } else {
            0.0
        },
        start_deg: if is_free && source.percent(20) {
            start_deg
        } else {
            0.0
        },
        friction_nm: source
            .maybe(10, |_| own_friction)
            .filter(|_| basis.kind == Kind::Cranks),
        pull_out_scale: if is_stepper && !axes.pull_out.is_empty() && source.percent(25) {
            pull_out_scale
        } else {
            1.0
        },
    }
}
