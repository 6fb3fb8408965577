//! A model level that was chosen, and why.

use super::Output;
use crate::scene::file::Fidelity;

/// A model level, and why.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The model level.
    pub model_level: Fidelity,
    /// Why, in a sentence.
    pub why: String,
    /// Part that it leaves out of each requested output.
    pub judged: Vec<Judged>,
    /// By how much what swings may be off by the method's step, of itself.
    pub resolution: f64,
}

/// A requested output, and how well a model level answers it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Which.
    pub output: Output,
    /// By how much it may be off, in [`Output::unit`].
    pub tolerance: f64,
    /// By how much it is off at most; none where nothing bounds it, or the scene does not say enough to compute it.
    pub bound: Option<f64>,
    /// Value in the run, in [`Output::value_unit`]; none before the run, and where the model level does not know it.
    pub value: Option<f64>,
    /// By how much it differed over a sample, and from which model level; none before that was run.
    pub measured: Option<(f64, Fidelity)>,
    /// By how much half the step changes it over a sample; none where nothing is integrated, and before that was run.
    pub step_error: Option<f64>,
}

impl Judged {
    /// Whether it is surely within what is required.
    pub fn is_bounded(&self) -> bool {
        self.bound.is_some_and(|bound| bound <= self.tolerance)
    }
}
