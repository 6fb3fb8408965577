//! Flash as memory, and its serial number.

use cophase_link::layout::{FLASH_ADDRESS, FLASH_BYTES, SLOT_A_OFFSET, SLOT_B_OFFSET, SLOT_BYTES};
use cophase_link::store::Slot;
use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, Flash};
use embassy_rp::peripherals::FLASH;

/// Returns a slot for settings.
#[cold]
pub fn slot(slot: Slot) -> &'static [u8] {
    let offset = match slot {
        Slot::A => SLOT_A_OFFSET,
        Slot::B => SLOT_B_OFFSET,
    };
    let start = (FLASH_ADDRESS + offset) as *const u8;
    // SAFETY: all of it is flash, which nothing writes while such a slice is in use. Only `settings::store` writes, and only to the
    // slot that is not the newest; the slice that stays in use is that of the newest. A host can store once per start.
    unsafe { core::slice::from_raw_parts(start, SLOT_BYTES as usize) }
}

/// Reads the serial number of the board: the unique number of its flash chip, as the processor has none. 0 if the chip gives none.
#[cold]
#[inline(never)]
pub fn serial(flash: Peri<'_, FLASH>) -> u64 {
    let mut bytes = [0; 8];
    let mut flash: Flash<'_, _, Blocking, { FLASH_BYTES as usize }> = Flash::new_blocking(flash);
    let read = flash.blocking_unique_id(&mut bytes);
    read.map_or(0, |()| u64::from_be_bytes(bytes))
}
