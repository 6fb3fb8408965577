//! `firmware-inspect`: reads the firmware's ELF file, so that tests can examine the flashed bytes.
//!
//! - `log` decodes what the firmware logged over RTT;
//! - `panics` proves that no panic can be reached from given functions, and bounds their stack;
//! - `places` checks that the functions that may be called lie in RAM;
//! - `frames` names the functions at code addresses, including those inlined there;
//! - `size` prints the firmware's size in flash and RAM, and compares it with the stored figures;
//! - `uf2` writes the firmware as a file for drag and drop.
//!
//! Exit status: 0 all checks passed; 1 a check failed; 2 the question makes no sense, with a sentence
//! that gives the reason: a missing file, a name that matches nothing.

mod calls;
mod command;
mod error;
mod firmware;
mod frames;
mod log;
mod name;
mod panics;
mod places;
mod size;
mod uf2;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    match command::Command::parse().run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("firmware-inspect: {error}");
            ExitCode::from(2)
        }
    }
}
