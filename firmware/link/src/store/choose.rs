//! Which settings file the firmware runs.

use super::{Newest, Slot};
use crate::header::OUTSIDE;
use crate::{Header, SettingsFileError};

/// What the firmware is to do when it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Choice {
    /// Run what is built in, and store it.
    BuiltIn,
    /// Run what is stored here.
    Stored(Slot),
    /// Run nothing: what is stored here is corrupt.
    Refuse(Slot, SettingsFileError),
}

/// Chooses between what is built into the firmware and what is stored.
///
/// What was placed from outside is run until it is taken away. What the firmware stored is run by firmware with the
/// same built-in settings file; one with another was flashed since, and brings its own.
pub fn choose(built_in: &Header, newest: &Newest) -> Choice {
    match *newest {
        Newest::None => Choice::BuiltIn,
        Newest::Corrupt { slot, error } => Choice::Refuse(slot, error),
        Newest::Stored { slot, header } => {
            if header.origin == OUTSIDE || header.origin == built_in.mark() {
                Choice::Stored(slot)
            } else {
                Choice::BuiltIn
            }
        }
    }
}
