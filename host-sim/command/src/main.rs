//! The `cophase` command: see `cophase --help`.
#![forbid(unsafe_code)]

use std::io;
use std::process::ExitCode;

use cophase::Command;
use git_version::git_version;

fn main() -> ExitCode {
    // Only this file is compiled again for each commit.
    cophase_files::version::set_commit(git_version!(
        args = ["--always", "--exclude=*", "--abbrev=12", "--dirty=-changed"],
        fallback = "unknown"
    ));
    let command = Command::of_process();
    cophase::clean_up_on_signals();
    ExitCode::from(command.run(&mut io::stdout().lock(), &mut io::stderr()) as u8)
}
