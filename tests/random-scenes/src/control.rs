//! `[control]`, `[limits]`, `[pulse]`, `[index]`, `[drift]` and `[correction]`.

use std::f64::consts::TAU;

use cophase_scene::file::{
    Axes, Band, Control, Correction, Drift, Drive, Index, InputName, Level, Limits, Link,
    LossReaction, Pulse, Wiring,
};
use host_sim::mechanism::{AnyMechanism, Mechanism};

use crate::basis::{Basis, Kind};
use crate::source::Source;

/// A tick rate whose tick is a whole number of microseconds. The default is drawn most often, and rates that the board keeps for few
/// machines seldom.
pub fn tick_hz(source: &mut Source) -> u32 {
    if source.percent(40) {
        return 2000;
    }
    let max_hz = if source.percent(80) { 2500 } else { 10_000 };
    let whole: Vec<u32> = (500..=max_hz).filter(|hz| 1_000_000 % hz == 0).collect();
    source.one_of(&whole)
}

/// Greatest speed. In most scenes a program can request the platform's acceleration at that speed.
pub fn speed_hz(source: &mut Source, mechanism: &AnyMechanism, tick_hz: u32) -> f64 {
    const MAX_AMAX_MPS2: f64 = 10_000.0;
    let max = mechanism.speed_for_amax_rad_s(MAX_AMAX_MPS2) / TAU;
    let usual = (0.02 * max.min(60.0), max.min(60.0));
    let max_hz = (0.4 * f64::from(tick_hz)).min(200.0);
    source.usual(usual, (0.1, max_hz))
}

/// Time to the greatest speed, s.
pub fn ramp_s(source: &mut Source, tick_hz: u32) -> f64 {
    source.usual((0.05, 1.5), (1.0 / f64::from(tick_hz), 3.0))
}

/// Homing speed. A turn at the least one takes 100 s.
pub fn homing_hz(source: &mut Source, speed_hz: f64) -> f64 {
    let max_hz = speed_hz.min(10.0);
    if source.percent(2) {
        return source.log_between(0.05, max_hz.max(0.06)).min(speed_hz);
    }
    source.usual((0.8, max_hz), (0.3 * max_hz, max_hz))
}

pub fn control(source: &mut Source, tick_hz: u32) -> Control {
    Control {
        tick_hz,
        park_deg: source.or_default(180.0, 0.0, 360.0),
        settle_s: if source.percent(97) {
            source.number(0.0, 0.3)
        } else {
            source.number(0.0, 10.0)
        },
    }
}

pub fn wiring(source: &mut Source) -> Wiring {
    if source.percent(80) {
        return Wiring::default();
    }
    let level = |source: &mut Source| source.one_of(&[Level::Low, Level::High]);
    Wiring {
        step: level(source),
        drive_enable: level(source),
        index: level(source),
        alarm: level(source),
        enable: level(source),
        stop: level(source),
        start: level(source),
        no_pull: source
            .maybe(50, |source| {
                source.one_of(&[InputName::Index, InputName::Alarm])
            })
            .into_iter()
            .collect(),
    }
}

pub fn link(source: &mut Source) -> Link {
    let timeout_s = source.or_default(0.0, 0.1, 60.0);
    let reaction = source.one_of(&[LossReaction::Stop, LossReaction::StopNow]);
    // Without a timeout no host is lost, and a reaction is refused.
    let reaction = if timeout_s == 0.0 {
        LossReaction::Stop
    } else {
        reaction
    };
    Link {
        timeout_s,
        reaction,
    }
}

pub fn limits(source: &mut Source, basis: &Basis) -> Limits {
    let hz = f64::from(basis.tick_hz);
    let speed_hz = basis.speed_hz;
    let acceleration_hz_per_s = (speed_hz / basis.ramp_s).clamp(0.01, speed_hz * hz);
    let round_s = source.usual((0.05 * basis.ramp_s, basis.ramp_s), (1.0 / hz, 2.0));
    // The lower bound exceeds the jerk that a tick can resolve, at any tick rate.
    let jerk_hz_per_s2 = (acceleration_hz_per_s / round_s).clamp(0.3, speed_hz * hz * hz);
    let harder = source.maybe(40, |source| source.log_between(1.0, 20.0));
    Limits {
        speed_hz,
        acceleration_hz_per_s,
        jerk_hz_per_s2,
        stop_acceleration_hz_per_s: harder
            .map(|harder| (acceleration_hz_per_s * harder).min(speed_hz * hz)),
        stop_jerk_hz_per_s2: harder
            .map(|harder| (jerk_hz_per_s2 * harder * harder).min(speed_hz * hz * hz)),
        homing_speed_hz: basis.homing_hz,
        band: bands(source, basis),
    }
}

/// Up to four bands between the homing speed and the greatest.
fn bands(source: &mut Source, basis: &Basis) -> Vec<Band> {
    let (from, to) = (1.1 * basis.homing_hz, 0.98 * basis.speed_hz);
    if to < 1.3 * from || to - from < 0.2 || !source.percent(30) {
        return Vec::new();
    }
    let count = 1 + source.below(4);
    let edges: Vec<f64> = {
        let mut edges: Vec<f64> = (0..2 * count).map(|_| source.between(from, to)).collect();
        edges.sort_by(f64::total_cmp);
        edges
    };
    let bands = edges.chunks(2).map(|edge| Band {
        from_hz: edge[0],
        to_hz: edge[1],
    });
    // Neighbouring bands that are too close for the shaft are left out.
    let mut below = 0.0;
    bands
        .filter(|band| {
            let fits = band.to_hz > band.from_hz && band.from_hz > below + 2e-3;
            below = if fits { band.to_hz } else { below };
            fits
        })
        .collect()
}

pub fn pulse(source: &mut Source, tick_hz: u32) -> Pulse {
    // A change of direction takes about the sum of these times, and has a quarter of a tick.
    let max_ns = 0.05 * 1e9 / f64::from(tick_hz);
    if source.percent(60) {
        return Pulse::default();
    }
    Pulse {
        width_ns: source.usual((100.0, 3000.0), (8.0, max_ns)),
        dir_setup_ns: source.usual((100.0, 5000.0), (0.0, max_ns)),
        dir_hold_ns: source.usual((100.0, 5000.0), (0.0, max_ns)),
    }
}

pub fn index(source: &mut Source, tick_hz: u32) -> Index {
    let max_us = (0.25e6 / f64::from(tick_hz)).min(100.0);
    Index {
        width_us: source.or_default(2.0, 0.1, max_us),
    }
}

/// Limits of the monitor. In most scenes the natural lag of servos is subtracted.
pub fn drift(source: &mut Source, basis: &Basis, axes: &Axes) -> Drift {
    let default = Drift::default();
    let lag_us = axes.servo.filter(|_| source.percent(80)).map(|servo| {
        let lag_s = (1.0 - servo.velocity_feed_forward) / servo.position_gain_per_s;
        (1e6 * lag_s).min(100_000.0).round()
    });
    if source.percent(60) {
        return Drift {
            lag_us: lag_us.unwrap_or(default.lag_us),
            ..default
        };
    }
    let mut drift = default;
    drift.visit(|row, value| {
        let range = (row.low, row.high);
        let drawn = match row.name {
            "tilt_limit_mrad" | "warp_limit_deg" => source.usual((1.0, 30.0), range),
            "common_limit_deg" => source.usual((5.0, 90.0), range),
            "reading_error_deg" => source.usual((0.05, 1.0), range),
            "lag_us" => lag_us.unwrap_or_else(|| source.number(row.low, row.high)),
            _ => source.number(row.low, row.high),
        };
        // Only a platform tilts.
        if row.name != "tilt_limit_mrad" || basis.kind == Kind::Cranks {
            *value = drawn;
        }
    });
    drift
}

pub fn correction(source: &mut Source, basis: &Basis, axes: &Axes) -> Correction {
    let default = Correction::default();
    if source.percent(40) {
        return default;
    }
    let is_coupled = basis.drive == Drive::Servo
        && basis.other_drive.is_none()
        && basis.has_encoder
        && axes.servo.is_some();
    Correction {
        gain: source.number(0.0, 1.0),
        prove_wiring: source.percent(8),
        couple: is_coupled && source.percent(40),
        coupling: source
            .maybe(20, |source| source.number(0.0, 20.0))
            .filter(|_| is_coupled),
        coupling_per_s: source
            .maybe(20, |source| source.number(0.0, 10_000.0))
            .filter(|_| is_coupled),
    }
}
