//! What can be wrong with a scene, and where.

use std::fmt;

use cophase_core::settings::{Problem, SettingsError};

use super::{entry, range};

/// Something wrong with a scene: in which file, at which key, what, and what would be right.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// The file, or the name of a built-in scene.
    pub origin: String,
    /// Line in the file, where it is known, counted from 1.
    pub line: Option<usize>,
    /// The key, as a path like `limits.speed_hz` or `axis[1].number`; empty if it is the file as a whole.
    pub key: String,
    /// The axis of the `[[axis]]` entry that the key is in, where it is known; it is not the place of the entry.
    pub axis: Option<u8>,
    /// What is wrong, and what would be right.
    pub problem: String,
    /// What else is wrong, in the order of its lines.
    pub others: Vec<SceneError>,
}

impl SceneError {
    /// An error at a key; the origin is filled in by whoever knows it.
    pub fn at(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Self {
            origin: String::new(),
            line: None,
            key: key.into(),
            axis: None,
            problem: problem.into(),
            others: Vec::new(),
        }
    }

    /// Several errors of a file, as one.
    pub(super) fn together(mut errors: Vec<Self>) -> Option<Self> {
        // What stands on no line is missing: at the end.
        errors.sort_by_key(|error| error.line.unwrap_or(usize::MAX));
        let others = errors.split_off(errors.len().min(1));
        let first = errors.pop()?;
        Some(Self { others, ..first })
    }

    /// One of the core's problems, at a key: with the unit that the key carries, and what to give instead of a value out of its range.
    pub fn of(key: impl Into<String>, problem: Problem) -> Self {
        let key = key.into();
        let sentence = range::sentence(&key, problem, range::reason(&key));
        Self::at(key, sentence)
    }

    /// The same, of a file.
    #[must_use]
    pub fn in_file(mut self, origin: &str) -> Self {
        self.origin = origin.to_owned();
        let others = std::mem::take(&mut self.others).into_iter();
        self.others = others.map(|other| other.in_file(origin)).collect();
        self
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
        // "axes.ratio numerator": a key, and which part of its value.
        match key.split_once(' ') {
            Some((key, part)) => {
                let sentence = range::sentence(key, error.problem, None);
                Self::at(key, format!("{part} {sentence}"))
            }
            None => Self::of(key, error.problem),
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
        // Part of it comes from the file, which may hold anything: a message is one line an error, and moves no cursor.
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
