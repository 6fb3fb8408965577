//! The `cophase` command: see `cophase --help`.
#![forbid(unsafe_code)]

use std::io;
use std::process::ExitCode;

use cophase::Command;

fn main() -> ExitCode {
    let command = Command::of_process();
    cophase::clean_up_on_signals();
    ExitCode::from(command.carry_out(&mut io::stdout().lock(), &mut io::stderr()) as u8)
}
