//! The command line.

use std::path::PathBuf;

use clap::Parser;

use crate::error::Error;
use crate::{frames, log, panics, places, size, uf2};

/// Looks into the Cophase firmware.
#[derive(Debug, Parser)]
#[command(version, about)]
pub enum Command {
    /// Decode the log: bytes of the RTT channel to lines
    Log {
        /// The firmware's ELF file
        elf: PathBuf,
        /// The bytes that it logged; `-` reads standard input
        bytes: PathBuf,
        /// Times of the bytes: a line `CYCLE LENGTH` for each piece of them, in order
        #[arg(long, value_name = "STAMPS")]
        cycles: Option<PathBuf>,
        /// One JSON object a line: timestamp, level, message, location
        #[arg(long)]
        json: bool,
    },
    /// Prove that no panic can be reached from functions, and bound their stack
    Panics {
        /// The firmware's ELF file
        elf: PathBuf,
        /// A function to begin at, or several: a path or a part of it; generic arguments do not matter
        #[arg(long = "root", value_name = "NAME")]
        roots: Vec<String>,
        /// Calls that are known and harmless, each with its reason
        #[arg(long, value_name = "FILE")]
        allow: Option<PathBuf>,
    },
    /// Check that functions, and all that they may call, lie in RAM
    Places {
        /// The firmware's ELF file
        elf: PathBuf,
        /// A function to begin at, or several, as of `panics`
        #[arg(long = "root", value_name = "NAME")]
        roots: Vec<String>,
    },
    /// Name the functions at code addresses, inlined ones too
    Frames {
        /// The firmware's ELF file
        elf: PathBuf,
        /// Hexadecimal addresses, one a line; `-` reads standard input
        addresses: PathBuf,
    },
    /// Print the firmware's size in flash and RAM, and compare it with what was kept
    Size {
        /// The firmware's ELF file
        elf: PathBuf,
        /// Figures to compare with: a file of `key = value`
        #[arg(long, value_name = "FILE")]
        golden: Option<PathBuf>,
        /// Rewrite the golden file
        #[arg(long, requires = "golden")]
        bless: bool,
        /// The deepest stack that was measured, kept with the rest
        #[arg(long, value_name = "N")]
        stack_bytes: Option<u64>,
        /// The number of axes with which that was, kept with the rest
        #[arg(long, value_name = "N", requires = "stack_bytes")]
        stack_axes: Option<u64>,
    },
    /// Write the firmware as a UF2 file, which the board's boot drive takes by drag and drop
    Uf2 {
        /// The firmware's ELF file
        elf: PathBuf,
        /// The file to write; default: beside the ELF file, with the ending .uf2
        out: Option<PathBuf>,
    },
}

impl Command {
    /// Does it; false if a check failed.
    ///
    /// # Errors
    /// A question that makes no sense.
    pub fn run(self) -> Result<bool, Error> {
        match self {
            Self::Log {
                elf,
                bytes,
                cycles,
                json,
            } => log::print(&elf, &bytes, cycles.as_deref(), json),
            Self::Panics { elf, roots, allow } => panics::check(&elf, &roots, allow.as_deref()),
            Self::Places { elf, roots } => places::check(&elf, &roots),
            Self::Frames { elf, addresses } => frames::print(&elf, &addresses),
            Self::Uf2 { elf, out } => {
                let out = out.unwrap_or_else(|| elf.with_extension("uf2"));
                uf2::convert(&elf, &out)
            }
            Self::Size {
                elf,
                golden,
                bless,
                stack_bytes,
                stack_axes,
            } => {
                let stack = stack_bytes.map(|bytes| size::Stack {
                    bytes,
                    axes: stack_axes,
                });
                size::check(&elf, golden.as_deref(), bless, stack)
            }
        }
    }
}
