//! One turn of the shaft, and the periodic regime; converged, and by the source's scheme.

use std::f64::consts::TAU;

use cophase_methods::{Equations, NotMeasured, Scheme};

use super::{Load, OnMains, Shape};

/// Steps of the fourth-order method in each piece of a turn. The beginning and the end of the rock's force cut the turn into pieces.
const STEPS: u32 = 240;

/// Distance from the ends of a piece within which the force is taken from inside the piece. It is far below a step.
const INSIDE_RAD: f64 = 1e-10;

/// Turns after which the last one counts as the periodic regime. Each turn reduces a deviation to a tenth, so the speed settles to
/// 1e-10 rad/s long before.
const MAX_TURNS: u32 = 100;

/// Speeds of the shaft over one turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Speeds {
    /// Angle of the shaft, rad, and speed, rad/s, from the start to the end of the turn.
    pub nodes: Vec<[f64; 2]>,
    /// Duration of the turn, s.
    pub duration_s: f64,
}

/// The shaft came to rest within the turn: the load is more than motor and flywheel can move.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the shaft came to rest at {phi_rad:.3} rad: the rock takes more than motor and flywheel give; lower the force or add inertia"
)]
pub struct Diverged {
    /// Angle of the shaft, rad.
    pub phi_rad: f64,
}

impl Speeds {
    /// Fastest speed, rad/s.
    #[must_use]
    pub fn fastest_rad_s(&self) -> f64 {
        self.nodes
            .iter()
            .map(|node| node[1])
            .fold(f64::MIN, f64::max)
    }

    /// Slowest speed, rad/s.
    #[must_use]
    pub fn slowest_rad_s(&self) -> f64 {
        self.nodes
            .iter()
            .map(|node| node[1])
            .fold(f64::MAX, f64::min)
    }

    /// Mean over time, rad/s.
    #[must_use]
    pub fn mean_rad_s(&self) -> f64 {
        let turned = self.nodes[self.nodes.len() - 1][0] - self.nodes[0][0];
        turned / self.duration_s
    }

    /// Speed at the end of the turn, rad/s.
    #[must_use]
    pub fn end_rad_s(&self) -> f64 {
        self.nodes[self.nodes.len() - 1][1]
    }

    /// Difference of the fastest and the slowest speed over the mean over time.
    #[must_use]
    pub fn irregularity(&self) -> f64 {
        (self.fastest_rad_s() - self.slowest_rad_s()) / self.mean_rad_s()
    }
}

/// Equations of the crusher over the shaft's angle instead of time: dω/dφ and dt/dφ; state (ω, t).
///
/// Within a piece of the turn the rock acts all the time or not at all, so that the rates are smooth.
#[derive(Clone, Copy, Debug)]
pub struct TurnEquations {
    crusher: OnMains,
    /// Piece that the rates are for, rad.
    piece_rad: [f64; 2],
}

impl Equations for TurnEquations {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, phi_rad: f64, y: &[f64], rates: &mut [f64]) {
        let omega = y[0];
        let mut of_time = [0.0; 2];
        // The force may jump at the ends of the piece. The force just inside is that of the piece.
        let [from, to] = self.piece_rad;
        let inside_rad = phi_rad.clamp(from + INSIDE_RAD, to - INSIDE_RAD);
        self.crusher.rates(0.0, &[inside_rad, omega], &mut of_time);
        rates[0] = of_time[1] / omega;
        rates[1] = omega.recip();
    }
}

impl OnMains {
    /// The same crusher with rock of a shape and a peak force, N.
    #[must_use]
    pub fn with_rock(&self, shape: Shape, peak_n: f64) -> Self {
        Self {
            load: Load::new(shape, peak_n, &self.linkage),
            ..*self
        }
    }

    /// Angles that cut the turn from `start_rad` on into pieces with smooth rates.
    fn pieces_rad(&self, start_rad: f64) -> Vec<f64> {
        let mut knots: Vec<f64> = self
            .load
            .acts_rad()
            .into_iter()
            .map(|knot| start_rad + (knot - start_rad).rem_euclid(TAU))
            .collect();
        knots.sort_by(f64::total_cmp);
        knots.insert(0, start_rad);
        knots.push(start_rad + TAU);
        knots
    }

    /// One turn, converged, from an angle and a speed of the shaft.
    ///
    /// # Errors
    /// The shaft comes to rest.
    pub fn turn(&self, start_rad: f64, start_rad_s: f64) -> Result<Speeds, Diverged> {
        let mut state = [start_rad_s, 0.0];
        let mut nodes = vec![[start_rad, start_rad_s]];
        for piece in self.pieces_rad(start_rad).windows(2) {
            let (from, to) = (piece[0], piece[1]);
            let step = (to - from) / f64::from(STEPS);
            if to - from < 1e-6 {
                continue;
            }
            let equations = TurnEquations {
                crusher: *self,
                piece_rad: [from, to],
            };
            let mut made = || -> Result<(), NotMeasured> {
                let mut method = Scheme::Rk4.prepare(&equations, step)?;
                for i in 0..STEPS {
                    let phi = from + f64::from(i) * step;
                    method.step(&equations, phi, &mut state)?;
                    nodes.push([phi + step, state[0]]);
                }
                Ok(())
            };
            let failed = made().is_err();
            let slow = nodes.iter().find(|node| node[1] <= 0.0);
            if failed || slow.is_some() {
                let at = slow.or(nodes.last());
                return Err(Diverged {
                    phi_rad: at.map_or(from, |node| node[0]),
                });
            }
        }
        Ok(Speeds {
            nodes,
            duration_s: state[1],
        })
    }

    /// The periodic regime, converged: the turn that ends with its initial speed.
    ///
    /// # Errors
    /// There is no periodic regime: the shaft comes to rest.
    pub fn periodic(&self, start_rad: f64, guess_rad_s: f64) -> Result<Speeds, Diverged> {
        settled(guess_rad_s, |speed| self.turn(start_rad, speed))
    }

    /// One turn by the source's scheme, its equation (5): explicit, with `count` nodes a turn and the forward difference of Je.
    ///
    /// # Errors
    /// The shaft comes to rest.
    pub fn turn_by_source(
        &self,
        count: u32,
        start_rad: f64,
        start_rad_s: f64,
    ) -> Result<Speeds, Diverged> {
        let step = TAU / f64::from(count);
        let (mut omega, mut duration_s) = (start_rad_s, 0.0);
        let mut nodes = vec![[start_rad, omega]];
        for i in 0..count {
            let phi = start_rad + f64::from(i) * step;
            let (here, next) = (self.inertia_kgm2(phi).0, self.inertia_kgm2(phi + step).0);
            let torque_nm = self.motor_nm(omega) - self.rock_nm(phi);
            let after =
                torque_nm * step / (here * omega) + (3.0 * here - next) / (2.0 * here) * omega;
            if after <= 0.0 || !after.is_finite() {
                return Err(Diverged { phi_rad: phi });
            }
            duration_s += 2.0 * step / (omega + after);
            omega = after;
            nodes.push([phi + step, omega]);
        }
        Ok(Speeds { nodes, duration_s })
    }

    /// The periodic regime by the source's scheme.
    ///
    /// # Errors
    /// There is no periodic regime: the shaft comes to rest.
    pub fn periodic_by_source(
        &self,
        count: u32,
        start_rad: f64,
        guess_rad_s: f64,
    ) -> Result<Speeds, Diverged> {
        settled(guess_rad_s, |speed| {
            self.turn_by_source(count, start_rad, speed)
        })
    }

    /// Peak force of rock of a shape, N, with which the slowest speed of the periodic regime is `slowest_rad_s`.
    ///
    /// Bisection finds the force to 1e-12 of itself. Rock that stops the shaft counts as too much.
    ///
    /// # Errors
    /// The shaft comes to rest without any rock.
    pub fn fitted_peak_n(
        &self,
        shape: Shape,
        slowest_rad_s: f64,
        guess_rad_s: f64,
    ) -> Result<f64, Diverged> {
        self.with_rock(shape, 0.0).periodic(0.0, guess_rad_s)?;
        let is_too_much = |peak_n: f64| {
            self.with_rock(shape, peak_n)
                .periodic(0.0, guess_rad_s)
                .map_or(true, |speeds| speeds.slowest_rad_s() < slowest_rad_s)
        };
        let (mut low, mut high) = (0.0, 1e3);
        while !is_too_much(high) {
            low = high;
            high *= 2.0;
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if is_too_much(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(low)
    }
}

/// Repeats the turn until its final speed equals its initial speed, to 1e-10 rad/s.
fn settled(
    guess_rad_s: f64,
    turn: impl Fn(f64) -> Result<Speeds, Diverged>,
) -> Result<Speeds, Diverged> {
    let mut speeds = turn(guess_rad_s)?;
    for _ in 0..MAX_TURNS {
        let start = speeds.end_rad_s();
        speeds = turn(start)?;
        if (speeds.end_rad_s() - start).abs() < 1e-10 {
            break;
        }
    }
    Ok(speeds)
}
