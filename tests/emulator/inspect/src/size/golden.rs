//! Figures that are stored with the code, a line each: `flash_bytes = 48120`.

use std::collections::BTreeMap;
use std::fmt::{self, Write};
use std::path::Path;

use crate::error::{self, Error};

/// Growth of a figure, in percent, above which it must be blessed.
const MAX_GROWTH: u64 = 5;

/// Shrinkage of a figure, in percent, above which it must be blessed, so that it cannot grow back
/// unnoticed.
const MAX_SHRINKAGE: u64 = 20;

/// Changes of fewer bytes are ignored, whatever their percentage: small figures vary by a few
/// words.
const MIN_CHANGE: u64 = 64;

/// The figures by their names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Golden(BTreeMap<String, u64>);

/// A figure that has changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    name: &'static str,
    was: Option<u64>,
    is: u64,
}

impl Golden {
    /// Reads the file.
    ///
    /// # Errors
    /// A file that cannot be read, or that holds anything but figures.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = error::read_text(path)?;
        let figures = toml::from_str(&text).map_err(|error| Error::content(path, error))?;
        Ok(Self(figures))
    }

    /// Rewrites the file. Figures that were not measured this time stay as they were.
    ///
    /// # Errors
    /// A file that cannot be written, or that held anything but figures.
    pub fn bless(path: &Path, figures: &[(&'static str, u64)]) -> Result<(), Error> {
        let mut golden = if path.exists() {
            Self::read(path)?
        } else {
            Self(BTreeMap::new())
        };
        golden
            .0
            .extend(figures.iter().map(|&(name, is)| (name.to_owned(), is)));
        let mut text = String::from(
            "# Size of the firmware, bytes, and with how many axes the stack is deepest. Written by `firmware-inspect size --bless`.\n",
        );
        for (name, figure) in &golden.0 {
            let _ = writeln!(text, "{name} = {figure}"); // writing to a string cannot fail
        }
        std::fs::write(path, text).map_err(|error| Error::File {
            path: path.to_owned(),
            error,
        })
    }

    /// The figures that have changed.
    pub fn compare(&self, figures: &[(&'static str, u64)]) -> Vec<Change> {
        let change = |&(name, is): &(&'static str, u64)| {
            let was = self.0.get(name).copied();
            was.is_none_or(|was| differs(was, is))
                .then_some(Change { name, was, is })
        };
        figures.iter().filter_map(change).collect()
    }
}

fn differs(was: u64, is: u64) -> bool {
    let max = was.saturating_add(was.saturating_mul(MAX_GROWTH) / 100);
    let min = was - was.saturating_mul(MAX_SHRINKAGE) / 100;
    is.abs_diff(was) >= MIN_CHANGE && !(min..=max).contains(&is)
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, was, is } = self;
        let Some(was) = *was else {
            return write!(f, "{name}: is {is} and was never kept");
        };
        if was == 0 {
            return write!(f, "{name}: grew from 0 to {is}");
        }
        let percent = (*is as f64 / was as f64 - 1.0) * 100.0;
        let (verb, max) = if *is > was {
            ("grew", MAX_GROWTH)
        } else {
            ("shrank", MAX_SHRINKAGE)
        };
        write!(
            f,
            "{name}: {verb} from {was} to {is}, by {:.1} %; up to {max} % goes unremarked",
            percent.abs()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_differs_beyond_its_margins_only() {
        for (was, is, expected) in [
            (10_000, 10_500, false),
            (10_000, 10_501, true),
            (10_000, 8000, false),
            (10_000, 7999, true),
            (100, 163, false), // below 64 bytes
            (100, 164, true),
            (0, 63, false),
            (0, 64, true),
        ] {
            assert_eq!(differs(was, is), expected, "{was} to {is}");
        }
    }
}
