//! The `cophase` command: see `cophase --help`.
#![forbid(unsafe_code)]

use std::io;
use std::process::ExitCode;

use clap::Parser;
use cophase::Command;

fn main() -> ExitCode {
    let command = Command::parse(); // clap itself ends with status 2 on bad arguments
    cophase::clean_up_on_signals();
    ExitCode::from(command.carry_out(&mut io::stdout().lock(), &mut io::stderr()) as u8)
}
