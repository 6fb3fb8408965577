//! Page of text that a design prints: a row for each figure.

use std::io::{self, Write};

/// Writes a row: name, value, and a note that may be empty.
pub(super) fn row(out: &mut dyn Write, what: &str, value: &str, note: &str) -> io::Result<()> {
    let row = format!("   {what:<40}{value:>10}  {note}");
    writeln!(out, "{}", row.trim_end())
}
