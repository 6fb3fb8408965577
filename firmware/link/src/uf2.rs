//! UF2: the file that a board's boot drive takes by drag and drop (microsoft/uf2, "UF2 file format").
//!
//! A file is a list of blocks of 512 bytes. Each has 256 bytes for one page of the flash, and their address.

/// First words of a block, and its last.
const MAGIC: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const MAGIC_END: u32 = 0x0AB1_6F30;

/// Flag: the word after the numbers is the family of the chip.
const HAS_FAMILY: u32 = 0x2000;

/// Family of the RP2040.
const RP2040: u32 = 0xE48B_FF56;

/// Length of a block, bytes.
pub const BLOCK_BYTES: usize = 512;

/// Length of a page of the flash, bytes.
pub const PAGE_BYTES: usize = 256;

/// Offset of the page in a block.
const PAGE_AT: usize = 32;

/// True if bytes are those of a UF2 file.
pub fn is_uf2(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC[0].to_le_bytes())
}

/// Block that places a page of up to [`PAGE_BYTES`] bytes at an address of an RP2040's flash; the rest of the page is 0xFF.
/// It is block `number`, counted from 0, of `count`.
pub fn block(address: u32, page: &[u8], number: u32, count: u32) -> [u8; BLOCK_BYTES] {
    let mut block = [0; BLOCK_BYTES];
    let head = [
        MAGIC[0],
        MAGIC[1],
        HAS_FAMILY,
        address,
        PAGE_BYTES as u32,
        number,
        count,
        RP2040,
    ];
    for (place, word) in block.chunks_mut(4).zip(head) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    let length = page.len().min(PAGE_BYTES);
    block[PAGE_AT..PAGE_AT + PAGE_BYTES].fill(0xFF);
    block[PAGE_AT..PAGE_AT + length].copy_from_slice(&page[..length]);
    block[BLOCK_BYTES - 4..].copy_from_slice(&MAGIC_END.to_le_bytes());
    block
}
