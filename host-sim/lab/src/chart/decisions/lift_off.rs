//! The speed at which a follower lifts off its cam.
//!
//! The wrapper's chain ([`Chain`]), its shaft damped to the cam, its pusher pressed on by a
//! closing spring of constant force. What the cam presses on the follower with is that force, and what spring and damper of
//! the shaft carry; at the speed that is the drive its least value in a turn is 0.
//!
//! The cam turns from rest of the chain: four turns until the start is forgotten, and one that is looked at. Between steps the least
//! value is taken from a parabola through the lowest and its neighbours.

use cophase_methods::Scheme;
use cophase_methods::problems::{Cam, Chain, Law, Shaft};

use super::decision::{Decision, NoOutcome};
use crate::chart::methods::Counted;

use std::f64::consts::TAU;

/// The chain; the drive is the cam's speed in turns a second.
pub struct LiftOff;

/// Force of the closing spring, N.
const PRELOAD_N: f64 = 500.0;
/// Turns before the one that is looked at.
pub const SETTLING: u32 = 4;
/// Steps a turn: the fewest, and how often they are doubled.
const FEWEST: u32 = 64;
const DOUBLINGS: u32 = 8;

/// The wrapper at a speed.
pub fn chain(speed_hz: f64) -> Chain {
    let cam = Cam {
        speed_rad_s: speed_hz * TAU,
        ..Cam::wrapper(Law::ModifiedSine)
    };
    Chain::wrapper(cam, Shaft::DampedToCam)
}

/// What the cam presses on the follower with, N.
pub fn contact_n(chain: &Chain, t_s: f64, state: &[f64]) -> f64 {
    let cam = chain.cam.at(t_s);
    PRELOAD_N
        + Chain::STIFFNESS_N_M[0] * (cam.displacement - state[0])
        + Chain::DAMPING_N_S_M[0] * (cam.velocity - state[3])
}

/// The least of values in even steps, between which a parabola runs through the lowest and its neighbours.
pub fn least(values: impl Iterator<Item = f64>) -> f64 {
    let (mut before, mut at) = (f64::INFINITY, f64::INFINITY);
    let mut least = f64::INFINITY;
    for after in values {
        if at <= before && at <= after && before.is_finite() {
            let (slope, bend) = (0.5 * (after - before), after - 2.0 * at + before);
            let dip = if bend > 0.0 {
                slope * slope / (2.0 * bend)
            } else {
                0.0
            };
            least = least.min(at - dip);
        }
        (before, at) = (at, after);
    }
    least
}

impl Decision for LiftOff {
    fn name(&self) -> &'static str {
        "lift-off"
    }

    fn title(&self) -> &'static str {
        "cam speed at which a follower lifts off"
    }

    fn reference(&self) -> f64 {
        REFERENCE_HZ
    }

    fn doubt(&self) -> f64 {
        DOUBT
    }

    /// Of the slowest mode, which rings.
    fn omega_rad_s(&self) -> f64 {
        chain(1.0).undamped_rad_s()[0]
    }

    fn steps_s(&self) -> Vec<f64> {
        (0..=DOUBLINGS)
            .map(|i| 1.0 / (REFERENCE_HZ * f64::from(FEWEST << i)))
            .collect()
    }

    fn beyond(&self, scheme: Scheme, step_s: f64, drive: f64) -> Result<(bool, u64), NoOutcome> {
        // As many steps a turn at every speed: else what is seen of the least force would jump.
        let steps = (1.0 / (REFERENCE_HZ * step_s)).round() as u32;
        let chain = chain(drive);
        let counted = Counted::new(&chain);
        let step_s = chain.cam.cycle_s() / f64::from(steps);
        let mut method = scheme
            .prepare(&counted, step_s)
            .map_err(|_| NoOutcome::Unsuited)?;
        let mut state = [0.0; 6];
        let mut seen = Vec::with_capacity(steps as usize + 2);
        for step in 0..(SETTLING + 1) * steps + 2 {
            let t_s = f64::from(step) * step_s;
            if step >= SETTLING * steps {
                seen.push(contact_n(&chain, t_s, &state));
            }
            method.step(&counted, t_s, &mut state)?;
        }
        Ok((least(seen.into_iter()) < 0.0, counted.asked()))
    }
}

/// What DOP853 has for the threshold, turns a second; `super::reference` computes it again, and by another method.
pub const REFERENCE_HZ: f64 = 7.127_260_152_34;
/// How far the two differ.
pub const DOUBT: f64 = 1e-10;
