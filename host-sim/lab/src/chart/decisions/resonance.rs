//! Least torque with which a screen passes its resonance.
//!
//! From rest, it either passes 40 rad/s, twice the resonance, within 10.24 s, or is captured. The closer the torque is to the
//! threshold, the longer the outcome takes. So the time is part of the definition.

use cophase_methods::Scheme;
use cophase_methods::problems::Screen;

use super::decision::{Decision, NoOutcome};
use crate::chart::methods::Counted;

/// Screen with its motor; the drive is the motor's torque over its rated torque.
pub struct Resonance;

/// Speed beyond the resonance, rad/s.
pub const PASSED_RAD_S: f64 = 40.0;
/// Time limit to reach it, s.
pub const END_S: f64 = 10.24;
/// Longest step, s, of which a power of two fits that time, and the number of halvings.
const LONGEST_S: f64 = 0.08;
const HALVINGS: u32 = 7;

impl Decision for Resonance {
    fn name(&self) -> &'static str {
        "resonance"
    }

    fn title(&self) -> &'static str {
        "least torque through a resonance"
    }

    fn reference(&self) -> f64 {
        REFERENCE
    }

    fn uncertainty(&self) -> f64 {
        UNCERTAINTY
    }

    fn omega_rad_s(&self) -> f64 {
        Screen::omega_rad_s()
    }

    fn steps_s(&self) -> Vec<f64> {
        (0..=HALVINGS)
            .map(|i| LONGEST_S / f64::from(1 << i))
            .collect()
    }

    fn beyond(&self, scheme: Scheme, step_s: f64, drive: f64) -> Result<(bool, u64), NoOutcome> {
        let screen = Screen {
            torque_over_rated: drive,
        };
        let counted = Counted::new(&screen);
        let mut method = scheme
            .prepare(&counted, step_s)
            .map_err(|_| NoOutcome::Unsuited)?;
        let mut state = [0.0; Screen::DIMENSION];
        let steps = (END_S / step_s).round() as u32;
        for step in 0..steps {
            method.step(&counted, f64::from(step) * step_s, &mut state)?;
            if state[5] > PASSED_RAD_S {
                return Ok((true, counted.evaluations()));
            }
        }
        Ok((false, counted.evaluations()))
    }
}

/// Threshold by DOP853. `super::reference` computes it again, and by another method.
pub const REFERENCE: f64 = 1.075_202_385_583_13;
/// Relative difference of the two.
pub const UNCERTAINTY: f64 = 1e-11;
