//! What a decision of this chart is.

use cophase_methods::{Scheme, StepError};

/// A machine at the edge of something.
pub(super) trait Decision {
    /// Its name in the data.
    fn name(&self) -> &'static str;
    /// What the threshold is of, as a panel's title.
    fn title(&self) -> &'static str;
    /// The reference's threshold, in the drive's unit.
    fn reference(&self) -> f64;
    /// How far the reference may itself be off, relative.
    fn doubt(&self) -> f64;
    /// The frequency that steps are compared with, rad/s.
    fn omega_rad_s(&self) -> f64;
    /// Steps that are tried, s, at the reference's threshold.
    fn steps_s(&self) -> Vec<f64>;
    /// What becomes of it at a drive: whether it is beyond the threshold, and how often the machine was asked.
    fn beyond(&self, scheme: Scheme, step_s: f64, drive: f64) -> Result<(bool, u64), NoOutcome>;
}

/// Why there is no outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NoOutcome {
    /// The method is not for this machine.
    Unsuited,
    /// It diverged, or did not converge.
    Broke,
}

impl From<StepError> for NoOutcome {
    fn from(_: StepError) -> Self {
        Self::Broke
    }
}
