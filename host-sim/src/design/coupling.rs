//! Gains of the cross-coupling between servos, from what the drives and their rotors are.
//!
//! The loop moves each servo's setpoint against what its crank is off from the mean of all, s, by −(p s + q ∫ s dt). What modes 1
//! and up see of it is an open loop L(s) = (p + q/s) e^(−sτ) T(s): τ is two ticks, one in which the setpoint is computed and one
//! until it is reached, and T what the drive makes of its setpoint,
//!
//! T = C (f s + g) / (J s² + C (s + g)), C = k (1 + 1/(Tᵢ s)),
//!
//! with the drive's gains g, k and integral time Tᵢ, its share f of velocity feed-forward, and J the rotor's inertia, alone and with the most of the platform that it
//! may have to carry. The gains are the largest with which L keeps a distance from −1 of [`APART`] at all frequencies, at either
//! inertia: a gain margin of 1/(1 − APART) at the least, and a phase margin of 2 asin(APART/2). Of the proportional part a
//! fixed share is taken, as more of it gains little: what it answers to comes two ticks late.
//!
//! What it leaves out: the drives' current limits, and rods that bend.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::scene::file::ServoDrive;

/// Least distance of the open loop from −1, at any frequency.
pub const APART: f64 = 0.6;

/// The proportional gain.
const PROPORTIONAL: f64 = 0.2;

/// What the coupling is to be designed for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// The drives.
    pub servo: ServoDrive,
    /// Inertia of a rotor alone, kg·m².
    pub least_kgm2: f64,
    /// And with the most that it has to carry.
    pub most_kgm2: f64,
    /// Control ticks a second.
    pub tick_hz: f64,
}

/// Gains, and how far they are from being too large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Setpoint against what a crank is off.
    pub proportional: f64,
    /// And against that integrated, 1/s.
    pub per_s: f64,
    /// By how much both may be multiplied until the coupling swings without end.
    pub gain_margin: f64,
}

impl Plant {
    /// The gains.
    ///
    /// `None` where even the least would not keep the distance: drives that are badly damped by themselves.
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
        // Two digits, rounded down: nobody wants to read more.
        let unit = 10_f64.powf(inside.log10().floor() - 1.0);
        let per_s = (inside / unit).floor() * unit;
        Some(Gains {
            proportional: PROPORTIONAL,
            per_s,
            gain_margin: self.gain_margin(PROPORTIONAL, per_s),
        })
    }

    /// Distance of the open loop from −1, the least over all frequencies.
    fn apart(&self, proportional: f64, per_s: f64) -> f64 {
        let inertias = [self.least_kgm2, self.most_kgm2];
        let all = inertias.iter().flat_map(|&inertia| {
            self.frequencies().map(move |omega| {
                (self.open_loop(proportional, per_s, inertia, omega) + 1.0).norm()
            })
        });
        all.fold(f64::INFINITY, f64::min)
    }

    /// What both gains may be multiplied by until the open loop passes −1.
    fn gain_margin(&self, proportional: f64, per_s: f64) -> f64 {
        let mut margin = f64::INFINITY;
        for inertia in [self.least_kgm2, self.most_kgm2] {
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

    /// From slow to half the tick rate, a hundred to a decade.
    fn frequencies(&self) -> impl Iterator<Item = f64> + use<> {
        let top = TAU * self.tick_hz / 2.0;
        (0..=500).map(move |i| top * 10_f64.powf(-f64::from(i) / 100.0))
    }
}
