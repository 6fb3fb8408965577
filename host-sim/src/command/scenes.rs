//! `cophase scenes`: what there is to run, and to start from.

use std::io::Write;

use super::{CommandError, Status};
use crate::scene::library::{self, SCENES};
use crate::scene::load;

#[derive(Debug, clap::Args)]
pub(super) struct ScenesArgs {
    /// Print this scene as TOML
    name: Option<String>,
}

pub(super) fn scenes(args: &ScenesArgs, out: &mut impl Write) -> Result<Status, CommandError> {
    match &args.name {
        None => {
            let width = SCENES
                .iter()
                .map(|scene| scene.name.len())
                .max()
                .unwrap_or(0);
            for built_in in SCENES {
                writeln!(
                    out,
                    "{:width$}  {}",
                    built_in.name,
                    built_in.scene().description
                )?;
            }
        }
        Some(name) => match library::find(name) {
            Some(built_in) => out.write_all(built_in.text.as_bytes())?,
            None => return Err(CommandError::Input(unknown(name))),
        },
    }
    Ok(Status::Done)
}

/// That there is no such scene, and which there are.
pub(super) fn unknown(name: &str) -> String {
    let known: Vec<_> = SCENES.iter().map(|scene| scene.name).collect();
    let meant = load::nearest(name, &known).map(|near| format!("did you mean `{near}`? "));
    format!(
        "{name}: there is no built-in scene of that name; {}there are {}",
        meant.unwrap_or_default(),
        known.join(", ")
    )
}
