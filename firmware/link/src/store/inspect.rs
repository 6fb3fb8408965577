//! Contents of the two slots.

use crate::codec::verify_payload;
use crate::{Header, SettingsFileError};

/// One of the two slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slot {
    /// The first slot.
    A,
    /// The second slot.
    B,
}

impl Slot {
    /// Returns the other slot.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// The newest committed settings file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Newest {
    /// No slot holds one.
    None,
    /// The file is intact. Its version may still be unknown.
    Stored {
        /// Slot of the file.
        slot: Slot,
        /// Header of the file.
        header: Header,
    },
    /// The header is intact, and the payload is not.
    Corrupt {
        /// Slot of the file.
        slot: Slot,
        /// Problem with the payload.
        error: SettingsFileError,
    },
}

/// Finds the newest settings file in both slots, each given as a slice of its whole length.
pub fn inspect(slot_a: &[u8], slot_b: &[u8]) -> Newest {
    let header = |slot| Header::read(slot).ok();
    let Some((slot, header)) = newer(header(slot_a), header(slot_b)) else {
        return Newest::None;
    };
    let bytes = match slot {
        Slot::A => slot_a,
        Slot::B => slot_b,
    };
    match verify_payload(&header, bytes) {
        Ok(()) => Newest::Stored { slot, header },
        Err(error) => Newest::Corrupt { slot, error },
    }
}

/// Selects the newer of two committed slots.
pub(super) fn newer(a: Option<Header>, b: Option<Header>) -> Option<(Slot, Header)> {
    match (a, b) {
        (Some(a), Some(b)) if b.is_newer_than(&a) => Some((Slot::B, b)),
        (Some(a), _) => Some((Slot::A, a)),
        (None, b) => b.map(|b| (Slot::B, b)),
    }
}

/// Returns the settings file at the beginning of a slot, without the bytes behind it, as [`crate::decode`] takes it.
///
/// # Errors
/// The header cannot be read, or the payload is not intact within the slot.
pub fn settings_file_in(slot: &[u8]) -> Result<&[u8], SettingsFileError> {
    let header = Header::read(slot)?;
    verify_payload(&header, slot)?;
    Ok(&slot[..header.file_bytes() as usize])
}
