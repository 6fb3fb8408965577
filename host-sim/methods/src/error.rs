//! Errors of a method: before the first step, in a step, and in measurements that make steps.

use crate::Needs;

/// Reason why a method cannot be prepared for a machine and a step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// The step is not finite and above 0.
    #[error("step {0} s: must be a finite time above 0")]
    Step(f64),
    /// The machine lacks the structure that the method requires.
    #[error("{method} needs {needs}, which these equations do not offer: {instead}")]
    Structure {
        /// Name of the method.
        method: &'static str,
        /// Structure that it requires.
        needs: Needs,
        /// Suggested method.
        instead: &'static str,
    },
    /// The exponential of the system's matrix over one step has no finite value.
    #[error("step {step_s} s: the system grows beyond f64 within it; take a shorter step")]
    Exponential {
        /// Requested step.
        step_s: f64,
    },
}

/// Reason why a step was not made. The state is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// A component of the new state, or of an intermediate value, is infinite or not a number.
    #[error(
        "component {component} is not finite in the step from t = {t_s} s: the step is too long for this method, or the equations have no value there"
    )]
    NotFinite {
        /// Start of the step.
        t_s: f64,
        /// First such component.
        component: usize,
    },
    /// The implicit equation of a stage was not solved within the iteration limit.
    #[error(
        "no solution of the implicit equation within {iterations} iterations in the step from t = {t_s} s (the last one still moved {excess:.1e} times what is allowed): take a shorter step"
    )]
    NotConverged {
        /// Start of the step.
        t_s: f64,
        /// Number of iterations made.
        iterations: u32,
        /// Last correction, as a multiple of the tolerance.
        excess: f64,
    },
    /// The matrix of the implicit equation cannot be inverted.
    #[error(
        "the matrix of the implicit equation is singular in the step from t = {t_s} s: take another step length"
    )]
    Singular {
        /// Start of the step.
        t_s: f64,
    },
}

/// Reason why a measurement that makes steps has no result.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotMeasured {
    /// The method cannot be prepared for these equations.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// A step failed.
    #[error(transparent)]
    Step(#[from] StepError),
}

impl StepError {
    /// Returns the same error with its time later by `by_s`, for steps whose time did not begin at 0.
    #[must_use]
    pub fn later(mut self, by_s: f64) -> Self {
        let (Self::NotFinite { t_s, .. } | Self::NotConverged { t_s, .. } | Self::Singular { t_s }) =
            &mut self;
        *t_s += by_s;
        self
    }
}
