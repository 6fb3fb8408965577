//! Names of the functions at code addresses: the linked one, and those that were inlined into it there.

use std::io::Write;
use std::path::Path;

use addr2line::Context;
use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian, SectionId};
use object::{Object, ObjectSection};

use crate::error::{self, Error};
use crate::image::Image;
use crate::name;

/// The command: for each address, a line of names with tabs between them. The linked function comes first; then
/// the functions inlined at that address, the outermost first. Generic arguments are left out.
///
/// Addresses are hexadecimal, one a line. An address outside of every function has the name `?`.
///
/// # Errors
/// Files that cannot be read, an ELF file with broken debug information, a line that is no address.
pub fn print(elf: &Path, addresses: &Path) -> Result<bool, Error> {
    let image = Image::read(elf)?;
    let bytes = error::read(elf)?;
    let problem = |error: &dyn std::fmt::Display| Error::content(elf, error);
    let file = object::File::parse(bytes.as_slice()).map_err(|e| problem(&e))?;
    let section = |id: SectionId| -> Result<_, object::Error> {
        let section = file.section_by_name(id.name());
        let data = section.map(|section| section.data()).transpose()?;
        Ok(EndianSlice::new(data.unwrap_or_default(), LittleEndian))
    };
    let dwarf = Dwarf::load(section).map_err(|e| problem(&e))?;
    let context = Context::from_dwarf(dwarf).map_err(|e| problem(&e))?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    for line in error::read_text(addresses)?.lines() {
        let address = u32::from_str_radix(line.trim_start_matches("0x"), 16)
            .map_err(|e| Error::content(addresses, format!("{line}: {e}")))?;
        let linked = image.function_around(address);
        let first = linked.map_or("?", |function| &image.functions[function].names[0]);
        write!(out, "{}", name::plain(first))?;
        for inlined in inlined(&context, address).map_err(|e| problem(&e))? {
            write!(out, "\t{}", name::plain(&inlined))?;
        }
        writeln!(out)?;
    }
    out.flush()?;
    Ok(true)
}

/// Functions inlined at an address, the outermost first; the linked function is not among them.
fn inlined(
    context: &Context<EndianSlice<'_, LittleEndian>>,
    address: u32,
) -> Result<Vec<String>, addr2line::gimli::Error> {
    let mut frames = context.find_frames(address.into()).skip_all_loads()?;
    let mut names = Vec::new();
    while let Some(frame) = frames.next()? {
        names.push(match frame.function {
            Some(function) => format!("{:#}", rustc_demangle::demangle(&function.raw_name()?)),
            None => "?".to_owned(),
        });
    }
    names.pop();
    names.reverse();
    Ok(names)
}
