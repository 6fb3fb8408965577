//! Correction in run: once a turn, phase offsets take away part of what drives the cranks apart.
//!
//! The work is divided among ticks, so that none of them is much longer than the others.

use super::{Controller, homing};
use crate::drift::Finding;
use crate::units::{MAX_AXES, PerAxis, Turns};

/// Progress of the correction of a turn.
#[derive(Clone, Debug)]
pub(super) struct Correction {
    step: Step,
    /// Rounds of the drift monitor, and turns of the master, at the last correction.
    rounds: u32,
    turned: Turns,
    /// Controller's part of the phase offsets, once it is known: turns, and whole steps.
    target: PerAxis<Turns>,
    steps: PerAxis<i32>,
}

/// Work of the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// Wait for the end of a turn.
    Wait,
    /// Check whether the cranks followed the last correction.
    Verify,
    /// Compute the target.
    Compute,
    /// Check the target against the limits of offsets and platform.
    Allow,
    /// Round the target to whole steps.
    Round,
    /// Start the move.
    Start,
}

impl Correction {
    pub(super) const fn new() -> Self {
        Self {
            step: Step::Wait,
            rounds: 0,
            turned: Turns::ZERO,
            target: [Turns::ZERO; MAX_AXES],
            steps: [0; MAX_AXES],
        }
    }

    /// Waits for the end of a turn.
    pub(super) const fn restart(&mut self) {
        self.step = Step::Wait;
    }
}

impl Controller {
    /// True if the correction has work to do in this tick.
    #[inline(always)]
    pub(super) fn has_correction_to_do(&mut self) -> bool {
        if !self.offsets.corrects() {
            return false;
        }
        if self.correction.step == Step::Wait {
            if self.is_correction_due() {
                self.correction.step = Step::Verify;
            }
            return false;
        }
        self.has_time()
    }

    /// Continues the correction. What is reported within limits of cranks that are driven apart comes of that: a fault that they do
    /// not follow the corrections replaces it.
    #[inline(never)]
    pub(super) fn correct(&mut self, found: Option<Finding>) -> Option<Finding> {
        let swapped = self.continue_correction();
        if swapped.is_some() {
            return found.filter(|found| !found.within_limits).or(swapped);
        }
        found
    }

    /// Continues the correction; returns a fault if the cranks do not follow the corrections.
    fn continue_correction(&mut self) -> Option<Finding> {
        self.is_busy = true;
        self.correction.step = match self.correction.step {
            // Encoders were read, or a round has ended, and the cranks stand where they were commanded.
            Step::Verify if self.offsets.is_moving() || !self.drift.is_homed() => Step::Wait,
            Step::Verify => {
                if let Some(fault) = self.homing.corrected(&self.drift, &self.offsets) {
                    self.correction.step = Step::Wait;
                    return Some(Finding::of(fault));
                }
                Step::Compute
            }
            Step::Compute => {
                let errors = homing::errors(&self.drift, &self.offsets);
                let watched = self.drift.watched();
                self.correction.target = self.offsets.against(&errors, watched, false);
                Step::Allow
            }
            // What offsets are not allowed to take away stays, until it is beyond a limit.
            Step::Allow => {
                let target = &self.correction.target;
                if self.offsets.beyond_limit(target).is_none() && self.drift.allows(target) {
                    Step::Round
                } else {
                    Step::Wait
                }
            }
            Step::Round => {
                self.correction.steps = self.offsets.rounded(&self.correction.target);
                Step::Start
            }
            Step::Start | Step::Wait => {
                self.offsets.start(self.correction.steps);
                Step::Wait
            }
        };
        None
    }

    fn is_correction_due(&mut self) -> bool {
        let correction = &mut self.correction;
        if self.drift.has_encoders() {
            correction.turned = correction.turned.wrapping_add(self.motion.speed);
            if correction.turned < Turns::ONE {
                return false;
            }
            correction.turned = Turns::ZERO;
            return true;
        }
        let rounds = self.drift.rounds();
        core::mem::replace(&mut correction.rounds, rounds) != rounds
    }
}
