//! `cophase man`: a manual page for the command, and one for each subcommand.

use std::io::{self, Write};
use std::path::PathBuf;

use cophase_files::trace::RunFiles;

use super::{CommandError, Status};
use clap_mangen::Man;

#[derive(Debug, clap::Args)]
pub(super) struct ManArgs {
    /// Folder to write cophase.1, cophase-run.1 and all others into
    #[arg(value_name = "DIR")]
    dir: PathBuf,
}

pub(super) fn man(
    args: &ManArgs,
    command: clap::Command,
    out: &mut impl Write,
) -> Result<Status, CommandError> {
    // `help` only repeats the other pages.
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let mut pages = Vec::new();
    render(&command, &mut pages)?;

    let unwritable = |error: &dyn std::fmt::Display| {
        CommandError::Input(format!(
            "DIR {}: {error}; give a folder that can be written",
            args.dir.display()
        ))
    };
    let mut files = RunFiles::create(&args.dir).map_err(|error| unwritable(&error))?;
    for (name, page) in &pages {
        let mut file = files.file(name).map_err(|error| unwritable(&error))?;
        file.write_all(page)
            .and_then(|()| file.flush())
            .map_err(|error| unwritable(&error))?;
    }
    files.commit().map_err(|error| unwritable(&error))?;
    writeln!(
        out,
        "Written to {}: {} pages, of which cophase.1 names the others.",
        args.dir.display(),
        pages.len()
    )?;
    Ok(Status::Done)
}

/// Renders the page of a command and those of its subcommands, each with the name of its file.
fn render(command: &clap::Command, pages: &mut Vec<(String, Vec<u8>)>) -> io::Result<()> {
    let man = Man::new(command.clone())
        .manual("Cophase")
        .source(concat!("cophase ", env!("CARGO_PKG_VERSION")));
    let mut page = Vec::new();
    man.render(&mut page)?;
    pages.push((man.get_filename(), page));
    command
        .get_subcommands()
        .try_for_each(|subcommand| render(subcommand, pages))
}
