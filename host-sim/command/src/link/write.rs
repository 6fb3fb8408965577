//! Loading of programs and settings.

use std::io::Write;
use std::path::Path;

use cophase_core::settings::Settings;
use cophase_link::header::{FIRST_SEQUENCE, OUTSIDE};
use cophase_link::message::{File, Identity, Request};
use cophase_link::program::MAX_PROGRAM_BYTES;
use cophase_link::{MAX_FILE_BYTES, decode, encode};
use cophase_scene::file_kind::FileKind;
use cophase_scene::input_file;

use super::Problem;
use super::args::LoadArgs;
use super::connection::Connection;
use super::error::LinkError;
use crate::scenes;

/// Loads a program, or all settings.
pub(super) fn load(
    link: &mut Connection,
    identity: &Identity,
    args: &LoadArgs,
    out: &mut impl Write,
) -> Result<(), Problem> {
    let name = args.scene.display().to_string();
    if args.scene.extension().is_some_and(|end| end == "settings") {
        let file = input_file::read(&args.scene, MAX_FILE_BYTES as u64).map_err(|e| {
            LinkError::Input(format!(
                "{name}: {e}; give a file that `cophase settings` wrote"
            ))
        })?;
        cophase_link::verify(&file).map_err(|e| LinkError::Input(format!("{name}: {e}")))?;
        return store(link, identity, &name, &file, out);
    }
    let checked = scenes::read(&name)
        .map_err(|problem| LinkError::Input(instead(&args.scene).unwrap_or(problem)))?;
    if args.settings {
        let mut buffer = vec![0; MAX_FILE_BYTES];
        let file = encode(&checked.settings, FIRST_SEQUENCE, OUTSIDE, &mut buffer)
            .map_err(|e| LinkError::Input(format!("{name}: {e}")))?;
        return store(link, identity, &name, file, out);
    }
    let present = settings(link)?;
    let file = program_file(&name, &checked.settings, &present)?;
    link.take_control(false)?;
    link.write_file(File::Program, &file)?;
    let entries = checked.settings.program.len();
    writeln!(
        out,
        "Loaded the program of {name}: {entries} entries. It runs until the controller restarts; \
         `cophase link load {name} --settings` stores it."
    )?;
    Ok(())
}

/// Returns the refusal of a file that cannot be loaded, if it is of another kind than a scene.
fn instead(path: &Path) -> Option<String> {
    let name = path.display();
    Some(match FileKind::from_path(path)? {
        FileKind::Scene => return None,
        FileKind::Settings => format!(
            "{name}: is a settings file, but its name does not end in .settings; rename it to {}",
            path.with_extension("settings").display()
        ),
        kind => format!(
            "{name}: is {kind} and no scene; link load takes a scene (.toml), the name of a built-in scene, or a settings file"
        ),
    })
}

/// Encodes the program of a scene, after a check that it was made for the machine of the controller.
pub(crate) fn program_file(
    name: &str,
    scene: &Settings,
    present: &Settings,
) -> Result<Vec<u8>, LinkError> {
    compare(name, scene, present)?;
    let mut buffer = [0; MAX_PROGRAM_BYTES];
    cophase_link::program::encode(scene, &mut buffer)
        .map(<[u8]>::to_vec)
        .ok_or_else(|| LinkError::Input(format!("{name}: the program is too long")))
}

/// Reads the settings of the controller.
pub(crate) fn settings(link: &mut Connection) -> Result<Settings, LinkError> {
    decode(&link.read_file(File::Settings)?)
        .map_err(|e| LinkError::Input(format!("the controller's settings: {e}")))
}

/// Checks that a program was made for the machine of the controller.
fn compare(name: &str, scene: &Settings, present: &Settings) -> Result<(), LinkError> {
    let differs = [
        ("machine", scene.machine != present.machine),
        ("limits", scene.limits != present.limits),
        ("control.tick_hz", scene.tick_hz != present.tick_hz),
        ("axes", scene.axes != present.axes),
    ];
    match differs.iter().find(|(_, differs)| *differs) {
        None => Ok(()),
        Some((key, _)) => Err(LinkError::Input(format!(
            "{name}: {key} differs from the controller's settings ({}); give --settings to load all settings, \
             or a scene of that machine",
            present.name
        ))),
    }
}

/// Stores settings, and restarts the controller with them.
fn store(
    link: &mut Connection,
    identity: &Identity,
    name: &str,
    file: &[u8],
    out: &mut impl Write,
) -> Result<(), Problem> {
    link.take_control(false)?;
    link.write_file(File::Settings, file)?;
    writeln!(out, "Stored the settings of {name}: {} bytes.", file.len())?;
    restart(link, identity, out)
}

/// Restarts the controller.
pub(super) fn restart(
    link: &mut Connection,
    before: &Identity,
    out: &mut impl Write,
) -> Result<(), Problem> {
    let identity = link.restart(before, &Request::Restart)?;
    let Identity { settings, axes, .. } = identity;
    writeln!(out, "Restarted with the settings {settings}, {axes} axes.")?;
    Ok(())
}
