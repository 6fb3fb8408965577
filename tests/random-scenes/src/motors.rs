//! Motors that in most scenes can move their load: pull-out torque, gains of servos, inertia and
//! friction.

use std::f64::consts::TAU;

use cophase_scene::file::{InductionDrive, Limits, ServoDrive};
use host_sim::mechanism::Mechanism;

use crate::basis::{Basis, Kind};
use crate::source::{Source, at_most};

pub struct Motors {
    pub rotor_inertia_kgm2: f64,
    pub friction_nm: f64,
    pub damping_nms: f64,
    pub pull_out: Vec<(f64, f64)>,
    pub servo: Option<ServoDrive>,
    pub induction: Option<InductionDrive>,
}

/// Usual angle, rad, of the fastest oscillation in a tick. A few steps are enough to follow it.
const RADIANS_A_TICK: (f64, f64) = (0.02, 0.7);

/// Motors as their data sheets have them: those that fit the cranks, behind the gear.
pub fn motors(source: &mut Source, basis: &Basis, limits: &Limits, full_steps: u32) -> Motors {
    let turns = basis.motor_turns();
    let cycles = f64::from(full_steps) / 4.0 * turns;
    let at_crank = at_crank(source, basis, limits, cycles);
    let squared = turns * turns;
    let within = |value: f64, (low, high): (f64, f64)| {
        if value == 0.0 {
            0.0
        } else {
            value.clamp(low, high)
        }
    };
    Motors {
        rotor_inertia_kgm2: within(at_crank.rotor_inertia_kgm2 / squared, (1e-9, 1000.0)),
        friction_nm: at_crank.friction_nm,
        damping_nms: within(at_crank.damping_nms / squared, (0.0, 1000.0)),
        pull_out: at_crank
            .pull_out
            .iter()
            .map(|&(hz, nm)| {
                (
                    within(hz * turns, (0.0, 1e4)),
                    within(nm / turns, (0.0, 1e5)),
                )
            })
            .collect(),
        servo: at_crank.servo.map(|servo| ServoDrive {
            velocity_gain_nms: within(servo.velocity_gain_nms / squared, (1e-6, 1e5)),
            limit_nm: servo.limit_nm.map(|nm| within(nm / turns, (1e-3, 1e5))),
            ..servo
        }),
        induction: at_crank.induction.map(|motor| InductionDrive {
            rated_nm: within(motor.rated_nm / turns, (1e-3, 1e6)),
            rated_slip_hz: within(motor.rated_slip_hz * turns, (1e-4, 10.0)),
            ..motor
        }),
    }
}

/// Motors in terms of their cranks, with a number of electrical cycles per turn.
fn at_crank(source: &mut Source, basis: &Basis, limits: &Limits, cycles: f64) -> Motors {
    if basis.kind != Kind::Cranks {
        return Motors {
            rotor_inertia_kgm2: source.number(0.0, 10.0),
            friction_nm: 0.0,
            damping_nms: 0.0,
            pull_out: Vec::new(),
            servo: None,
            induction: None,
        };
    }
    let lever_m = basis.mechanism.crank_radius_m() * basis.mechanism.max_s();
    let share_kg = basis.load_kg / basis.count as f64;
    let load_kgm2 = share_kg * lever_m * lever_m;
    let top_mps2 = basis.max_amax_mps2();
    let load_nm = share_kg * lever_m * (0.6 * top_mps2 + 9.81);
    let has_stepper = basis.uses("axes.pull_out");
    // The rotor is so heavy that a few steps are enough to follow its oscillation.
    let plenty = if source.percent(80) {
        source.log_between(1.5, 20.0)
    } else {
        source.log_between(0.05, 1.5)
    };
    let radians = source.log_between(RADIANS_A_TICK.0, RADIANS_A_TICK.1) * f64::from(basis.tick_hz);
    let stiffness = plenty * (load_nm + load_kgm2 * 10.0 * TAU * basis.speed_hz) * cycles;
    let min_kgm2 = if has_stepper {
        stiffness / (radians * radians)
    } else {
        0.0
    };
    let min_kgm2 = min_kgm2.clamp(1e-6, 5.0);
    let rotor_inertia_kgm2 = source
        .usual((0.1 * load_kgm2, 10.0 * load_kgm2), (1e-6, 10.0))
        .max(at_most(min_kgm2));
    let acceleration = limits
        .stop_acceleration_hz_per_s
        .unwrap_or(limits.acceleration_hz_per_s)
        * TAU;
    let required_nm = load_nm + (rotor_inertia_kgm2 + load_kgm2) * acceleration;
    let friction_nm = source.usual((1e-4 * required_nm, 0.3 * required_nm), (0.0, 1000.0));
    let max_nm = (plenty * required_nm + friction_nm).clamp(1e-3, 9e4);
    if !basis.has_torque {
        return Motors {
            rotor_inertia_kgm2: source.one_of(&[0.0, rotor_inertia_kgm2]),
            friction_nm: source.one_of(&[0.0, friction_nm]),
            damping_nms: 0.0,
            pull_out: Vec::new(),
            servo: None,
            induction: None,
        };
    }
    let swings_rad_s = (max_nm * cycles / rotor_inertia_kgm2).sqrt();
    let critical_nms = 2.0 * rotor_inertia_kgm2 * swings_rad_s;
    let damping_nms = source.usual((0.02 * critical_nms, critical_nms), (0.0, 1000.0));
    Motors {
        rotor_inertia_kgm2,
        friction_nm,
        damping_nms: if has_stepper { damping_nms } else { 0.0 },
        pull_out: if has_stepper {
            pull_out(source, basis, max_nm)
        } else {
            Vec::new()
        },
        servo: basis
            .uses("axes.servo")
            .then(|| servo(source, basis, rotor_inertia_kgm2, max_nm)),
        induction: basis
            .uses("axes.induction")
            .then(|| induction(source, basis, rotor_inertia_kgm2, max_nm)),
    }
}

/// A motor with its breakdown torque, and with a slip that brings its rotor to speed within some
/// ticks.
fn induction(source: &mut Source, basis: &Basis, inertia_kgm2: f64, max_nm: f64) -> InductionDrive {
    let velocity_rad_s = f64::from(basis.tick_hz) * source.log_between(0.02, 0.5);
    let breakdown_ratio = source.number(1.1, 4.0);
    let breakdown_rad_s = 2.0 * max_nm / (velocity_rad_s * inertia_kgm2);
    let rated_rad_s =
        breakdown_rad_s / (breakdown_ratio + (breakdown_ratio * breakdown_ratio - 1.0).sqrt());
    InductionDrive {
        rated_nm: (max_nm / breakdown_ratio).clamp(1e-3, 1e6),
        rated_slip_hz: (rated_rad_s / TAU).clamp(1e-4, 10.0),
        breakdown_ratio,
        position_gain_per_s: source
            .usual((0.02 * velocity_rad_s, 0.25 * velocity_rad_s), (1e-3, 1e3)),
        following_error_deg: source.maybe(30, |source| source.usual((1.0, 90.0), (0.01, 180.0))),
    }
}

/// A curve that falls towards its end. In most scenes the end is beyond the top speed.
fn pull_out(source: &mut Source, basis: &Basis, max_nm: f64) -> Vec<(f64, f64)> {
    let end_hz = basis.crank_hz() * source.one_of(&[0.8, 1.3, 1.5, 1.5, 2.0, 3.0]);
    if source.percent(5) {
        return vec![(source.one_of(&[0.0, 1e4]), max_nm)];
    }
    let count = 2 + source.below(4);
    let falls = source.number(0.3, 1.0);
    let points = (0..count).map(|i| {
        let part = i as f64 / (count - 1) as f64;
        let torque_nm = max_nm * (1.0 - part * (1.0 - falls));
        (at_most(end_hz * part), at_most(torque_nm))
    });
    points.collect()
}

fn servo(source: &mut Source, basis: &Basis, inertia_kgm2: f64, max_nm: f64) -> ServoDrive {
    let velocity_rad_s = f64::from(basis.tick_hz) * source.log_between(0.05, 1.0);
    let usual_nms = (
        0.5 * velocity_rad_s * inertia_kgm2,
        velocity_rad_s * inertia_kgm2,
    );
    let usual_per_s = (0.05 * velocity_rad_s, 0.25 * velocity_rad_s);
    let limit_nm = source.usual((0.5 * max_nm, 2.0 * max_nm), (1e-3, 1e5));
    ServoDrive {
        position_gain_per_s: source.usual(usual_per_s, (1e-3, 1e5)),
        velocity_gain_nms: source.usual(usual_nms, (1e-6, 1e5)),
        integral_s: source.maybe(40, |source| {
            let usual = (3.0 / velocity_rad_s, 100.0 / velocity_rad_s);
            source.usual(usual, (1e-5, 1e3))
        }),
        limit_nm: source.maybe(60, |_| limit_nm),
        velocity_feed_forward: if source.percent(60) {
            1.0
        } else {
            source.number(0.0, 1.0)
        },
        following_error_deg: source.maybe(30, |source| source.usual((1.0, 90.0), (0.01, 180.0))),
    }
}
