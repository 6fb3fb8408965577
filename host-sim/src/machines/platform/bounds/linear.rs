//! Linear response of cranks to the torque of their load, each a mass on its motor's spring: dimensionless numbers, and the
//! resulting phase errors.
//!
//! At a steady speed ω, a platform requires the torque T(α) = Σ Tₙ e^(inα) of each crank. With the motor's stiffness k and damping
//! d, and the inertia J of the rotor and its share of the load, harmonic n moves the crank by
//!
//! ```text
//! xₙ = Tₙ / (k − J (nω)² + i nω d)
//! ```
//!
//! J changes within a turn, between that of the rotor alone and R² s² m/N more. The slope dT/dα of the load adds to k, or reduces
//! it. So the worst values within both ranges are used: where these hold a resonance, only damping bounds the response. The sum of
//! the |xₙ| is an upper bound for a linear machine at any steady speed. The factor in [`super::Bounds`] allows for coefficients that
//! change within the turn, and for speeds that change.
//!
//! With torque feed-forward, a servo's error is what the hold of a tick leaves: a part nω·tick of harmonic n. Without full velocity
//! feed-forward, it also has a following error that grows with speed and needs no torque.

use std::f64::consts::TAU;

use num_complex::Complex;

use super::OnCranks;
use super::required_torque::{HARMONICS, RequiredTorque, SAMPLES};
use crate::drives::Motor;
use crate::dynamics::Body;
use crate::machines::Duty;
use crate::mechanism::Mechanism;

/// Number of speeds that are compared, beside those of resonances.
const SPEEDS: u32 = 160;

/// Worst values over all speeds up to the top speed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Worst {
    /// Largest lag of any crank, rad; infinite if there is no bound.
    pub lag_rad: f64,
    /// Largest difference of two cranks' lags, rad.
    pub spread_rad: f64,
    /// Change of the platform's acceleration by the cranks' lags, relative to amax at top speed.
    pub amax: f64,
    /// Difference between the motors' torques and the load's, relative to the greatest torque of the load.
    pub torque: f64,
    /// Ratio of a crank's torque at its longest lever under amax at top speed to the greatest torque of its load. A relative change
    /// of the acceleration, times this ratio, bounds that of the torque.
    pub torque_of_amax: f64,
    /// Ratio of a motor's greatest stiffness to the greatest torque of its load, 1/rad.
    pub spring_per_rad: f64,
    /// Upper bound on the torque over the motor's greatest torque (pull-out torque, or a servo's limit), of each axis.
    pub torque_ratio: Vec<f64>,
    /// The same bound for the torque of the load alone, without oscillation: the sum of its harmonics, and the torque of ramps.
    pub torque_ratio_required: Vec<f64>,
    /// Ratio of the load's frequency at top speed (its second harmonic) to the lowest frequency of motor and crank.
    pub frequency_ratio: f64,
}

/// Crank at a speed.
struct Crank {
    omega_rad_s: f64,
    stiffness: (f64, f64),
    inertia: (f64, f64),
    damping_nms: f64,
    has_feed_forward: bool,
    /// Following error of its drive without load, rad.
    following_rad: f64,
    /// Torques that move it: a constant, then harmonics.
    torque_nm: [Complex<f64>; HARMONICS + 1],
    /// Upper bound on the load's torque, with or without feed-forward: the sum of its harmonics.
    required_nm: f64,
    max_nm: f64,
}

impl Crank {
    /// Returns the largest motion by harmonic `n`, rad.
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

    /// Returns the response to harmonic `n` at a point within the ranges of stiffness and inertia, rad.
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

    /// Returns the deflection by the constant torque, rad; infinite if the load's slope exceeds the stiffness.
    fn standing_rad(&self) -> f64 {
        if self.stiffness.0 > 0.0 {
            self.torque_nm[0].re / self.stiffness.0
        } else {
            f64::INFINITY
        }
    }
}

/// Points within the ranges of stiffness and inertia at which two cranks are compared.
const PLACES: [(f64, f64); 6] = [
    (0.0, 0.0),
    (0.0, 0.5),
    (0.0, 1.0),
    (1.0, 0.0),
    (1.0, 0.5),
    (1.0, 1.0),
];

/// Computes the worst values of a machine with a duty.
pub fn worst(platform: &OnCranks<'_>, duty: &Duty<'_>) -> Worst {
    let body = platform.body;
    let required = RequiredTorque::by(body);
    let axes = body.axes();
    let mut worst = Worst {
        torque_ratio: vec![0.0; axes],
        torque_ratio_required: vec![0.0; axes],
        ..Worst::default()
    };
    for omega in speeds(platform, duty, &required) {
        let cranks: Vec<Crank> = (0..axes)
            .map(|i| crank(platform, duty, &required, i, omega))
            .collect();
        at_speed(&cranks, platform, duty, &mut worst);
    }
    let max_nm = max_nm(body, duty.top_rad_s);
    worst.torque /= max_nm;
    let mechanism = &body.mechanism;
    let lever_m = mechanism.crank_radius_m() * required.lever_squared.sqrt();
    let share_kg = body.load.mass_kg / axes as f64;
    worst.torque_of_amax =
        (share_kg * lever_m * mechanism.amax_mps2(duty.top_rad_s) / max_nm).max(1.0);
    worst.spring_per_rad /= max_nm;
    let swing = swing(platform, duty, &required);
    let lever = mechanism.crank_radius_m() * mechanism.max_s();
    worst.amax += 2.0 * swing.rad_s / duty.top_rad_s
        + lever * swing.rad_s2 / mechanism.amax_mps2(duty.top_rad_s);
    let heaviest = body.rotors_kgm2.iter().copied().fold(0.0, f64::max);
    worst.torque += (heaviest + load_inertia_kgm2(body, &required)) * swing.rad_s2 / max_nm;
    worst.frequency_ratio = frequency_ratio(platform, duty, &required);
    worst
}

/// Adds the values at one speed.
fn at_speed(cranks: &[Crank], platform: &OnCranks<'_>, duty: &Duty<'_>, worst: &mut Worst) {
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
            // The motor's torque beyond that of the load accelerates the inertia.
            let radians = n_f64 * crank.omega_rad_s;
            torque += crank.inertia.1 * radians * radians * moved;
        }
        worst.lag_rad = worst.lag_rad.max(lag + following);
        let at_top = (crank.omega_rad_s / (duty.top_rad_s * duty.ratios[i])).powi(2);
        worst.amax = worst.amax.max(amax * at_top);
        worst.torque = worst.torque.max(torque);
        worst.spring_per_rad = worst.spring_per_rad.max(crank.stiffness.1);
        // A servo's torque is its commanded torque, and that of its lag.
        let feed_forward_nm = if crank.has_feed_forward {
            crank.required_nm
        } else {
            0.0
        };
        let ratio = (feed_forward_nm + lag * crank.stiffness.1) / crank.max_nm;
        worst.torque_ratio[i] = worst.torque_ratio[i].max(ratio);
        let required = crank.required_nm / crank.max_nm;
        worst.torque_ratio_required[i] = worst.torque_ratio_required[i].max(required);
    }
    for (i, one) in cranks.iter().enumerate() {
        for (j, other) in cranks.iter().enumerate().skip(i + 1) {
            worst.spread_rad =
                worst
                    .spread_rad
                    .max(apart_rad((i, one), (j, other), platform, duty));
        }
    }
}

/// Returns the bound on the difference between the lags of two cranks, rad.
fn apart_rad(
    (i, one): (usize, &Crank),
    (j, other): (usize, &Crank),
    platform: &OnCranks<'_>,
    duty: &Duty<'_>,
) -> f64 {
    let standing_rad = |crank: &Crank| crank.standing_rad() + crank.following_rad;
    let standing = bounded((standing_rad(one) - standing_rad(other)).abs());
    if duty.ratios[i] != duty.ratios[j] || duty.offsets[i] != duty.offsets[j] {
        let all = |crank: &Crank| (1..=HARMONICS).map(|n| crank.moved_rad(n)).sum::<f64>();
        return standing + all(one) + all(other);
    }
    let body = platform.body;
    let alike = platform.motors[i] == platform.motors[j]
        && duty.has_feed_forward[i] == duty.has_feed_forward[j]
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

/// Replaces NaN, such as the difference of two infinite bounds, by infinity.
fn bounded(value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { value }
}

fn crank(
    platform: &OnCranks<'_>,
    duty: &Duty<'_>,
    required: &RequiredTorque,
    i: usize,
    master_rad_s: f64,
) -> Crank {
    let body = platform.body;
    let motor = &platform.motors[i];
    let omega = master_rad_s * duty.ratios[i];
    let share = 1.0 / body.axes() as f64;
    let (softest, stiffest) = motor.stiffness_nm(omega);
    let slope = required.slope_nm(omega) * share;
    let load = load_inertia_kgm2(body, required);
    let rotor = body.rotors_kgm2[i];
    let has_feed_forward = duty.has_feed_forward[i];
    let mut torque_nm = [Complex::ZERO; HARMONICS + 1];
    // While the speed changes, rotor and load require more torque. Feed-forward supplies it, except for what the hold of a tick leaves
    // and for friction. A torque that begins suddenly causes an oscillation of at most twice the static deflection.
    let inertia = (rotor + load) * duty.ratios[i].abs();
    let ramp_nm = inertia * duty.acceleration_rad_s2;
    let at_once_nm = if has_feed_forward {
        (inertia * duty.jerk_rad_s3 * duty.tick_s).min(ramp_nm)
    } else {
        ramp_nm
    };
    torque_nm[0] = Complex::from(body.friction_nm[i] + 2.0 * at_once_nm);
    let mut required_nm = body.friction_nm[i] + ramp_nm + at_once_nm;
    for (n, torque) in torque_nm.iter_mut().enumerate().skip(1) {
        let left = if has_feed_forward {
            (n as f64 * omega * duty.tick_s).min(1.0)
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
        max_nm: motor.max_nm(omega),
        following_rad: motor.following_error_rad(omega),
        has_feed_forward,
    }
}

/// Returns the greatest inertia that the load adds to a crank, for heave and for tilt.
fn load_inertia_kgm2(body: &Body, required: &RequiredTorque) -> f64 {
    let radius = body.mechanism.crank_radius_m();
    let tilting = 2.0 * body.tilt_inertia_kgm2 / body.mount_radius_m.powi(2);
    let mass = body.load.mass_kg.max(tilting) / body.axes() as f64;
    mass * radius * radius * required.lever_squared
}

/// Returns the greatest torque of the load on a crank at a steady speed, N·m.
fn max_nm(body: &Body, omega_rad_s: f64) -> f64 {
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

/// Oscillation of a crank about its command after ramps.
#[derive(Default)]
struct Swing {
    rad_s: f64,
    rad_s2: f64,
}

/// Returns the greatest oscillation of any crank. Feed-forward holds the torque of a tick, so it is up to a tick early. Without it,
/// motor and crank oscillate at their own frequency. Without full velocity feed-forward, the following error grows with speed, so
/// the speed on a ramp differs from its command. The oscillation at the end of the ramp is at most twice that difference.
fn swing(platform: &OnCranks<'_>, duty: &Duty<'_>, required: &RequiredTorque) -> Swing {
    let body = platform.body;
    let load = load_inertia_kgm2(body, required);
    let motors = platform.motors.iter().enumerate();
    motors.fold(Swing::default(), |max, (i, motor)| {
        let acceleration = duty.acceleration_rad_s2 * duty.ratios[i].abs();
        let jerk = duty.jerk_rad_s3 * duty.ratios[i].abs();
        let stiffness = motor.stiffness_nm(duty.top_rad_s);
        let slowest = (stiffness.0 / (body.rotors_kgm2[i] + load)).sqrt();
        let fastest = (stiffness.1 / body.rotors_kgm2[i]).sqrt();
        let late_s = if duty.has_feed_forward[i] {
            duty.tick_s
        } else {
            2.0 / slowest
        };
        let rad_s = 2.0 * motor.following_error_rad(acceleration).abs();
        Swing {
            rad_s: max.rad_s.max(rad_s),
            rad_s2: max
                .rad_s2
                .max((jerk * late_s).min(acceleration) + rad_s * fastest),
        }
    })
}

/// Returns the speeds of the master that are compared: evenly spaced up to the top speed, and those at which a harmonic meets an end
/// of the range of resonances of motor and crank.
fn speeds(platform: &OnCranks<'_>, duty: &Duty<'_>, required: &RequiredTorque) -> Vec<f64> {
    let mut speeds: Vec<f64> = (1..=SPEEDS)
        .map(|i| duty.top_rad_s * f64::from(i) / f64::from(SPEEDS))
        .collect();
    let body = platform.body;
    for (i, motor) in platform.motors.iter().enumerate() {
        for inertia in [0.0, load_inertia_kgm2(body, required)] {
            let resonance = (motor.stiffest_nm() / (body.rotors_kgm2[i] + inertia)).sqrt();
            let met = (1..=HARMONICS).map(|n| resonance / n as f64 / duty.ratios[i]);
            speeds.extend(met.filter(|&omega| omega < duty.top_rad_s));
        }
    }
    speeds
}

fn frequency_ratio(platform: &OnCranks<'_>, duty: &Duty<'_>, required: &RequiredTorque) -> f64 {
    let body = platform.body;
    let load = load_inertia_kgm2(body, required);
    let ratio = |(i, motor): (usize, &Motor)| {
        let resonance = (motor.stiffness_nm(0.0).0 / (body.rotors_kgm2[i] + load)).sqrt();
        2.0 * duty.top_rad_s * duty.ratios[i] / resonance
    };
    platform
        .motors
        .iter()
        .enumerate()
        .map(ratio)
        .fold(0.0, f64::max)
}
