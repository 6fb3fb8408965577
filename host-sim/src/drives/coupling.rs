//! Gains of the cross-coupling between servos, from the properties of the drives and their rotors.
//!
//! The loop corrects each servo's setpoint by −(p s + q ∫ s dt), with s the deviation of its crank from the mean of all. For modes 1 and
//! up, the open loop is L(s) = (p + q/s) e^(−sτ) T(s). The delay τ is two ticks: one in which the setpoint is computed, and one until
//! it is reached. T is the transfer function of the drive from its setpoint,
//!
//! T = C (f s + g) / (J s² + C (s + g)), C = k (1 + 1/(Tᵢ s)),
//!
//! with the drive's gains g, k and integral time Tᵢ, and its part f of velocity feed-forward. J is the inertia of the rotor, alone and
//! with the largest load. The gains are the largest with which the distance of L from −1 is at least [`APART`] at all frequencies and
//! both inertias. So the gain margin is at least 1/(1 − APART), and the phase margin 2 asin(APART/2). The proportional gain is fixed, as
//! more of it improves little: its input is two ticks late.
//!
//! The design neglects the drives' current limits and the elasticity of rods.

use std::f64::consts::TAU;

use cophase_scene::file::ServoDrive;
use num_complex::Complex;

/// Least distance of the open loop from −1, at any frequency.
pub const APART: f64 = 0.6;

/// Proportional gain.
const PROPORTIONAL: f64 = 0.2;

/// Properties of the servos for which the coupling is designed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// Servo drives.
    pub servo: ServoDrive,
    /// Inertia of a rotor alone, kg·m².
    pub min_kgm2: f64,
    /// Inertia of a rotor with its largest load, kg·m².
    pub max_kgm2: f64,
    /// Control ticks per second.
    pub tick_hz: f64,
}

/// Gains, with their margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Gain from the deviation of a crank to its setpoint.
    pub proportional: f64,
    /// Gain from the integrated deviation, 1/s.
    pub per_s: f64,
    /// Factor on both gains at which the coupling becomes unstable.
    pub gain_margin: f64,
}

impl Plant {
    /// Computes the gains.
    ///
    /// `None` if even the smallest gains do not keep the distance, as for drives with little damping of their own.
    pub fn gains(&self) -> Option<Gains> {
        let keeps = |per_s: f64| self.apart(PROPORTIONAL, per_s) >= APART;
        let (mut inside, mut outside) = (1e-3, self.tick_hz);
        if !keeps(inside) {
            return None;
        }
        while outside - inside > 1e-3 * inside {
            let per_s = f64::midpoint(inside, outside);
            if keeps(per_s) {
                inside = per_s;
            } else {
                outside = per_s;
            }
        }
        // Two digits, rounded down, are enough to read.
        let unit = 10_f64.powf(inside.log10().floor() - 1.0);
        let per_s = (inside / unit).floor() * unit;
        Some(Gains {
            proportional: PROPORTIONAL,
            per_s,
            gain_margin: self.gain_margin(PROPORTIONAL, per_s),
        })
    }

    /// Returns the least distance of the open loop from −1 over all frequencies.
    fn apart(&self, proportional: f64, per_s: f64) -> f64 {
        let inertias = [self.min_kgm2, self.max_kgm2];
        let all = inertias.iter().flat_map(|&inertia| {
            self.frequencies().map(move |omega| {
                (self.open_loop(proportional, per_s, inertia, omega) + 1.0).norm()
            })
        });
        all.fold(f64::INFINITY, f64::min)
    }

    /// Returns the factor on both gains at which the open loop passes −1.
    fn gain_margin(&self, proportional: f64, per_s: f64) -> f64 {
        let mut margin = f64::INFINITY;
        for inertia in [self.min_kgm2, self.max_kgm2] {
            let mut before: Option<Complex<f64>> = None;
            for omega in self.frequencies() {
                let now = self.open_loop(proportional, per_s, inertia, omega);
                if let Some(before) = before.filter(|b| b.im * now.im < 0.0 && now.re < 0.0) {
                    let part = before.im / (before.im - now.im);
                    let re = before.re + part * (now.re - before.re);
                    margin = margin.min(-1.0 / re);
                }
                before = Some(now);
            }
        }
        margin
    }

    fn open_loop(
        &self,
        proportional: f64,
        per_s: f64,
        inertia_kgm2: f64,
        omega: f64,
    ) -> Complex<f64> {
        let s = Complex::new(0.0, omega);
        let servo = &self.servo;
        let integral = servo
            .integral_s
            .map_or(Complex::new(0.0, 0.0), |integral_s| 1.0 / (s * integral_s));
        let velocity_loop = (integral + 1.0) * servo.velocity_gain_nms;
        let drive = velocity_loop * (s + servo.position_gain_per_s);
        let lead = velocity_loop * (s * servo.velocity_feed_forward + servo.position_gain_per_s);
        let follows = lead / (s * s * inertia_kgm2 + drive);
        let delay = (-s * (2.0 / self.tick_hz)).exp();
        (Complex::new(proportional, 0.0) + per_s / s) * delay * follows
    }

    /// Returns frequencies from low ones to half the tick rate, a hundred per decade.
    fn frequencies(&self) -> impl Iterator<Item = f64> + use<> {
        let top = TAU * self.tick_hz / 2.0;
        (0..=500).map(move |i| top * 10_f64.powf(-f64::from(i) / 100.0))
    }
}
