//! How cranks answer to what their load asks of them, each a mass on its motor's spring: dimensionless numbers, and the
//! phase errors that come of them.
//!
//! Turning evenly at ω, a platform asks of each crank the torque T(α) = Σ Tₙ e^(inα). With the motor's
//! stiffness k and damping d, and the inertia J of rotor and load's share, harmonic n moves the crank by
//!
//! ```text
//! xₙ = Tₙ / (k − J (nω)² + i nω d)
//! ```
//!
//! J changes within a turn, from the rotor's alone to R² s² m/N more, and the load's own slope dT/dα adds to k or takes from
//! it. So the worst is taken of both over their ranges: where these hold a resonance, only damping bounds the answer. The sum of
//! the |xₙ| is an upper bound of a linear machine at any steady speed; that its coefficients change within the
//! turn, and speeds within seconds, is left to the factor that [`super::Bounds`] has.
//!
//! A servo with torque feed-forward is left with what a tick's hold leaves of it: a part nω·tick of harmonic n. One without full
//! velocity feed-forward follows its command besides, by a lag that grows with speed and needs no torque.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::required_torque::{HARMONICS, RequiredTorque, SAMPLES};
use crate::dynamics::{Body, Driven, Motor};
use crate::mechanism::Mechanism;

/// Speeds looked at, besides those of resonances.
const SPEEDS: u32 = 160;

/// How a scene drives its cranks.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Greatest speed of the master, rad/s.
    pub top_rad_s: f64,
    /// Its greatest acceleration, rad/s².
    pub acceleration_rad_s2: f64,
    /// How fast that changes at most, rad/s³.
    pub jerk_rad_s3: f64,
    /// Control tick, s.
    pub tick_s: f64,
    /// Crank turns to a master turn, each axis.
    pub ratios: Vec<f64>,
    /// Phase relative to the master, each axis, turns.
    pub offsets: Vec<f64>,
    /// Whether the motor is commanded the torque of its load, each axis.
    pub has_feed_forward: Vec<bool>,
}

/// The worst over all speeds up to the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Worst {
    /// Largest lag of any crank, rad; infinite where nothing bounds it.
    pub lag_rad: f64,
    /// Largest difference of two cranks' lags, rad.
    pub spread_rad: f64,
    /// What the cranks' lag does to the platform's acceleration, as a part of amax at top speed.
    pub amax: f64,
    /// By how much motors' torques differ from what the load asks, as a part of the greatest of it.
    pub torque: f64,
    /// Torque of a crank at its longest lever under amax at top speed, over the greatest torque that the load asks of it: by how
    /// much more a part of the acceleration may be of the torque.
    pub torque_of_amax: f64,
    /// Greatest stiffness of a motor over the greatest torque that the load asks of it, 1/rad.
    pub spring_per_rad: f64,
    /// Torque over the most that the motor has (pull-out torque, or a servo's limit), each axis.
    pub torque_ratio: Vec<f64>,
    /// The same as the load alone asks it, without what oscillation adds.
    pub torque_ratio_required: Vec<f64>,
    /// The same at a steady speed, and with the load's greatest torque in a turn instead of the sum of its harmonics: an estimate from
    /// below where those two are bounds.
    pub torque_ratio_steady: Vec<f64>,
    /// Highest frequency that the load has at top speed (its second harmonic), over the lowest of motor and crank.
    pub frequency_ratio: f64,
}

/// One crank at one speed.
struct Crank {
    omega_rad_s: f64,
    stiffness: (f64, f64),
    inertia: (f64, f64),
    damping_nms: f64,
    has_feed_forward: bool,
    /// Following error of its drive without load, rad.
    following_rad: f64,
    /// What moves it: constant, then harmonics.
    torque_nm: [Complex<f64>; HARMONICS + 1],
    /// Torque that the load requires, with feed-forward or without: at most the sum of its harmonics.
    required_nm: f64,
    most_nm: f64,
}

impl Crank {
    /// By how much harmonic `n` moves it at most, rad.
    fn moved_rad(&self, n: usize) -> f64 {
        let radians = n as f64 * self.omega_rad_s;
        let (low, high) = (
            self.stiffness.0 - self.inertia.1 * radians * radians,
            self.stiffness.1 - self.inertia.0 * radians * radians,
        );
        let apart = if low <= 0.0 && high >= 0.0 {
            0.0
        } else {
            low.abs().min(high.abs())
        };
        let held = apart.hypot(radians * self.damping_nms);
        if self.torque_nm[n] == Complex::ZERO {
            return 0.0;
        }
        self.torque_nm[n].norm() / held
    }

    /// How harmonic `n` moves it, at a place within the ranges of stiffness and inertia.
    fn response(&self, n: usize, place: (f64, f64)) -> Complex<f64> {
        let radians = n as f64 * self.omega_rad_s;
        let stiffness = self.stiffness.0 + place.0 * (self.stiffness.1 - self.stiffness.0);
        let inertia = self.inertia.0 + place.1 * (self.inertia.1 - self.inertia.0);
        let held = Complex::new(
            stiffness - inertia * radians * radians,
            radians * self.damping_nms,
        );
        self.torque_nm[n] / held
    }

    /// What the constant torque moves it by, rad; infinite where the load's slope is more than the spring.
    fn standing_rad(&self) -> f64 {
        if self.stiffness.0 > 0.0 {
            self.torque_nm[0].re / self.stiffness.0
        } else {
            f64::INFINITY
        }
    }
}

/// Places within the ranges of stiffness and inertia at which two cranks are compared.
const PLACES: [(f64, f64); 6] = [
    (0.0, 0.0),
    (0.0, 0.5),
    (0.0, 1.0),
    (1.0, 0.0),
    (1.0, 0.5),
    (1.0, 1.0),
];

/// The worst of a machine under a drive.
pub fn worst(driven: &Driven, drive: &Drive) -> Worst {
    let body = driven.body();
    let required = RequiredTorque::by(body);
    let axes = body.axes();
    let mut worst = Worst {
        torque_ratio: vec![0.0; axes],
        torque_ratio_required: vec![0.0; axes],
        torque_ratio_steady: vec![0.0; axes],
        ..Worst::default()
    };
    for omega in speeds(driven, drive, &required) {
        let cranks: Vec<Crank> = (0..axes)
            .map(|i| crank(driven, drive, &required, i, omega))
            .collect();
        at_speed(&cranks, driven, drive, &mut worst);
        for (i, crank) in cranks.iter().enumerate() {
            let steady_nm = greatest_nm(body, crank.omega_rad_s) + body.friction_nm[i];
            let ratio = steady_nm / crank.most_nm;
            worst.torque_ratio_steady[i] = worst.torque_ratio_steady[i].max(ratio);
        }
    }
    let greatest_nm = greatest_nm(body, drive.top_rad_s);
    worst.torque /= greatest_nm;
    let mechanism = &body.mechanism;
    let lever_m = mechanism.crank_radius_m() * required.lever_squared.sqrt();
    let share_kg = body.load.mass_kg / axes as f64;
    worst.torque_of_amax =
        (share_kg * lever_m * mechanism.amax_mps2(drive.top_rad_s) / greatest_nm).max(1.0);
    worst.spring_per_rad /= greatest_nm;
    let swing = swing(driven, drive, &required);
    let lever = mechanism.crank_radius_m() * mechanism.greatest_s();
    worst.amax += 2.0 * swing.rad_s / drive.top_rad_s
        + lever * swing.rad_s2 / mechanism.amax_mps2(drive.top_rad_s);
    let heaviest = body.rotors_kgm2.iter().copied().fold(0.0, f64::max);
    worst.torque += (heaviest + load_inertia_kgm2(body, &required)) * swing.rad_s2 / greatest_nm;
    worst.frequency_ratio = frequency_ratio(driven, drive, &required);
    worst
}

/// Takes in one speed.
fn at_speed(cranks: &[Crank], driven: &Driven, drive: &Drive, worst: &mut Worst) {
    for (i, crank) in cranks.iter().enumerate() {
        let mut lag = crank.standing_rad().abs();
        let following = crank.following_rad.abs();
        let (mut amax, mut torque) = (0.0, 0.0);
        for n in 1..=HARMONICS {
            let moved = crank.moved_rad(n);
            lag += moved;
            let n_f64 = n as f64;
            // x″ = −R (h ω² + s α″): 2 h ω δω, and s δα″, with |s| at most the greatest h.
            amax += moved * (2.0 * n_f64 + n_f64 * n_f64);
            // What the motor gives beyond what the load asks is what turns the inertia.
            let radians = n_f64 * crank.omega_rad_s;
            torque += crank.inertia.1 * radians * radians * moved;
        }
        worst.lag_rad = worst.lag_rad.max(lag + following);
        let at_top = (crank.omega_rad_s / (drive.top_rad_s * drive.ratios[i])).powi(2);
        worst.amax = worst.amax.max(amax * at_top);
        worst.torque = worst.torque.max(torque);
        worst.spring_per_rad = worst.spring_per_rad.max(crank.stiffness.1);
        // A servo gives its commanded torque besides what its lag makes it give.
        let feed_forward_nm = if crank.has_feed_forward {
            crank.required_nm
        } else {
            0.0
        };
        let ratio = (feed_forward_nm + lag * crank.stiffness.1) / crank.most_nm;
        worst.torque_ratio[i] = worst.torque_ratio[i].max(ratio);
        let required = crank.required_nm / crank.most_nm;
        worst.torque_ratio_required[i] = worst.torque_ratio_required[i].max(required);
    }
    for (i, one) in cranks.iter().enumerate() {
        for (j, other) in cranks.iter().enumerate().skip(i + 1) {
            worst.spread_rad = worst
                .spread_rad
                .max(apart_rad((i, one), (j, other), driven, drive));
        }
    }
}

/// By how much two cranks' lags may differ, rad.
fn apart_rad(
    (i, one): (usize, &Crank),
    (j, other): (usize, &Crank),
    driven: &Driven,
    drive: &Drive,
) -> f64 {
    let standing_rad = |crank: &Crank| crank.standing_rad() + crank.following_rad;
    let standing = bounded((standing_rad(one) - standing_rad(other)).abs());
    if drive.ratios[i] != drive.ratios[j] || drive.offsets[i] != drive.offsets[j] {
        let all = |crank: &Crank| (1..=HARMONICS).map(|n| crank.moved_rad(n)).sum::<f64>();
        return standing + all(one) + all(other);
    }
    let body = driven.body();
    let alike = driven.motors()[i] == driven.motors()[j]
        && drive.has_feed_forward[i] == drive.has_feed_forward[j]
        && body.rotors_kgm2[i] == body.rotors_kgm2[j];
    if alike {
        return standing;
    }
    let moved = PLACES.into_iter().map(|place| {
        (1..=HARMONICS)
            .map(|n| bounded((one.response(n, place) - other.response(n, place)).norm()))
            .sum::<f64>()
    });
    standing + moved.fold(0.0, f64::max)
}

/// What is no number, as the difference of two that have no bound, has none either.
fn bounded(value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { value }
}

fn crank(
    driven: &Driven,
    drive: &Drive,
    required: &RequiredTorque,
    i: usize,
    master_rad_s: f64,
) -> Crank {
    let body = driven.body();
    let motor = &driven.motors()[i];
    let omega = master_rad_s * drive.ratios[i];
    let share = 1.0 / body.axes() as f64;
    let (softest, stiffest) = motor.stiffness_nm(omega);
    let slope = required.slope_nm(omega) * share;
    let load = load_inertia_kgm2(body, required);
    let rotor = body.rotors_kgm2[i];
    let has_feed_forward = drive.has_feed_forward[i];
    let mut torque_nm = [Complex::ZERO; HARMONICS + 1];
    // While the speed changes, rotor and load require more. Feed-forward has that but for what a tick's hold leaves of it, and has no
    // friction. What comes at once makes a swing of twice that at worst.
    let inertia = (rotor + load) * drive.ratios[i].abs();
    let ramp_nm = inertia * drive.acceleration_rad_s2;
    let at_once_nm = if has_feed_forward {
        (inertia * drive.jerk_rad_s3 * drive.tick_s).min(ramp_nm)
    } else {
        ramp_nm
    };
    torque_nm[0] = Complex::from(body.friction_nm[i] + 2.0 * at_once_nm);
    let mut required_nm = body.friction_nm[i] + ramp_nm + at_once_nm;
    for (n, torque) in torque_nm.iter_mut().enumerate().skip(1) {
        let left = if has_feed_forward {
            (n as f64 * omega * drive.tick_s).min(1.0)
        } else {
            1.0
        };
        let whole = required.harmonic_nm(n, omega) * share;
        required_nm += whole.norm();
        *torque = whole * left;
    }
    Crank {
        omega_rad_s: omega,
        stiffness: (softest - slope, stiffest + slope),
        inertia: (rotor, rotor + load),
        damping_nms: motor.damping_nms(),
        torque_nm,
        required_nm,
        most_nm: motor.most_nm(omega),
        following_rad: motor.following_error_rad(omega),
        has_feed_forward,
    }
}

/// The most that the load adds to a crank's inertia, whether all move alike or the platform tilts.
fn load_inertia_kgm2(body: &Body, required: &RequiredTorque) -> f64 {
    let radius = body.mechanism.crank_radius_m();
    let tilting = 2.0 * body.tilt_inertia_kgm2 / body.mount_radius_m.powi(2);
    let mass = body.load.mass_kg.max(tilting) / body.axes() as f64;
    mass * radius * radius * required.lever_squared
}

/// The greatest torque that the load asks of a crank at a steady speed, N·m.
fn greatest_nm(body: &Body, omega_rad_s: f64) -> f64 {
    let at = |alpha| {
        let torque = body
            .mechanism
            .torque_nm(&body.load, alpha, omega_rad_s, 0.0);
        torque.abs() / body.axes() as f64
    };
    (0..SAMPLES)
        .map(|i| at(TAU / f64::from(SAMPLES) * f64::from(i)))
        .fold(f64::MIN_POSITIVE, f64::max)
}

/// Motion of a crank beyond that of its command, as ramps make it swing.
#[derive(Default)]
struct Swing {
    rad_s: f64,
    rad_s2: f64,
}

/// The greatest of all cranks. Feed-forward holds each tick's torque, and so is ahead by up to a tick; without it, motor and crank swing
/// at their own frequency. The following error of a drive without full velocity feed-forward grows with speed, so that a ramp has
/// another speed than its command; as the ramp ends, that is made up for by a swing of at most twice as much.
fn swing(driven: &Driven, drive: &Drive, required: &RequiredTorque) -> Swing {
    let body = driven.body();
    let load = load_inertia_kgm2(body, required);
    let motors = driven.motors().iter().enumerate();
    motors.fold(Swing::default(), |most, (i, motor)| {
        let acceleration = drive.acceleration_rad_s2 * drive.ratios[i].abs();
        let jerk = drive.jerk_rad_s3 * drive.ratios[i].abs();
        let stiffness = motor.stiffness_nm(drive.top_rad_s);
        let slowest = (stiffness.0 / (body.rotors_kgm2[i] + load)).sqrt();
        let fastest = (stiffness.1 / body.rotors_kgm2[i]).sqrt();
        let late_s = if drive.has_feed_forward[i] {
            drive.tick_s
        } else {
            2.0 / slowest
        };
        let rad_s = 2.0 * motor.following_error_rad(acceleration).abs();
        Swing {
            rad_s: most.rad_s.max(rad_s),
            rad_s2: most
                .rad_s2
                .max((jerk * late_s).min(acceleration) + rad_s * fastest),
        }
    })
}

/// Speeds of the master to look at: evenly up to the top, and where a harmonic meets the ends of the range that
/// motor and crank resonate in.
fn speeds(driven: &Driven, drive: &Drive, required: &RequiredTorque) -> Vec<f64> {
    let mut speeds: Vec<f64> = (1..=SPEEDS)
        .map(|i| drive.top_rad_s * f64::from(i) / f64::from(SPEEDS))
        .collect();
    let body = driven.body();
    for (i, motor) in driven.motors().iter().enumerate() {
        for inertia in [0.0, load_inertia_kgm2(body, required)] {
            let resonance = (motor.stiffest_nm() / (body.rotors_kgm2[i] + inertia)).sqrt();
            let met = (1..=HARMONICS).map(|n| resonance / n as f64 / drive.ratios[i]);
            speeds.extend(met.filter(|&omega| omega < drive.top_rad_s));
        }
    }
    speeds
}

fn frequency_ratio(driven: &Driven, drive: &Drive, required: &RequiredTorque) -> f64 {
    let body = driven.body();
    let load = load_inertia_kgm2(body, required);
    let ratio = |(i, motor): (usize, &Motor)| {
        let resonance = (motor.stiffness_nm(0.0).0 / (body.rotors_kgm2[i] + load)).sqrt();
        2.0 * drive.top_rad_s * drive.ratios[i] / resonance
    };
    driven
        .motors()
        .iter()
        .enumerate()
        .map(ratio)
        .fold(0.0, f64::max)
}
