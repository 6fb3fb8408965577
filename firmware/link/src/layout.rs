//! Location of the two slots in the board's flash: the last 64 KiB of 2 MiB.
//!
//! The linker map (`memory.x`) ends the program's flash below them, and `docs/settings-file.md` names the addresses.

use crate::file_format::MAX_FILE_BYTES;

/// Size of the board's flash, bytes.
pub const FLASH_BYTES: u32 = 2 << 20;

/// Address at which the RP2040 maps its flash.
pub const FLASH_ADDRESS: u32 = 0x1000_0000;

/// Smallest part of the flash that can be erased, bytes.
pub const ERASE_BYTES: u32 = 4096;

/// Length of a slot, bytes.
pub const SLOT_BYTES: u32 = 32 << 10;

/// Offset of the first slot, bytes from the beginning of the flash.
pub const SLOT_A_OFFSET: u32 = FLASH_BYTES - 2 * SLOT_BYTES;

/// Offset of the second slot, bytes from the beginning of the flash.
pub const SLOT_B_OFFSET: u32 = SLOT_A_OFFSET + SLOT_BYTES;

const _: () = {
    assert!(SLOT_A_OFFSET == 0x1F_0000 && SLOT_B_OFFSET == 0x1F_8000); // as documented
    assert!(MAX_FILE_BYTES <= SLOT_BYTES as usize);
    assert!(SLOT_BYTES.is_multiple_of(ERASE_BYTES));
};
