//! Errors of a scene, with their places.

use std::fmt;

use cophase_core::problem::{Problem, SettingsError};

use super::file::Machine;
use super::{entry, range};

/// Limit of errors that are reported together. With more, it is probably the wrong file.
const MAX: usize = 10;

/// Error of a scene: the file, the key, the problem, and the fix.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// File, or the name of a built-in scene.
    pub origin: String,
    /// Line in the file, counted from 1, if it is known.
    pub line: Option<usize>,
    /// Path of the key, such as `limits.speed_hz` or `axis[1].number`; empty for the file as a whole.
    pub key: String,
    /// Axis of the `[[axis]]` entry with the key, if it is known. It differs from the position of the entry.
    pub axis: Option<u8>,
    /// Problem, and the fix.
    pub problem: String,
    /// Further errors, in the order of their lines.
    pub others: Vec<SceneError>,
}

impl SceneError {
    /// Creates an error at a key. The caller adds the origin.
    pub fn for_key(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Self {
            origin: String::new(),
            line: None,
            key: key.into(),
            axis: None,
            problem: problem.into(),
            others: Vec::new(),
        }
    }

    /// Joins errors of a file, up to ten by their lines. `None` if there is none.
    pub fn together(mut errors: Vec<Self>) -> Option<Self> {
        // Errors without a line, such as missing keys, come last.
        errors.sort_by_key(|error| error.line.unwrap_or(usize::MAX));
        errors.truncate(MAX);
        let others = errors.split_off(errors.len().min(1));
        let first = errors.pop()?;
        Some(Self { others, ..first })
    }

    /// Creates an error from a problem of the core at a key, with the unit of the key and the fix for a value out of its range.
    pub fn from_problem(key: impl Into<String>, problem: Problem) -> Self {
        let key = key.into();
        let sentence = range::sentence(&key, problem, range::reason(&key));
        Self::for_key(key, sentence)
    }

    /// Returns the same error with its file.
    #[must_use]
    pub fn in_file(mut self, origin: &str) -> Self {
        self.origin = origin.to_owned();
        let others = std::mem::take(&mut self.others).into_iter();
        self.others = others.map(|other| other.in_file(origin)).collect();
        self
    }
}

impl Machine {
    /// Returns the value of a key that only some mechanisms have.
    ///
    /// # Errors
    /// The key is missing.
    pub fn needed(&self, key: &str) -> Result<f64, SceneError> {
        let found = self.geometry().into_iter().find(|(known, _)| *known == key);
        found.and_then(|(_, value)| value).ok_or_else(|| {
            let problem = format!(
                "missing; machine.mechanism = \"{}\" needs it, so give it",
                self.mechanism.name()
            );
            SceneError::for_key(key, problem)
        })
    }
}

impl From<SettingsError> for SceneError {
    fn from(error: SettingsError) -> Self {
        let key = match (error.entry, error.key.split_once(".band.")) {
            (Some(band), Some((table, key))) => format!("{table}.band[{band}].{key}"),
            (Some(table), None) if error.key.starts_with("cam_table.") => error
                .key
                .replace("cam_table.", &format!("cam_table[{table}].")),
            _ => error.key.to_owned(),
        };
        // "axes.ratio numerator" has a key and a part of its value.
        match key.split_once(' ') {
            Some((key, part)) => {
                let sentence = range::sentence(key, error.problem, None);
                Self::for_key(key, format!("{part} {sentence}"))
            }
            None => Self::from_problem(key, error.problem),
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut whole = self.origin.clone();
        if let Some(line) = self.line {
            whole.push_str(&format!(":{line}"));
        }
        if !self.key.is_empty() {
            let axis = self.axis.map(|axis| format!("axis {axis}"));
            whole.push_str(&format!(": {}", entry::place(&self.key, axis.as_deref())));
        }
        // Parts of the message come from the file, which may contain control characters. A message is one line per error.
        for c in format!("{whole}: {}", self.problem).chars() {
            if c.is_control() {
                write!(f, "{}", c.escape_default())?;
            } else {
                write!(f, "{c}")?;
            }
        }
        self.others
            .iter()
            .try_for_each(|other| write!(f, "\n{other}"))
    }
}

impl std::error::Error for SceneError {}

/// Checks that a value lies within its range, ends included.
///
/// # Errors
/// The value is out of its range. The error names the key and the range.
pub fn in_range(key: &str, value: f64, low: f64, high: f64) -> Result<(), SceneError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(SceneError::from_problem(
        key,
        Problem::out_of_range(value, low, high),
    ))
}
