//! The least torque that gets a screen through its resonance.
//!
//! From rest on it either passes 40 rad/s, twice the resonance, within 10.24 s, or is caught. Near the threshold it hesitates, and decides
//! later the nearer: the time is part of the question.

use cophase_methods::Scheme;
use cophase_methods::problems::Screen;

use super::decision::{Decision, NoOutcome};
use crate::chart::methods::Counted;

/// The screen with its motor; the drive is the motor's torque over its rated one.
pub struct Resonance;

/// Past the resonance, rad/s.
pub const PASSED_RAD_S: f64 = 40.0;
/// Time to get there, s.
pub const END_S: f64 = 10.24;
/// The longest step, s, of which a power of two fits into that time, and how often it is halved.
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

    fn doubt(&self) -> f64 {
        DOUBT
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
                return Ok((true, counted.asked()));
            }
        }
        Ok((false, counted.asked()))
    }
}

/// What DOP853 has for the threshold; `super::reference` computes it again, and by another method.
pub const REFERENCE: f64 = 1.075_202_385_583_13;
/// How far the two differ.
pub const DOUBT: f64 = 1e-11;
