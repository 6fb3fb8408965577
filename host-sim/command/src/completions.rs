//! `cophase completions`: a completion script for a shell.

use std::io::Write;

use super::{CommandError, Status};
use clap_complete::{Shell, generate};

/// Long help with the place of the script for each shell. It is not a doc comment, because indented lines in a
/// doc comment are an example in Rust.
const WHERE: &str = "\
Print a completion script for a shell

Where to put it, so that every new session has it:

    bash        ~/.local/share/bash-completion/completions/cophase
    zsh         _cophase, in a folder that $fpath names
    fish        ~/.config/fish/completions/cophase.fish
    elvish      ~/.config/elvish/lib/cophase.elv, which rc.elv uses
    powershell  cophase.ps1, which your $PROFILE calls

For this session alone, in bash: source <(cophase completions bash)";

/// Print a completion script for a shell
#[derive(Debug, clap::Args)]
#[command(long_about = WHERE)]
pub(super) struct CompletionsArgs {
    /// The shell that is to complete arguments
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

pub(super) fn completions(
    args: &CompletionsArgs,
    mut command: clap::Command,
    out: &mut impl Write,
) -> Result<Status, CommandError> {
    let name = command.get_name().to_owned();
    // `generate` panics on a write error, and writing to a vector has none.
    let mut script = Vec::new();
    generate(args.shell, &mut command, name, &mut script);
    out.write_all(&script)?;
    Ok(Status::Done)
}
