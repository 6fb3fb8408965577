//! Storage of a settings file so that no power cut can lose the one before it.
//!
//! The slot that is not newest is erased. The payload is written and read back, and then the header, which commits it.
//! Until that page is complete, the newest file does not change. Each page is written once between two erases, as the
//! traits of `embedded-storage` require.

use embedded_storage::nor_flash::{NorFlash, NorFlashError, NorFlashErrorKind};

use super::Slot;
use super::inspect::newer;
use crate::codec::verify;
use crate::file_format::HEADER_BYTES;
use crate::header::FIRST_SEQUENCE;
use crate::{Header, SettingsFileError};

const PAGE_BYTES: usize = HEADER_BYTES;

/// Writer of two slots in a flash. [`inspect`](super::inspect()) reads them.
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    offsets: [u32; 2],
    slot_bytes: u32,
}

/// Reason why a settings file was not stored. The newest file is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError {
    /// The locations of the slots are not usable.
    #[error("the slots overlap, are not whole sectors, or not inside the flash")]
    Layout,
    /// The bytes to be stored are not a settings file.
    #[error("not stored: {0}")]
    SettingsFile(#[from] SettingsFileError),
    /// The settings file is longer than a slot.
    #[error("not stored: a settings file of {bytes} bytes does not fit a slot of {slot_bytes}")]
    SlotTooSmall {
        /// Length of the file.
        bytes: u32,
        /// Length of the slot.
        slot_bytes: u32,
    },
    /// The flash reported an error.
    #[error("not stored: {0}")]
    Flash(NorFlashErrorKind),
    /// A page does not read back as written.
    #[error("not stored: flash at {offset:#x} does not read back as written; it may be worn out")]
    ReadBack {
        /// Offset of the page from the beginning of the flash.
        offset: u32,
    },
}

impl<F: NorFlash> Store<F> {
    /// Writer of slots of `slot_bytes` at two offsets from the beginning of the flash.
    ///
    /// # Errors
    /// [`StoreError::Layout`] if the slots overlap, are not whole sectors, or do not lie inside the flash.
    pub fn new(flash: F, slot_a: u32, slot_b: u32, slot_bytes: u32) -> Result<Self, StoreError> {
        const {
            assert!(
                PAGE_BYTES.is_multiple_of(F::WRITE_SIZE) && PAGE_BYTES.is_multiple_of(F::READ_SIZE)
            );
            assert!(F::ERASE_SIZE.is_multiple_of(PAGE_BYTES));
        }
        let capacity = u32::try_from(flash.capacity()).unwrap_or(u32::MAX);
        let sector = F::ERASE_SIZE as u32;
        let fits = |offset: u32| {
            offset.is_multiple_of(sector)
                && offset
                    .checked_add(slot_bytes)
                    .is_some_and(|end| end <= capacity)
        };
        let apart = slot_a.abs_diff(slot_b) >= slot_bytes;
        if !(fits(slot_a)
            && fits(slot_b)
            && apart
            && slot_bytes.is_multiple_of(sector)
            && slot_bytes > 0)
        {
            return Err(StoreError::Layout);
        }
        Ok(Self {
            flash,
            offsets: [slot_a, slot_b],
            slot_bytes,
        })
    }

    /// Stores a settings file as the newest, and returns its slot and its header there.
    ///
    /// The header gets this `origin` (see [`Header::origin`]) and the next sequence number; those in the given file are
    /// ignored. On a board this takes some tenths of a second, in which nothing can be read from the flash.
    ///
    /// # Errors
    /// Nothing was stored, for the given reason.
    pub fn save(
        &mut self,
        settings_file: &[u8],
        origin: u32,
    ) -> Result<(Slot, Header), StoreError> {
        let given = verify(settings_file)?;
        let bytes = given.file_bytes();
        if bytes > self.slot_bytes {
            let slot_bytes = self.slot_bytes;
            return Err(StoreError::SlotTooSmall { bytes, slot_bytes });
        }
        let newest = newer(self.header(Slot::A)?, self.header(Slot::B)?);
        let (slot, sequence) = match newest {
            Some((slot, header)) => (slot.other(), header.sequence.wrapping_add(1)),
            None => (Slot::A, FIRST_SEQUENCE),
        };
        let header = Header {
            sequence,
            origin,
            ..given
        };
        let start = self.offset(slot);
        // A power cut may leave the old header of this slot, at most. The slot then remains the older one.
        let end = start + bytes.next_multiple_of(F::ERASE_SIZE as u32);
        self.flash.erase(start, end).map_err(refused)?;
        let payload = &settings_file[HEADER_BYTES..];
        for (offset, page) in (start..)
            .step_by(PAGE_BYTES)
            .skip(1)
            .zip(payload.chunks(PAGE_BYTES))
        {
            self.write(offset, page)?;
        }
        self.write(start, &header.page())?;
        Ok((slot, header))
    }

    /// Returns the flash.
    pub fn into_flash(self) -> F {
        self.flash
    }

    const fn offset(&self, slot: Slot) -> u32 {
        self.offsets[slot as usize]
    }

    /// Header that a slot has committed, if any.
    fn header(&mut self, slot: Slot) -> Result<Option<Header>, StoreError> {
        let mut page = [0; PAGE_BYTES];
        self.flash
            .read(self.offset(slot), &mut page)
            .map_err(refused)?;
        Ok(Header::read(&page).ok())
    }

    /// Writes a page, or the beginning of one, and reads it back.
    ///
    /// The page goes through RAM. On a board the settings file may lie in the same flash, which cannot be read while it
    /// is written.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), StoreError> {
        let mut page = [0xFF; PAGE_BYTES];
        page[..bytes.len()].copy_from_slice(bytes);
        self.flash.write(offset, &page).map_err(refused)?;
        let mut back = [0; PAGE_BYTES];
        self.flash.read(offset, &mut back).map_err(refused)?;
        if back == page {
            Ok(())
        } else {
            Err(StoreError::ReadBack { offset })
        }
    }
}

fn refused(error: impl NorFlashError) -> StoreError {
    StoreError::Flash(error.kind())
}
