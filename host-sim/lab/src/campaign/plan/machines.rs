//! Machines that are drawn if no scene is given: three mechanisms, with two to six axes.
//!
//! A scene beside this file gives the properties of the mechanism: crank, load, mount, limits of the shaft. The motors are sized so that nothing
//! slips or lags without a fault. The constants and functions below state how.

use std::f64::consts::TAU;

use cophase_scene::Scene;
use cophase_scene::file::{
    AxisOverrides, Correction, Drive, Fidelity, Index, Noise, Questions, Segment, ServoDrive,
};
use cophase_scene::load;
use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use host_sim::mechanism::Mechanism;

use super::stream::{Stream, rounded};
use crate::campaign::geometry::Geometry;

/// Scenes of the mechanisms. They are no built-in ones, so that a case of a seed stays the same when those change.
const MECHANISMS: [&str; 3] = [
    include_str!("machines/fast.toml"),
    include_str!("machines/medium.toml"),
    include_str!("machines/slow.toml"),
];

/// Stated level of noise: standard deviations of the place and the time of an index edge, and of the reading of an encoder.
pub const NOISE: Noise = Noise {
    seed: 0,
    index_deg: 0.05,
    index_us: 1.0,
    encoder_counts: 1.0,
    load_nm: 0.0,
};

/// Drives and sensors of the axes of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    /// Steppers, each with an index sensor.
    Stepper,
    /// Steppers, each with an index sensor and an encoder.
    WatchedStepper,
    /// Servos, each with an encoder and an index sensor.
    Servo,
    /// Servos that take pulses, each with an index sensor. Drawn only from a scene that has them.
    PulseServo,
}

impl Driven {
    /// Variants that are drawn if no scene is given.
    pub const ALL: [Self; 3] = [Self::Stepper, Self::WatchedStepper, Self::Servo];

    /// Returns true if the axes have encoders.
    pub const fn has_encoder(self) -> bool {
        matches!(self, Self::WatchedStepper | Self::Servo)
    }
}

/// Torque of a motor, as a multiple of the torque that is required of it. At 3, a stepper's rotor is at most 20° of its electrical cycle
/// behind, and may swing by three times as much.
const PLENTY: f64 = 3.0;

/// Damping of a stepper's rotor in its field, with its share of the load, as a fraction of critical damping.
const FIELD_ZETA: f64 = 0.2;

/// Speed up to which motors keep their torque, as a multiple of the machine's greatest speed.
const PULL_OUT_SPEEDS: f64 = 1.5;

/// Electrical cycles per turn: 200 full steps, four per cycle.
const CYCLES: f64 = 50.0;

/// Bandwidth of a servo's velocity loop, rad/s. That of its position loop is a quarter of it, which gives critical damping.
const VELOCITY_RAD_S: f64 = 500.0;

/// Draws a machine with a program of one level: homing, ramp, hold. Its name is that of its mechanism.
pub fn draw(stream: &mut Stream, driven: Driven, on_rotors: bool, prove: bool) -> Scene {
    let text = stream.one_of(&MECHANISMS);
    let mut scene = load::parse(text).expect("a test draws each of them");
    let count = 2 + stream.below(5);
    scene.questions = Questions::default();
    scene.fidelity = if on_rotors {
        Fidelity::Phased
    } else {
        Fidelity::Kinematic
    };
    scene.axes.count = count;
    let turns_back = stream.percent(50);
    scene.axis = (0..count)
        .map(|number| apart(number, turns_back && number % 2 == 1))
        .collect();
    if let Some(machine) = &mut scene.machine {
        machine.load_kg = rounded(machine.load_kg * stream.between(0.1, 1.0), 3);
    }
    control(stream, &mut scene);
    let required_nm = required_nm(&scene);
    motors(stream, &mut scene, driven, required_nm);
    rods(&mut scene, required_nm);
    let level_hz = rounded(scene.limits.speed_hz * stream.between(0.25, 1.0), 3);
    program(stream, &mut scene, level_hz);
    scene.correction = Correction {
        gain: 0.5,
        prove_wiring: prove,
        ..Correction::default()
    };
    scene.noise = Noise {
        seed: stream.seed(),
        encoder_counts: if driven.has_encoder() {
            NOISE.encoder_counts
        } else {
            0.0
        },
        load_nm: if on_rotors {
            // At most a twentieth of the torque that is required of a motor.
            rounded(stream.between(0.0, 0.05) * required_nm, 4)
        } else {
            0.0
        },
        ..NOISE
    };
    scene
}

fn apart(number: usize, reversed: bool) -> AxisOverrides {
    AxisOverrides {
        reversed,
        ..AxisOverrides::new(number)
    }
}

/// Draws the control loop, the homing speed, the limits of a stop, and the places of index flags and cranks.
fn control(stream: &mut Stream, scene: &mut Scene) {
    scene.control.tick_hz = stream.one_of(&[1000, 2000, 2000, 4000]);
    scene.control.settle_s = 0.02;
    scene.control.park_deg = rounded(stream.between(0.0, 360.0), 1);
    let limits = &mut scene.limits;
    limits.homing_speed_hz = rounded(stream.between(1.5, 3.0), 2);
    // The motors have enough torque for such a stop. Twice the acceleration, built up in a quarter of the time, is eight times the jerk.
    let factor = stream.one_of(&[1.0, 2.0, 3.0]);
    limits.stop_acceleration_hz_per_s = Some(limits.acceleration_hz_per_s * factor);
    limits.stop_jerk_hz_per_s2 = Some(limits.jerk_hz_per_s2 * factor.powi(3));
    scene.index = Index::default();
    scene.axes.index_width_deg = 6.0;
    let together = stream.percent(50);
    let common_deg = rounded(stream.between(-170.0, 170.0), 1);
    for apart in &mut scene.axis {
        let own_deg = rounded(stream.between(-170.0, 170.0), 1);
        apart.index_deg = Some(if together { common_deg } else { own_deg });
    }
    draw_limits(stream, scene);
    // After power-up, the cranks are slightly apart: each by at most a quarter of the error that one crank may have.
    if stream.percent(50) {
        let max_deg = Geometry::new(scene)
            .map_or(0.0, |geometry| 0.25 * 360.0 * geometry.single_limit_turns());
        for apart in &mut scene.axis {
            apart.start_deg = rounded(stream.between(-max_deg, max_deg), 3);
        }
    }
    scene.axes.trim_rate_deg_per_s = 10.0;
}

/// Smallest and largest error that one crank alone may have, degrees. The smallest is about half an electrical cycle (3.6°), so that the
/// first lost cycle is beyond the limit. The largest is nearly two cycles.
const ALONE_DEG: (f64, f64) = (4.0, 12.0);

/// Draws the limits on tilt and warp. A drawn error of one crank reaches one of them exactly. The other is up to twice as wide.
fn draw_limits(stream: &mut Stream, scene: &mut Scene) {
    let alone_deg = stream.between(ALONE_DEG.0, ALONE_DEG.1);
    let wider = stream.between(1.0, 2.0);
    let tilt_is_wider = scene.axes.count > 3 && stream.percent(50);
    let Some(geometry) = Geometry::new(scene) else {
        return;
    };
    let (tilt_mrad, warp_deg) = geometry.of_one(alone_deg / 360.0);
    let (tilt_by, warp_by) = if tilt_is_wider {
        (wider, 1.0)
    } else {
        (1.0, wider)
    };
    scene.drift.tilt_limit_mrad = rounded(tilt_mrad * tilt_by, 3);
    if warp_deg > 0.0 {
        scene.drift.warp_limit_deg = rounded(warp_deg * warp_by, 3);
    }
}

/// Draws motors that give [`PLENTY`] times the torque that the machine requires of one motor.
fn motors(stream: &mut Stream, scene: &mut Scene, driven: Driven, required_nm: f64) {
    let load = Geometry::new(scene).map_or(0.0, |geometry| geometry.max_inertia_kgm2());
    let (inertia, friction) = (scene.axes.rotor_inertia_kgm2 + load, scene.axes.friction_nm);
    let axes = &mut scene.axes;
    axes.encoder = driven.has_encoder();
    // The motors are drawn for the cranks, so they are on their shafts.
    axes.gear = (1, 1);
    scene.axis.iter_mut().for_each(|own| own.gear = None);
    if matches!(driven, Driven::Servo | Driven::PulseServo) {
        (axes.drive, axes.steps_per_turn) = if driven == Driven::Servo {
            (Drive::Servo, stream.one_of(&[4096, 10_000, 16_384]))
        } else {
            (Drive::PulseServo, stream.one_of(&[4000, 10_000]))
        };
        axes.pull_out = Vec::new();
        axes.damping_nms = 0.0;
        axes.servo = Some(ServoDrive {
            position_gain_per_s: VELOCITY_RAD_S / 4.0,
            velocity_gain_nms: rounded(VELOCITY_RAD_S * inertia, 6),
            integral_s: None,
            limit_nm: Some(rounded(PLENTY * required_nm + friction, 3)),
            velocity_feed_forward: 1.0,
            following_error_deg: None,
        });
        return;
    }
    axes.drive = Drive::Stepper;
    axes.steps_per_turn = stream.one_of(&[3200, 6400]);
    let max_nm = rounded(PLENTY * required_nm, 3);
    // A rotor that swings is faster than its field for a while, so the torque must not end at the greatest speed of the field.
    let max_hz = PULL_OUT_SPEEDS * scene.limits.speed_hz;
    axes.pull_out = vec![(0.0, max_nm), (max_hz, max_nm)];
    let stiffness = max_nm * CYCLES;
    axes.damping_nms = rounded(2.0 * FIELD_ZETA * (stiffness * inertia).sqrt(), 4);
}

/// Fraction of a motor's torque that bends the rods where one crank alone is at the limit.
const BENDS: f64 = 0.25;

/// Makes rods that the motors of four and more cranks can bend as far as the limits allow cranks to be apart. With stiffer rods no motor
/// could move its crank so far, whatever its command. A crank that is off by e pulls on its rod with at most k R e, at a lever of R.
fn rods(scene: &mut Scene, required_nm: f64) {
    let Some(geometry) = Geometry::new(scene).filter(|_| scene.axes.count > 3) else {
        return;
    };
    let error_rad = geometry.single_limit_turns() * TAU;
    let travel_m = geometry.longest_travel_m();
    let n_per_m = BENDS * (PLENTY * required_nm) / (travel_m * travel_m * error_rad);
    if let Some(machine) = &mut scene.machine {
        machine.rod_n_per_um = rounded((n_per_m * 1e-6).clamp(0.01, machine.rod_n_per_um), 4);
    }
}

/// Largest torque that the machine requires of one motor, at full speed or at rest, at any crank angle, N·m.
fn required_nm(scene: &Scene) -> f64 {
    let limits = &scene.limits;
    let usual = limits.acceleration_hz_per_s;
    let acceleration = limits.stop_acceleration_hz_per_s.unwrap_or(usual) * TAU;
    let max_nm = Geometry::new(scene).map_or(0.0, |geometry| {
        geometry.max_torque_nm(limits.speed_hz * TAU, acceleration)
    });
    let axes = &scene.axes;
    max_nm / axes.count as f64 + axes.friction_nm + axes.rotor_inertia_kgm2 * acceleration
}

/// Sets a program of one level, which is held for long enough to detect a fault.
fn program(stream: &mut Stream, scene: &mut Scene, level_hz: f64) {
    let amax_mps2 = Geometry::new(scene).map_or(0.0, |geometry| {
        geometry.mechanism().amax_mps2(level_hz * TAU)
    });
    let ramp_s = level_hz / scene.limits.acceleration_hz_per_s * stream.between(1.0, 2.0);
    scene.program = vec![Segment {
        amax_g: Some(rounded(amax_mps2 / STANDARD_GRAVITY_MPS2, 3)),
        ramp_s: Some(rounded(ramp_s, 3)),
        hold_s: Some(rounded((8.0 / level_hz).max(0.8), 3)),
        ..Segment::default()
    }];
}
