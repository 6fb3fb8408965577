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

const BLOCK_BYTES: usize = 512;
const PAGE_BYTES: usize = 256;

/// True if bytes are those of a UF2 file.
pub(crate) fn is_uf2(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC[0].to_le_bytes())
}

/// UF2 file for an RP2040 that places `bytes` at each of some addresses. The rest of the last page is 0xFF.
pub(crate) fn file(bytes: &[u8], addresses: &[u32]) -> Vec<u8> {
    let pages = bytes.len().div_ceil(PAGE_BYTES);
    let count = (pages * addresses.len()) as u32;
    let mut all = Vec::with_capacity(count as usize * BLOCK_BYTES);
    let placed = addresses.iter().flat_map(|start| {
        let pages = (*start..).step_by(PAGE_BYTES);
        pages.zip(bytes.chunks(PAGE_BYTES))
    });
    for (number, (address, page)) in (0..).zip(placed) {
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
        let start = all.len();
        all.extend(head.iter().flat_map(|word| word.to_le_bytes()));
        all.extend(page);
        all.resize(start + 32 + PAGE_BYTES, 0xFF);
        all.resize(start + BLOCK_BYTES - 4, 0);
        all.extend(MAGIC_END.to_le_bytes());
    }
    all
}
