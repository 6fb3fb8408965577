//! Correction in run: once a turn, phase offsets remove a part of the differences between the cranks.
//!
//! The work is divided among ticks, so that no tick is much longer than the others.

use super::correction::Step;
use super::{Controller, homing};
use crate::monitor::Finding;
use crate::units::Turns;

impl Controller {
    /// True if the correction has work to do in this tick.
    #[inline(always)]
    pub(super) fn has_correction_to_do(&mut self) -> bool {
        if !self.offsets.corrects() {
            return false;
        }
        if self.state.correction.step == Step::Wait {
            if self.is_correction_due() {
                self.state.correction.step = Step::Verify;
            }
            return false;
        }
        self.has_time()
    }

    /// Continues the correction. A fault that the cranks do not follow the corrections replaces a finding within limits, as it is the cause
    /// of that finding.
    #[inline(never)]
    pub(super) fn correct(&mut self, found: &mut Option<Finding>) {
        let swapped = self.continue_correction();
        if swapped.is_some() && found.as_ref().is_none_or(|found| found.within_limits) {
            *found = swapped;
        }
    }

    /// Continues the correction; returns a fault if the cranks do not follow the corrections.
    fn continue_correction(&mut self) -> Option<Finding> {
        self.state.is_busy = true;
        self.state.correction.step = match self.state.correction.step {
            // Encoders were read, or a round has ended. The cranks must be at their commanded phases.
            Step::Verify if self.offsets.is_moving() || !self.monitor.is_homed() => Step::Wait,
            Step::Verify => {
                if let Some(fault) = self.homing.corrected(&self.monitor, &self.offsets) {
                    self.state.correction.step = Step::Wait;
                    return Some(Finding::from_fault(fault));
                }
                Step::Compute
            }
            Step::Compute => {
                let errors = homing::errors(&self.monitor, &self.offsets);
                let watched = self.monitor.watched();
                self.state.correction.target = self.offsets.against(&errors, watched, false);
                Step::Allow
            }
            // A difference that the offsets may not remove remains, until it exceeds a limit.
            Step::Allow => {
                let target = &self.state.correction.target;
                if self.offsets.beyond_limit(target).is_none() && self.monitor.allows(target) {
                    Step::Round
                } else {
                    Step::Wait
                }
            }
            Step::Round => {
                self.state.correction.steps = self.offsets.rounded(&self.state.correction.target);
                Step::Start
            }
            Step::Start | Step::Wait => {
                self.offsets.start(self.state.correction.steps);
                Step::Wait
            }
        };
        None
    }

    fn is_correction_due(&mut self) -> bool {
        let correction = &mut self.state.correction;
        if self.monitor.has_encoders() {
            correction.turned = correction.turned.wrapping_add(self.state.motion.speed);
            if correction.turned < Turns::ONE {
                return false;
            }
            correction.turned = Turns::ZERO;
            return true;
        }
        let rounds = self.monitor.rounds();
        core::mem::replace(&mut correction.rounds, rounds) != rounds
    }
}
