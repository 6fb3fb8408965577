//! What can be wrong with a scene, and where.

use std::fmt;

use cophase_core::settings::SettingsError;

/// Something wrong with a scene: in which file, at which key, what, and what would be right.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// The file, or the name of a built-in scene.
    pub origin: String,
    /// Line in the file, where it is known, counted from 1.
    pub line: Option<usize>,
    /// The key, as a path like `limits.speed_hz`; empty if it is the file as a whole.
    pub key: String,
    /// What is wrong, and what would be right.
    pub problem: String,
}

impl SceneError {
    /// An error at a key; the origin is filled in by whoever knows it.
    pub fn at(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Self {
            origin: String::new(),
            line: None,
            key: key.into(),
            problem: problem.into(),
        }
    }

    /// The same, of a file.
    #[must_use]
    pub fn in_file(mut self, origin: &str) -> Self {
        self.origin = origin.to_owned();
        self
    }
}

impl From<SettingsError> for SceneError {
    fn from(error: SettingsError) -> Self {
        let key = match (error.entry, error.key.split_once(".band.")) {
            (Some(band), Some((table, key))) => format!("{table}.band[{band}].{key}"),
            (Some(axis), None) => format!("{} (axis {axis})", error.key),
            (None, _) => error.key.to_owned(),
        };
        Self::at(key, error.problem.to_string())
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.origin)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if !self.key.is_empty() {
            write!(f, ": {}", self.key)?;
        }
        write!(f, ": {}", self.problem)
    }
}

impl std::error::Error for SceneError {}
