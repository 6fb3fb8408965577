//! The firmware as a file for drag and drop.

use std::collections::BTreeMap;
use std::path::Path;

use cophase_link::uf2::{PAGE_BYTES, block};
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{ElfFile, ProgramHeader};

use crate::error::{self, Error};

/// Writes the firmware as UF2.
///
/// # Errors
/// A file that cannot be read or written, or that is no ELF file of 32 bits.
pub fn convert(elf: &Path, out: &Path) -> Result<bool, Error> {
    let bytes = error::read(elf)?;
    let problem = |error| Error::content(elf, error);
    let file =
        ElfFile::<FileHeader32<object::Endianness>>::parse(bytes.as_slice()).map_err(problem)?;
    let endian = file.endian();
    let mut pages: BTreeMap<u32, [u8; PAGE_BYTES]> = BTreeMap::new();
    for header in file.elf_program_headers() {
        if header.p_type(endian) != PT_LOAD {
            continue;
        }
        let content = header
            .data(endian, bytes.as_slice())
            .map_err(|()| Error::content(elf, "is cut short"))?;
        for (address, &byte) in (header.p_paddr(endian)..).zip(content) {
            let offset = address as usize % PAGE_BYTES;
            let page = pages
                .entry(address - offset as u32)
                .or_insert([0xFF; PAGE_BYTES]);
            page[offset] = byte;
        }
    }
    let count = pages.len() as u32;
    let blocks = (0..).zip(&pages);
    let uf2: Vec<u8> = blocks
        .flat_map(|(number, (&address, page))| block(address, page, number, count))
        .collect();
    std::fs::write(out, uf2).map_err(|error| Error::content(out, error))?;
    println!("{}: {count} pages of {PAGE_BYTES} bytes", out.display());
    Ok(true)
}
