//! A rung that was chosen, and why.

use super::Output;
use crate::scene::file::Fidelity;

/// A rung, and why.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The rung.
    pub rung: Fidelity,
    /// Why, in a sentence.
    pub why: String,
    /// What it leaves out of each output that is asked for.
    pub judged: Vec<Judged>,
    /// By how much what swings may be off by the method's step, of itself.
    pub resolution: f64,
}

/// An output that is asked for, and how well a rung answers it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Which.
    pub output: Output,
    /// By how much it may be off, in [`Output::unit`].
    pub tolerance: f64,
    /// By how much it is off at most; infinite where nothing bounds it, none where the scene does not say enough to reckon it.
    pub bound: Option<f64>,
    /// By how much it differed over a sample, and from which rung; none before that was run.
    pub measured: Option<(f64, Fidelity)>,
}

impl Judged {
    /// Whether it is surely within what is asked.
    pub fn is_bounded(&self) -> bool {
        self.bound.is_some_and(|bound| bound <= self.tolerance)
    }
}
