//! `cophase reproduced`: published figures beside ours, as a page.

use std::io::Write;
use std::path::PathBuf;

use super::output::write_file;
use super::{CommandError, Status};
use cophase_lab::reproduced::{sections, write_page};

#[derive(Debug, clap::Args)]
pub(super) struct ReproducedArgs {
    /// Write the page into this file instead of to standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(super) fn reproduced(
    args: &ReproducedArgs,
    out: &mut impl Write,
) -> Result<Status, CommandError> {
    let sections = sections().map_err(|error| CommandError::Input(error.to_string()))?;
    let page = write_page(&sections);
    match &args.out {
        None => out.write_all(page.as_bytes())?,
        Some(file) => {
            write_file("--out", file, page.as_bytes())
                .map_err(|error| CommandError::Input(error.to_string()))?;
            writeln!(out, "Written to {}.", file.display())?;
        }
    }
    Ok(
        if sections
            .iter()
            .all(|section| section.figures.iter().all(|figure| figure.is_within()))
        {
            Status::Done
        } else {
            Status::Fault
        },
    )
}
