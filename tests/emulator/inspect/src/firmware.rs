//! The firmware's ELF file: its sections, its functions, and which of its words are code.
//!
//! Words: *mapping symbols* are `$t` and `$d`, by which the ELF for Arm separates code from the data in between
//! (literal pools and jump tables).

use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionIndex, SymbolKind, elf};

use crate::error::{self, Error};

/// A section that uses memory of the chip.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its place in the file's list.
    index: SectionIndex,
    /// Kind of memory that it uses.
    pub kind: Kind,
    /// Address of the section for the program.
    pub address: u32,
    /// Its size in bytes.
    pub size: u32,
    /// Its content; empty where the file has none.
    bytes: Vec<u8>,
    /// Mapping symbols: the addresses from which there is code, or none.
    marks: Vec<(u32, bool)>,
}

/// Kind of memory that a section uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Code in flash.
    Text,
    /// Constants in flash.
    Constants,
    /// In RAM, with its initial content in flash. Code that runs from RAM is there too.
    Data,
    /// In RAM, cleared or left as it is.
    Bss,
}

/// A function: its code from one symbol on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Its names, demangled; several where functions of the same code were merged.
    pub names: Vec<String>,
    /// Address of its first instruction.
    pub address: u32,
    /// Address after its last byte, literal pools included.
    pub end: u32,
    /// Its place in [`Firmware::sections`].
    pub section: usize,
}

/// A variable in RAM.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Its name, demangled.
    pub name: String,
    /// Its size in bytes.
    pub size: u32,
}

/// The firmware's ELF file.
#[derive(Clone, Debug)]
pub struct Firmware {
    /// Sections that use memory of the chip.
    pub sections: Vec<Section>,
    /// Functions by section and address.
    pub functions: Vec<Function>,
    /// Variables in RAM.
    pub variables: Vec<Variable>,
}

impl Firmware {
    /// Reads the file.
    ///
    /// # Errors
    /// A file that cannot be read, or that is no ELF file for a little-endian 32-bit Arm.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = error::read(path)?;
        let problem = |error| Error::content(path, error);
        let file = object::File::parse(bytes.as_slice()).map_err(problem)?;
        if file.format() != object::BinaryFormat::Elf
            || file.architecture() != object::Architecture::Arm
            || !file.is_little_endian()
        {
            return Err(Error::content(
                path,
                "is no ELF file for a little-endian Arm",
            ));
        }
        let mut sections = Vec::new();
        for section in file.sections() {
            if let Some(kind) = kind(&section) {
                sections.push(Section {
                    index: section.index(),
                    kind,
                    address: section.address() as u32,
                    size: section.size() as u32,
                    bytes: section.data().map_err(problem)?.to_vec(),
                    marks: Vec::new(),
                });
            }
        }
        let mut firmware = Self {
            sections,
            functions: Vec::new(),
            variables: Vec::new(),
        };
        for symbol in file.symbols() {
            let place = symbol.section_index();
            let section = firmware
                .sections
                .iter()
                .position(|s| Some(s.index) == place);
            if let (Some(section), Ok(name)) = (section, symbol.name()) {
                firmware.take(section, name, &symbol);
            }
        }
        firmware.settle();
        Ok(firmware)
    }

    fn take<'a>(&mut self, section: usize, name: &str, symbol: &impl ObjectSymbol<'a>) {
        let (address, size) = (symbol.address() as u32, symbol.size() as u32);
        let place = &mut self.sections[section];
        if let Some(code) = mark(name) {
            place.marks.push((address, code));
        } else if symbol.kind() == SymbolKind::Text {
            let address = address & !1; // bit 0 marks Thumb code
            self.functions.push(Function {
                names: vec![demangled(name)],
                address,
                end: address.saturating_add(size),
                section,
            });
        } else if matches!(place.kind, Kind::Data | Kind::Bss) && size > 0 {
            let name = demangled(name);
            self.variables.push(Variable { name, size });
        }
    }

    /// Sorts the functions: one function an address, and an end for those whose symbols have no size.
    fn settle(&mut self) {
        for section in &mut self.sections {
            section.marks.sort_unstable();
        }
        self.functions.sort_by_key(|f| (f.section, f.address));
        self.functions.dedup_by(|later, first| {
            let same = (later.section, later.address) == (first.section, first.address);
            if same {
                first.end = first.end.max(later.end);
                first.names.append(&mut later.names);
            }
            same
        });
        for i in 0..self.functions.len() {
            let next = self.functions.get(i + 1).map(|f| (f.section, f.address));
            let function = &mut self.functions[i];
            if function.end == function.address {
                let section = &self.sections[function.section];
                function.end = match next {
                    Some((section, address)) if section == function.section => address,
                    _ => section.address + section.size,
                };
            }
        }
    }

    /// The function that begins at an address.
    pub fn function_at(&self, address: u32) -> Option<usize> {
        self.functions.iter().position(|f| f.address == address)
    }

    /// The function to whose code an address belongs.
    pub fn function_around(&self, address: u32) -> Option<usize> {
        let around = |f: &Function| (f.address..f.end).contains(&address);
        self.function_at(address)
            .or_else(|| self.functions.iter().rposition(around))
    }
}

impl Section {
    /// The halfword at an address.
    pub fn halfword(&self, address: u32) -> Option<u16> {
        let at = address.checked_sub(self.address)? as usize;
        let bytes = self.bytes.get(at..at + 2)?;
        Some(u16::from_le_bytes([bytes[0], bytes[1]]))
    }

    /// The word at an address.
    pub fn word(&self, address: u32) -> Option<u32> {
        let low = self.halfword(address)?;
        let high = self.halfword(address.checked_add(2)?)?;
        Some(u32::from(low) | u32::from(high) << 16)
    }

    /// True if an address holds code; without a mapping symbol before it, it does.
    pub fn is_code(&self, address: u32) -> bool {
        let marks = self.marks.partition_point(|&(at, _)| at <= address);
        marks == 0 || self.marks[marks - 1].1
    }
}

impl Function {
    /// All its names.
    pub fn name(&self) -> String {
        self.names.join(" = ")
    }
}

/// True if an address is in the chip's RAM.
pub fn in_ram(address: u32) -> bool {
    address >> 28 == 2
}

/// None if the section uses no memory of the chip.
fn kind<'a>(section: &impl ObjectSection<'a>) -> Option<Kind> {
    let SectionFlags::Elf { sh_flags, sh_type } = section.flags() else {
        return None;
    };
    let has = |flag: elf::SectionFlags| sh_flags.0 & flag.0 != 0;
    if !has(elf::SHF_ALLOC) {
        None
    } else if sh_type == elf::SHT_NOBITS {
        Some(Kind::Bss)
    } else if has(elf::SHF_WRITE) || in_ram(section.address() as u32) {
        Some(Kind::Data)
    } else if has(elf::SHF_EXECINSTR) {
        Some(Kind::Text)
    } else {
        Some(Kind::Constants)
    }
}

/// Recognizes a mapping symbol by its name; true if code follows it.
fn mark(name: &str) -> Option<bool> {
    match name.split('.').next() {
        Some("$t") => Some(true),
        Some("$d") => Some(false),
        _ => None,
    }
}

fn demangled(name: &str) -> String {
    format!("{:#}", rustc_demangle::demangle(name))
}
