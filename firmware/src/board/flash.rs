//! Flash as memory.

use cophase_link::layout::{FLASH_ADDRESS, SLOT_A_OFFSET, SLOT_B_OFFSET, SLOT_BYTES};
use cophase_link::store::Slot;

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
