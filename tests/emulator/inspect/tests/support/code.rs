//! Small firmware of Thumb code, assembled from halfwords.

use std::path::PathBuf;

use object::{SectionKind, SymbolKind};
use tempfile::TempDir;

use super::Elf;

/// A function: its name, its code, and the words after it that are data.
pub struct Function {
    name: &'static str,
    code: Vec<Part>,
    data: Vec<Word>,
}

/// A piece of code.
#[derive(Clone, Copy)]
pub enum Part {
    /// A halfword as it is.
    Is(u16),
    /// `bl` to a function.
    Call(&'static str),
    /// `b` to a function.
    Jump(&'static str),
    /// `beq` to a function.
    JumpIf(&'static str),
}

/// A word of data.
#[derive(Clone, Copy)]
pub enum Word {
    Is(u32),
    /// The address of a function in the form for a call through a register.
    Of(&'static str),
}

pub const PUSH_R4_LR: Part = Part::Is(0xb510);
pub const POP_R4_PC: Part = Part::Is(0xbd10);
pub const RETURN: Part = Part::Is(0x4770);
pub const NOP: Part = Part::Is(0xbf00);
/// `blx r3`
pub const CALL_R3: Part = Part::Is(0x4798);

pub fn function(name: &'static str, code: &[Part]) -> Function {
    with_data(name, code, &[])
}

/// The data begin at the next multiple of four.
pub fn with_data(name: &'static str, code: &[Part], data: &[Word]) -> Function {
    Function {
        name,
        code: code.to_vec(),
        data: data.to_vec(),
    }
}

/// Address of the first function. An odd small number is then never the address of a function.
const BASE: u32 = 0x100;

/// Writes the functions one after the other, each at a multiple of four, with their mapping symbols.
pub fn firmware(functions: &[Function]) -> (TempDir, PathBuf) {
    let mut addresses = Vec::new();
    let mut at = BASE;
    for function in functions {
        addresses.push(at);
        at += function.size().next_multiple_of(4);
    }
    let place = |name: &str| {
        let i = functions.iter().position(|f| f.name == name);
        addresses[i.unwrap_or_else(|| panic!("no function {name}"))]
    };
    let mut bytes = vec![0; BASE as usize];
    let mut elf = Elf::new();
    let mut marks = Vec::new();
    for function in functions {
        let start = bytes.len() as u32;
        marks.push(("$t", start));
        for part in &function.code {
            let at = bytes.len() as u32;
            for half in part.encode(at, place) {
                bytes.extend(half.to_le_bytes());
            }
        }
        if !bytes.len().is_multiple_of(4) {
            bytes.extend(0xbf00_u16.to_le_bytes());
        }
        if !function.data.is_empty() {
            marks.push(("$d", bytes.len() as u32));
        }
        for word in &function.data {
            let word = match word {
                Word::Is(word) => *word,
                Word::Of(name) => place(name) | 1,
            };
            bytes.extend(word.to_le_bytes());
        }
        marks.push((function.name, start));
    }
    let place_size = |name: &str| {
        let function = functions.iter().find(|f| f.name == name);
        function.map_or(0, |function| u64::from(function.size()))
    };
    let text = elf.section(".text", SectionKind::Text, &bytes);
    for (name, at) in marks {
        if name.starts_with('$') {
            elf.symbol(text, name, SymbolKind::Label, at.into(), 0);
        } else {
            elf.symbol(
                text,
                name,
                SymbolKind::Text,
                u64::from(at | 1),
                place_size(name),
            );
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let path = elf.write(dir.path());
    (dir, path)
}

impl Function {
    /// The size as compilers give it: with the padding before data, without the padding after the
    /// function.
    fn size(&self) -> u32 {
        let code: u32 = self.code.iter().map(Part::length).sum();
        match self.data.len() as u32 {
            0 => code,
            words => code.next_multiple_of(4) + 4 * words,
        }
    }
}

impl Part {
    fn length(&self) -> u32 {
        if matches!(self, Self::Call(_)) { 4 } else { 2 }
    }

    /// The encodings BL T1, B T2 and B T1 of the reference manual.
    fn encode(self, at: u32, place: impl Fn(&str) -> u32) -> Vec<u16> {
        let offset = |to: &str| place(to) as i32 - at as i32 - 4;
        match self {
            Self::Is(half) => vec![half],
            Self::Call(to) => {
                let offset = offset(to);
                let sign = u16::from(offset < 0);
                // Only near targets: then I1 and I2 are the sign, and J1 and J2 are 1.
                vec![
                    0xf000 | sign << 10 | (offset >> 12 & 0x3ff) as u16,
                    0xf800 | (offset >> 1 & 0x7ff) as u16,
                ]
            }
            Self::Jump(to) => vec![0xe000 | (offset(to) >> 1 & 0x7ff) as u16],
            Self::JumpIf(to) => vec![0xd000 | (offset(to) >> 1 & 0xff) as u16],
        }
    }
}
