//! Decisions of this chart.

use cophase_methods::{Scheme, StepError};

/// Machine whose outcome changes at a threshold.
pub(super) trait Decision {
    /// Name in the data.
    fn name(&self) -> &'static str;
    /// Quantity of the threshold, as a panel's title.
    fn title(&self) -> &'static str;
    /// Threshold of the reference, in the drive's unit.
    fn reference(&self) -> f64;
    /// Relative error of the reference.
    fn uncertainty(&self) -> f64;
    /// Frequency with which steps are compared, rad/s.
    fn omega_rad_s(&self) -> f64;
    /// Steps, s, at the reference's threshold.
    fn steps_s(&self) -> Vec<f64>;
    /// Outcome at a drive: true if it is beyond the threshold, and the number of evaluations of the machine.
    fn beyond(&self, scheme: Scheme, step_s: f64, drive: f64) -> Result<(bool, u64), NoOutcome>;
}

/// Reason why there is no outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NoOutcome {
    /// The method is not for this machine.
    Unsuited,
    /// The method diverged, or did not converge.
    Broke,
}

impl From<StepError> for NoOutcome {
    fn from(_: StepError) -> Self {
        Self::Broke
    }
}
