//! Calls that are known and harmless, each with its reason: a TOML file of entries
//!
//! ```toml
//! [[allow]]
//! from = "cophase_firmware::report::note"  # patterns, as roots are
//! to = "core::panicking::panic"            # or "unknown", for a call through a register; or "trap"
//! reason = "why this cannot happen, or does no harm"
//! calls = []                       # functions it may call instead: bounds a call through a register
//! ```

use std::path::Path;

use serde::Deserialize;

use super::flow::Callee;
use crate::error::{self, Error};
use crate::firmware::Firmware;
use crate::name;

/// The entries, each with whether it was used.
#[derive(Clone, Debug, Default)]
pub struct Allowed {
    entries: Vec<(Entry, Vec<Callee>, bool)>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    allow: Vec<Entry>,
}

/// One entry.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Pattern of the caller.
    pub from: String,
    /// Pattern of the callee.
    pub to: String,
    /// Reason why the call does no harm.
    pub reason: String,
    /// Patterns of the functions that are called instead.
    #[serde(default)]
    pub calls: Vec<String>,
}

impl Allowed {
    /// Reads the file.
    ///
    /// # Errors
    /// A file that cannot be read, an entry without a reason, or one whose `calls` match nothing.
    pub fn read(path: &Path, firmware: &Firmware) -> Result<Self, Error> {
        let text = error::read_text(path)?;
        let file: File = toml::from_str(&text).map_err(|error| Error::content(path, error))?;
        let mut entries = Vec::new();
        for entry in file.allow {
            if entry.reason.trim().is_empty() {
                let problem = format!("the entry from `{}` has no reason; give one", entry.from);
                return Err(Error::content(path, problem));
            }
            let mut instead = Vec::new();
            for pattern in &entry.calls {
                let found = super::find(firmware, pattern);
                if found.is_empty() {
                    let problem = format!("no function's name matches `{pattern}` in calls");
                    return Err(Error::content(path, problem));
                }
                instead.extend(found.into_iter().map(Callee::Function));
            }
            entries.push((entry, instead, false));
        }
        Ok(Self { entries })
    }

    /// The functions called instead, if a call is allowed. Marks the entry as used.
    pub fn take(
        &mut self,
        firmware: &Firmware,
        from: usize,
        callee: Callee,
    ) -> Option<Vec<Callee>> {
        let is = |pattern: &str, function: usize| {
            let names = &firmware.functions[function].names;
            names.iter().any(|name| name::matches(pattern, name))
        };
        let (_, instead, met) = self.entries.iter_mut().find(|(entry, ..)| {
            is(&entry.from, from)
                && match callee {
                    Callee::Function(to) => is(&entry.to, to),
                    Callee::Unknown | Callee::Nowhere(_) => entry.to == "unknown",
                    Callee::Trap => entry.to == "trap",
                }
        })?;
        *met = true;
        Some(instead.clone())
    }

    /// Entries with whether they were used.
    pub fn entries(&self) -> impl Iterator<Item = (&Entry, bool)> {
        self.entries.iter().map(|(entry, _, met)| (entry, *met))
    }
}
