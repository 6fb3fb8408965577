//! Choice of the settings file that the firmware runs.

use super::{Newest, Slot};
use crate::header::OUTSIDE;
use crate::{Header, SettingsFileError};

/// Settings to run at power-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Choice {
    /// Run the built-in settings, and store them.
    BuiltIn,
    /// Run the settings stored in this slot.
    Stored(Slot),
    /// Run nothing, as the settings in this slot are corrupt.
    Refuse(Slot, SettingsFileError),
}

/// Chooses between the built-in and the stored settings.
///
/// A file that was placed from outside runs until it is removed. A file that firmware stored runs on firmware with the
/// same built-in settings. Firmware with other built-in settings was flashed later, and runs its own.
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
