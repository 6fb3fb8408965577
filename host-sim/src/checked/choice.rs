//! Chosen model level, and the reason.

use cophase_scene::file::Fidelity;

use crate::output::Output;

/// Chosen model level, and the reason.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Model level.
    pub model_level: Fidelity,
    /// Reason, as a sentence.
    pub why: String,
    /// Judgement of each requested output.
    pub judged: Vec<Judged>,
    /// Permitted relative error of oscillations by the method's step.
    pub resolution: f64,
}

/// Requested output, and the accuracy of its answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Output.
    pub output: Output,
    /// Permitted error, in [`Output::unit`].
    pub tolerance: f64,
    /// Bound on the error; `None` if there is none, or if the scene lacks data for it.
    pub bound: Option<f64>,
    /// Value in the run, in [`Output::value_unit`]; `None` before the run, and if the model level does not compute it.
    pub value: Option<f64>,
    /// Difference in a sample, and the model level compared with; `None` before the sample was run.
    pub measured: Option<(f64, Fidelity)>,
    /// Error by the method's step, as a sample shows it; `None` if nothing is integrated, and before the sample was run.
    pub step_error: Option<f64>,
}

impl Judged {
    /// Returns true if the bound is within the tolerance.
    pub fn is_bounded(&self) -> bool {
        self.bound.is_some_and(|bound| bound <= self.tolerance)
    }
}
