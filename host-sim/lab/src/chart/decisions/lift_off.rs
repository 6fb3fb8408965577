//! Speed at which a follower lifts off its cam.
//!
//! The machine is the wrapper's chain ([`Chain`]). Its shaft is damped to the cam, and a closing spring of constant force presses on
//! its pusher. The contact force is that force, plus the forces of spring and damper of the shaft. The threshold is the speed of
//! the cam at which the least contact force in a turn is 0.
//!
//! The chain starts at rest. After four turns, in which the effect of the start decays, one turn is measured. Between steps, the least
//! force is that of a parabola through the lowest value and its neighbours.

use cophase_methods::Scheme;
use cophase_methods::problems::{Cam, Chain, Law, Shaft};

use super::decision::{Decision, NoOutcome};
use crate::chart::methods::Counted;

use std::f64::consts::TAU;

/// Chain; the drive is the cam's speed in turns per second.
pub struct LiftOff;

/// Force of the closing spring, N.
const PRELOAD_N: f64 = 500.0;
/// Turns before the one that is measured.
pub const SETTLING: u32 = 4;
/// Steps per turn: the fewest, and the number of doublings.
const MIN: u32 = 64;
const DOUBLINGS: u32 = 8;

/// Wrapper at a speed.
pub fn chain(speed_hz: f64) -> Chain {
    let cam = Cam {
        speed_rad_s: speed_hz * TAU,
        ..Cam::wrapper(Law::ModifiedSine)
    };
    Chain::wrapper(cam, Shaft::DampedToCam)
}

/// Returns the contact force of the cam on the follower, N.
pub fn contact_n(chain: &Chain, t_s: f64, state: &[f64]) -> f64 {
    let cam = chain.cam.at(t_s);
    PRELOAD_N
        + Chain::STIFFNESS_N_M[0] * (cam.displacement - state[0])
        + Chain::DAMPING_N_S_M[0] * (cam.velocity - state[3])
}

/// Returns the least of evenly spaced values, on a parabola through the lowest and its neighbours.
pub fn min(values: impl Iterator<Item = f64>) -> f64 {
    let (mut before, mut at) = (f64::INFINITY, f64::INFINITY);
    let mut min = f64::INFINITY;
    for after in values {
        if at <= before && at <= after && before.is_finite() {
            let (slope, bend) = (0.5 * (after - before), after - 2.0 * at + before);
            let dip = if bend > 0.0 {
                slope * slope / (2.0 * bend)
            } else {
                0.0
            };
            min = min.min(at - dip);
        }
        (before, at) = (at, after);
    }
    min
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

    fn uncertainty(&self) -> f64 {
        UNCERTAINTY
    }

    /// Frequency of the slowest mode, which oscillates.
    fn omega_rad_s(&self) -> f64 {
        chain(1.0).undamped_rad_s()[0]
    }

    fn steps_s(&self) -> Vec<f64> {
        (0..=DOUBLINGS)
            .map(|i| 1.0 / (REFERENCE_HZ * f64::from(MIN << i)))
            .collect()
    }

    fn beyond(&self, scheme: Scheme, step_s: f64, drive: f64) -> Result<(bool, u64), NoOutcome> {
        // The same number of steps per turn at every speed; otherwise the least force would jump.
        let steps = (1.0 / (REFERENCE_HZ * step_s)).round() as u32;
        let chain = chain(drive);
        let counted = Counted::new(&chain);
        let step_s = chain.cam.cycle_s() / f64::from(steps);
        let mut method = scheme
            .prepare(&counted, step_s)
            .map_err(|_| NoOutcome::Unsuited)?;
        let mut state = [0.0; 6];
        let mut samples = Vec::with_capacity(steps as usize + 2);
        for step in 0..(SETTLING + 1) * steps + 2 {
            let t_s = f64::from(step) * step_s;
            if step >= SETTLING * steps {
                samples.push(contact_n(&chain, t_s, &state));
            }
            method.step(&counted, t_s, &mut state)?;
        }
        Ok((min(samples.into_iter()) < 0.0, counted.evaluations()))
    }
}

/// Threshold by DOP853, turns per second. `super::reference` computes it again, and by another method.
pub const REFERENCE_HZ: f64 = 7.127_260_152_34;
/// Relative difference of the two.
pub const UNCERTAINTY: f64 = 1e-10;
