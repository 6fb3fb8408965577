//! Den Hartog's oscillator: a mass on a spring, driven by a harmonic force, with dry friction. It sticks and slips.
//!
//! q″ + ω² q = P cos νt − F sign q′, with forces per unit mass. At rest friction has any value between −F and F.
//!
//! Source: J. P. Den Hartog, *Forced vibrations with combined Coulomb and viscous friction*, Transactions of the ASME 53, 1931, pages
//! 107 to 115. Without stops the steady motion has the published amplitude [`DenHartog::amplitude`]. With stops, each part of the
//! motion has a formula: [`DenHartog::exact`] joins them.

use core::f64::consts::{PI, TAU};

use nalgebra::DMatrix;

use crate::equations::{Equations, Linear};
use crate::friction::{self, Contact, DryFriction};

/// A driven oscillator with dry friction; state (q, v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenHartog {
    /// Natural frequency ω, rad/s, above 0.
    pub omega_rad_s: f64,
    /// Amplitude P of the driving force per unit mass, m/s², above 0.
    pub force: f64,
    /// Frequency ν of the driving force, rad/s, above 0 and not ω.
    pub drive_rad_s: f64,
    /// Dry friction F per unit mass, m/s², above 0.
    pub friction: f64,
}

/// Part of a motion with a formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Start, s.
    pub from_s: f64,
    /// Direction of motion: 1, −1, or 0 where the mass sticks.
    pub direction: f64,
    /// Position and speed at the start, m and m/s.
    pub start: [f64; 2],
}

/// Samples in a period of the faster of the two frequencies, in which a speed that reverses is searched.
const SAMPLES: f64 = 400.0;

impl DenHartog {
    /// A slow force on a fast mass, which stops in each half period.
    pub const STOPPING: Self = Self {
        omega_rad_s: 100.0,
        force: 10.0,
        drive_rad_s: 30.0,
        friction: 4.0,
    };

    /// A force so large that the mass never stops.
    pub const NON_STOPPING: Self = Self {
        omega_rad_s: 100.0,
        force: 10.0,
        drive_rad_s: 70.0,
        friction: 4.0,
    };

    /// Returns the amplitude of the steady motion without stops, m (Den Hartog's equation 9):
    /// √((P V)² − (F U)²)/ω², with r = ν/ω, V = 1/(1 − r²) and U = sin(π/r) / (r (1 + cos(π/r))).
    pub fn amplitude(&self) -> f64 {
        let ratio = self.drive_rad_s / self.omega_rad_s;
        let (sine, cosine) = (PI / ratio).sin_cos();
        let v = 1.0 / (1.0 - ratio * ratio);
        let u = sine / (ratio * (1.0 + cosine));
        let square = (self.force * v).powi(2) - (self.friction * u).powi(2);
        square.sqrt() / (self.omega_rad_s * self.omega_rad_s)
    }

    /// Returns the parts of the motion up to `end_s` from the state `start` at time 0.
    pub fn phases(&self, end_s: f64, start: [f64; 2]) -> Vec<Phase> {
        let mut phases = vec![self.phase(0.0, start)];
        loop {
            let last = phases[phases.len() - 1];
            match self.change_s(&last, end_s) {
                Some(t_s) => phases.push(self.phase(t_s, [self.during(&last, t_s)[0], 0.0])),
                None => return phases,
            }
        }
    }

    /// Returns the state at `t_s` of a mass that was in the state `start` at time 0, to rounding of the moments of change.
    pub fn exact(&self, t_s: f64, start: [f64; 2]) -> [f64; 2] {
        let phases = self.phases(t_s, start);
        self.during(&phases[phases.len() - 1], t_s)
    }

    /// Returns the phase that begins in a state.
    fn phase(&self, from_s: f64, start: [f64; 2]) -> Phase {
        // A mass at rest under exactly F is about to slide in the direction in which the force grows.
        let soon = |t_s: f64| self.push(t_s, start[0]);
        let push = soon(from_s);
        let growth = -self.force * self.drive_rad_s * (self.drive_rad_s * from_s).sin();
        let is_held = push.abs() < self.friction * (1.0 - 1e-9)
            || push.abs() < self.friction * (1.0 + 1e-9) && push * growth <= 0.0;
        let direction = if start[1] != 0.0 {
            start[1].signum()
        } else if is_held {
            0.0
        } else {
            push.signum()
        };
        Phase {
            from_s,
            direction,
            start,
        }
    }

    /// Force on a mass at rest, without friction.
    fn push(&self, t_s: f64, q: f64) -> f64 {
        self.force * (self.drive_rad_s * t_s).cos() - self.omega_rad_s * self.omega_rad_s * q
    }

    /// Returns the state at `t_s` if a phase lasts until then.
    fn during(&self, phase: &Phase, t_s: f64) -> [f64; 2] {
        if phase.direction == 0.0 {
            return phase.start;
        }
        let (omega, nu) = (self.omega_rad_s, self.drive_rad_s);
        let middle = -phase.direction * self.friction / (omega * omega);
        let steady = self.force / (omega * omega - nu * nu);
        let driven = |t_s: f64| {
            let (sin, cos) = (nu * t_s).sin_cos();
            [middle + steady * cos, -steady * nu * sin]
        };
        let (first, at) = (driven(phase.from_s), driven(t_s));
        let (q, v) = (phase.start[0] - first[0], phase.start[1] - first[1]);
        let (sin, cos) = (omega * (t_s - phase.from_s)).sin_cos();
        [
            at[0] + q * cos + v / omega * sin,
            at[1] + v * cos - q * omega * sin,
        ]
    }

    /// Returns the end of a phase, if it is before `end_s`.
    fn change_s(&self, phase: &Phase, end_s: f64) -> Option<f64> {
        if phase.direction == 0.0 {
            // |P cos νt − ω² q| = F, at the first of the four angles in a period that come after the start and where it grows.
            let held = self.omega_rad_s * self.omega_rad_s * phase.start[0];
            let turns = (self.drive_rad_s * phase.from_s / TAU).floor();
            let angles = [held + self.friction, held - self.friction]
                .map(|force| (force / self.force).acos());
            // Beyond +F the cosine has to rise, so its angle is −acos; below −F it has to fall.
            let times = (0..3).flat_map(|later| {
                let turn = TAU * (turns + f64::from(later));
                [turn - angles[0], turn + angles[1]]
            });
            let times = times.map(|angle| angle / self.drive_rad_s);
            let first = times
                .filter(|t_s| *t_s > phase.from_s)
                .fold(f64::INFINITY, f64::min);
            return (first < end_s).then_some(first);
        }
        let along = |t_s: f64| phase.direction * self.during(phase, t_s)[1];
        let sample_s = TAU / self.omega_rad_s.max(self.drive_rad_s) / SAMPLES;
        let mut before = phase.from_s;
        loop {
            let mut after = (before + sample_s).min(end_s);
            if after <= before {
                return None;
            }
            if along(after) < 0.0 {
                // The speed is 0 at the start of a phase, so the interval begins a rounding error later.
                while after - before > 4.0 * f64::EPSILON * after {
                    let middle = f64::midpoint(before, after);
                    if along(middle) < 0.0 {
                        after = middle;
                    } else {
                        before = middle;
                    }
                }
                return Some(after);
            }
            before = after;
        }
    }
}

/// The same oscillator with friction that reverses smoothly, −F tanh(q′/u), as simulations often have it. It has no rest: a mass that
/// friction should hold drifts, and near standstill its speed relaxes at the rate F/u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed {
    /// Oscillator.
    pub oscillator: DenHartog,
    /// Speed u over which friction reverses, m/s, above 0.
    pub speed_mps: f64,
}

impl Equations for Smoothed {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        let friction = self.oscillator.friction * (y[1] / self.speed_mps).tanh();
        rates[0] = y[1];
        rates[1] = self.oscillator.push(t_s, y[0]) - friction;
    }

    fn is_second_order(&self) -> bool {
        true
    }
}

impl Equations for DenHartog {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        friction::rates(self, t_s, y, rates);
    }

    fn is_second_order(&self) -> bool {
        true
    }

    fn linear(&self) -> Option<&dyn Linear> {
        Some(self)
    }

    fn friction(&self) -> Option<&dyn DryFriction> {
        Some(self)
    }
}

impl DryFriction for DenHartog {
    fn speeds(&self) -> &[usize] {
        &[1]
    }

    fn bounds(&self, _: &[f64], bounds: &mut [[f64; 2]]) {
        bounds[0] = [-self.friction, self.friction];
    }

    fn rates_with(&self, t_s: f64, y: &[f64], contacts: &[Contact], rates: &mut [f64]) {
        rates[0] = y[1];
        rates[1] = match contacts[0] {
            Contact::Sticks => 0.0,
            Contact::Forwards => self.push(t_s, y[0]) - self.friction,
            Contact::Backwards => self.push(t_s, y[0]) + self.friction,
            Contact::Free(force) => self.push(t_s, y[0]) + force,
        };
    }
}

/// Without friction.
impl Linear for DenHartog {
    fn matrix(&self) -> DMatrix<f64> {
        let square = self.omega_rad_s * self.omega_rad_s;
        DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -square, 0.0])
    }

    fn input(&self, t_s: f64, input: &mut [f64]) {
        input[0] = 0.0;
        input[1] = self.push(t_s, 0.0);
    }
}
