//! Program file: the entries of a program, as they are sent to a running controller.
//!
//! The bytes are `program` of the settings, in postcard's format: the number of entries, then the entries.

use cophase_core::problem::SettingsError;
use cophase_core::program::{CAPACITY, EntrySettings, ProgramBuilder};
use cophase_core::settings::Settings;

/// Greatest length of a program file, bytes.
pub const MAX_PROGRAM_BYTES: usize = {
    const SEGMENT: usize = 1 + 3 * 8 + 1;
    2 + CAPACITY * SEGMENT
};

/// Problem with a program file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProgramFileError {
    /// The bytes are no entries of a program.
    #[error("the bytes are no program; use the `cophase` of the firmware's version")]
    Unreadable,
    /// An entry is wrong, or the machine cannot run it.
    #[error("{0}")]
    Entry(#[from] SettingsError),
}

/// Encodes the program of settings at the beginning of `buffer`; returns none if it does not fit.
/// [`MAX_PROGRAM_BYTES`] are always enough.
pub fn encode<'a>(settings: &Settings, buffer: &'a mut [u8]) -> Option<&'a [u8]> {
    let bytes = postcard::to_slice(&settings.program, buffer).ok()?;
    Some(bytes)
}

/// Decodes a program file into the program of a builder. The entries are decoded one by one, as all of them would take
/// 5 KB of stack.
///
/// # Errors
/// The bytes are no program, or the machine cannot run it. The program must then not be used.
#[inline(never)]
pub fn fill(bytes: &[u8], mut builder: ProgramBuilder<'_>) -> Result<(), ProgramFileError> {
    let unreadable = |_| ProgramFileError::Unreadable;
    let (count, mut rest) = postcard::take_from_bytes::<u32>(bytes).map_err(unreadable)?;
    for _ in 0..count {
        let (entry, after) =
            postcard::take_from_bytes::<EntrySettings>(rest).map_err(unreadable)?;
        rest = after;
        let number = builder.here();
        builder
            .entry(&entry)
            .map_err(|error| error.on_entry(number))?;
    }
    if !rest.is_empty() {
        return Err(ProgramFileError::Unreadable);
    }
    builder.finish()?;
    Ok(())
}
