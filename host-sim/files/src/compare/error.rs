//! Reasons why two runs cannot be compared.

use std::path::Path;

/// Input that cannot be compared: its place, the problem, and the fix.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct CompareError {
    place: String,
    problem: String,
}

impl CompareError {
    /// Problem of a file or folder.
    pub(super) fn new(path: &Path, problem: impl Into<String>) -> Self {
        Self::for_argument(path.display().to_string(), problem)
    }

    /// Problem of an argument.
    pub(super) fn for_argument(place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self {
            place: place.into(),
            problem: problem.into(),
        }
    }
}
