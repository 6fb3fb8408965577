//! Runs of the command, and their outcomes.

use std::path::Path;

use clap::Parser;
use cophase::{Command, Status};

/// Outcome of a run of the command.
pub struct Run {
    pub status: Status,
    pub out: String,
    pub err: String,
}

/// Runs a scene into a folder, with options.
pub fn run(scene: &Path, folder: &Path, options: &[&str]) -> Run {
    let fixed = [
        "cophase".as_ref(),
        "run".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        folder.as_os_str(),
    ];
    let command = Command::try_parse_from(
        fixed
            .into_iter()
            .chain(options.iter().map(|option| option.as_ref())),
    );
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = command.expect("arguments").run(&mut out, &mut err);
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    Run {
        status,
        out: text(out),
        err: text(err),
    }
}

/// Writes the settings of a scene for a board into a folder.
pub fn settings(scene: &Path, folder: &Path) -> Status {
    let file = folder.join("scene.settings");
    let command = Command::try_parse_from([
        "cophase".as_ref(),
        "settings".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        file.as_os_str(),
    ]);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    command.expect("arguments").run(&mut out, &mut err)
}

/// Outcome of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    Done,
    Fault,
    Refused,
}
