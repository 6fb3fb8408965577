//! Progress of the correction of a turn.

use crate::units::{MAX_AXES, PerAxis, Turns};

/// Progress of the correction of a turn.
#[derive(Clone, Debug)]
pub(super) struct Correction {
    pub(super) step: Step,
    /// Rounds of the drift monitor at the last correction, and turns of the master since.
    pub(super) rounds: u32,
    pub(super) turned: Turns,
    /// Controller's part of the phase offsets, once it is computed: turns, and whole steps.
    pub(super) target: PerAxis<Turns>,
    pub(super) steps: PerAxis<i32>,
}

/// Work of the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
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
