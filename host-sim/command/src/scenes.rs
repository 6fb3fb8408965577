//! `cophase scenes`: the built-in scenes, to run or to start from. This module also reads scenes for the other commands.

use std::io::Write;
use std::path::{Path, PathBuf};

use cophase_scene::Scene;
use cophase_scene::keys;
use cophase_scene::library::{self, BuiltIn, SCENES};
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::machines;
use host_sim::setup;

use super::output::write_file;
use super::refusal::visible;
use super::{CommandError, Status};

#[derive(Debug, clap::Args)]
pub(super) struct ScenesArgs {
    /// Print this built-in scene as TOML
    name: Option<String>,
    /// Draw the machine of this scene with its symbols, as SVG; NAME may also be a file
    #[arg(long, value_name = "FILE", requires = "name")]
    svg: Option<PathBuf>,
    /// Print the JSON Schema of a scene, with which an editor completes keys and shows their units and ranges
    #[arg(long, conflicts_with_all = ["name", "svg"])]
    schema: bool,
}

/// First lines of a printed scene. Editors read the place of the schema there.
const SCHEMA_LINE: &str = "#:schema ./scene.schema.json\n# For completion in an editor: `cophase scenes --schema > scene.schema.json`\n\n";

pub(super) fn scenes(args: &ScenesArgs, out: &mut impl Write) -> Result<Status, CommandError> {
    if let (Some(name), Some(file)) = (&args.name, &args.svg) {
        let checked = read(name).map_err(CommandError::Input)?;
        write_file("--svg", file, checked.draw().as_bytes())
            .map_err(|error| CommandError::Input(error.to_string()))?;
        return Ok(Status::Done);
    }
    if args.schema {
        writeln!(out, "{:#}", keys::schema())?;
        return Ok(Status::Done);
    }
    match &args.name {
        None => {
            let scenes = SCENES.iter().map(BuiltIn::scene);
            let mut scenes: Vec<_> = scenes.map(|scene| (machine_of(&scene), scene)).collect();
            let names = scenes.iter().map(|(_, scene)| scene.name.len());
            let width = names.max().unwrap_or(0);
            let first_use: Vec<_> = scenes.iter().map(|(machine, _)| *machine).collect();
            // Stable, so that the scenes of a machine keep their order.
            scenes.sort_by_key(|(machine, _)| first_use.iter().position(|first| first == machine));
            writeln!(
                out,
                "{:1$}  sensors         correction  description",
                "machine, scene",
                width + 2
            )?;
            for of_machine in scenes.chunk_by(|(machine, _), (next, _)| machine == next) {
                writeln!(out, "{}", of_machine[0].0)?;
                for (_, scene) in of_machine {
                    writeln!(
                        out,
                        "  {:width$}  {:14}  {:10}  {}",
                        scene.name,
                        scene.sensors(),
                        scene.corrects(),
                        scene.description
                    )?;
                }
            }
        }
        Some(name) => match library::find(name) {
            Some(built_in) => write!(out, "{SCHEMA_LINE}{}", built_in.text)?,
            None => return Err(CommandError::Input(unknown(name))),
        },
    }
    Ok(Status::Done)
}

/// Returns the name of a scene's machine, for lists.
fn machine_of(scene: &Scene) -> &'static str {
    let machine = machines::tables(scene).next();
    machine.map_or("no machine", |table| table.list_name())
}

/// Returns the error that there is no such scene, with the names of all scenes.
pub(super) fn unknown(name: &str) -> String {
    let known: Vec<_> = SCENES.iter().map(|scene| scene.name).collect();
    let meant = load::nearest(name, &known).map(|near| format!("did you mean `{near}`? "));
    format!(
        "{}: there is no built-in scene of that name; {}there are {}",
        visible(name),
        meant.unwrap_or_default(),
        known.join(", ")
    )
}

/// Reads a scene: a file if there is one with this name, else a built-in scene.
pub(super) fn read(name: &str) -> Result<Checked, String> {
    let path = Path::new(name);
    match library::find(name) {
        Some(built_in) if !path.exists() => {
            Checked::new(built_in.scene()).map_err(|error| error.in_file(name))
        }
        _ if !path.exists() && path.extension().is_none() && path.components().count() <= 1 => {
            return Err(format!(
                "{}; nor is there a file of that name",
                unknown(name)
            ));
        }
        _ => setup::checked_from_file(path),
    }
    .map_err(|error| error.to_string())
}
