//! Storing a settings file so that no power cut can lose the one before it.
//!
//! The slot that is not newest is erased, the payload is written and read back, and then the header, which
//! commits it. Until that page is whole, the newest settings file is the one it was. Each page is written once between two
//! erases, as the traits of `embedded-storage` ask.

use embedded_storage::nor_flash::{NorFlash, NorFlashError, NorFlashErrorKind};

use super::Slot;
use super::inspect::newer;
use crate::codec::verify;
use crate::header::{FIRST_SEQUENCE, HEADER_BYTES};
use crate::{Header, SettingsFileError};

const PAGE_BYTES: usize = HEADER_BYTES;

/// Two slots of a flash, to be written. For reading them see [`inspect`](super::inspect()).
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    offsets: [u32; 2],
    slot_bytes: u32,
}

/// Why a settings file was not stored. The newest settings file is the one it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError {
    /// The slots cannot be where they are said to be.
    #[error("the slots overlap, are not whole sectors, or not inside the flash")]
    Layout,
    /// What is to be stored is no settings file.
    #[error("not stored: {0}")]
    SettingsFile(#[from] SettingsFileError),
    /// It is longer than a slot.
    #[error("not stored: a settings file of {bytes} bytes does not fit a slot of {slot_bytes}")]
    SlotTooSmall {
        /// Of the settings file.
        bytes: u32,
        /// Of the slot.
        slot_bytes: u32,
    },
    /// The flash refused.
    #[error("not stored: {0}")]
    Flash(NorFlashErrorKind),
    /// What was written does not read back.
    #[error(
        "not stored: flash at {offset:#x} reads otherwise than it was written; it may be worn out"
    )]
    ReadBack {
        /// The page, from the flash's beginning.
        offset: u32,
    },
}

impl<F: NorFlash> Store<F> {
    /// Slots of `slot_bytes` at two offsets from the flash's beginning.
    ///
    /// # Errors
    /// [`StoreError::Layout`].
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

    /// Stores a settings file as the newest, with this `origin` (see [`Header::origin`]) and the next sequence number;
    /// those in `settings_file` do not matter. Gives where it is, and its header there.
    ///
    /// On a board this takes some tenths of a second, in which nothing can be read from the flash.
    ///
    /// # Errors
    /// Nothing was stored, and why.
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
        // Whatever a power cut leaves of the older slot, at most its own header: it stays the older.
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

    /// The flash, given back.
    pub fn into_flash(self) -> F {
        self.flash
    }

    const fn offset(&self, slot: Slot) -> u32 {
        self.offsets[slot as usize]
    }

    /// What a slot has committed.
    fn header(&mut self, slot: Slot) -> Result<Option<Header>, StoreError> {
        let mut page = [0; PAGE_BYTES];
        self.flash
            .read(self.offset(slot), &mut page)
            .map_err(refused)?;
        Ok(Header::read(&page).ok())
    }

    /// Writes a page, or the beginning of one, and reads it back. By way of RAM: on a board the settings file may lie in
    /// the flash that is written, and cannot be read from there meanwhile.
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
