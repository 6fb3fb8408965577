//! What the two slots hold.

use crate::codec::verify_payload;
use crate::{Header, SettingsFileError};

/// One of the two slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slot {
    /// The first.
    A,
    /// The second.
    B,
}

impl Slot {
    /// The one that this is not.
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
    /// It is whole. Whether its version can be decoded has not been asked.
    Stored {
        /// Where it is.
        slot: Slot,
        /// What it says of itself.
        header: Header,
    },
    /// Its header is whole, and its payload is not.
    Corrupt {
        /// Where it is.
        slot: Slot,
        /// What is wrong.
        error: SettingsFileError,
    },
}

/// Looks at both slots, each as a slice of its whole length.
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

/// The newer of two committed slots.
pub(super) fn newer(a: Option<Header>, b: Option<Header>) -> Option<(Slot, Header)> {
    match (a, b) {
        (Some(a), Some(b)) if b.is_newer_than(&a) => Some((Slot::B, b)),
        (Some(a), _) => Some((Slot::A, a)),
        (None, b) => b.map(|b| (Slot::B, b)),
    }
}

/// The settings file at the beginning of a slot, without what lies behind it: what [`crate::decode`] takes.
///
/// # Errors
/// The header cannot be read, or says more than the slot holds.
pub fn settings_file_in(slot: &[u8]) -> Result<&[u8], SettingsFileError> {
    let header = Header::read(slot)?;
    verify_payload(&header, slot)?;
    Ok(&slot[..header.file_bytes() as usize])
}
