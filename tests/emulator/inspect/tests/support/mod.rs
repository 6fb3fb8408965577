//! ELF files that are built here from bytes and names, so that no binary is stored.
#![allow(dead_code, reason = "each test uses a part of it")]

pub mod code;

use std::path::{Path, PathBuf};
use std::process::Output;

use object::write::{Object, SectionId, Symbol, SymbolSection};
use object::{
    Architecture, BinaryFormat, Endianness, SectionKind, SymbolFlags, SymbolKind, SymbolScope,
};

/// An ELF file under construction. Its sections all begin at address 0: object files have no other
/// addresses.
pub struct Elf {
    object: Object<'static>,
}

impl Elf {
    pub fn new() -> Self {
        let (format, architecture) = (BinaryFormat::Elf, Architecture::Arm);
        Self {
            object: Object::new(format, architecture, Endianness::Little),
        }
    }

    pub fn section(&mut self, name: &str, kind: SectionKind, bytes: &[u8]) -> SectionId {
        let section = self.object.add_section(Vec::new(), name.into(), kind);
        self.object.append_section_data(section, bytes, 4);
        section
    }

    /// A section of so many bytes that are not in the file.
    pub fn empty_section(&mut self, name: &str, size: u64) -> SectionId {
        let section =
            self.object
                .add_section(Vec::new(), name.into(), SectionKind::UninitializedData);
        self.object.append_section_bss(section, size, 4);
        section
    }

    pub fn symbol(
        &mut self,
        section: SectionId,
        name: &str,
        kind: SymbolKind,
        value: u64,
        size: u64,
    ) {
        self.object.add_symbol(Symbol {
            name: name.into(),
            value,
            size,
            kind,
            scope: SymbolScope::Compilation,
            weak: false,
            section: SymbolSection::Section(section),
            flags: SymbolFlags::None,
        });
    }

    pub fn write(&self, dir: &Path) -> PathBuf {
        let path = dir.join("image.elf");
        std::fs::write(&path, self.object.write().unwrap()).unwrap();
        path
    }
}

/// Runs `firmware-inspect` with these arguments and this input.
pub fn inspect(arguments: &[&str], input: &[u8]) -> Output {
    assert_cmd::Command::new(env!("CARGO_BIN_EXE_firmware-inspect"))
        .args(arguments)
        .write_stdin(input)
        .output()
        .unwrap()
}

/// Exit status, standard output and standard error.
pub fn said(output: &Output) -> (i32, String, String) {
    (
        output.status.code().unwrap(),
        String::from_utf8(output.stdout.clone()).unwrap(),
        String::from_utf8(output.stderr.clone()).unwrap(),
    )
}
