//! `cophase settings`: converts a scene to a settings file for a board.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use cophase_files::report;
use cophase_link::file_format::HEADER_BYTES;
use cophase_link::header::{FIRST_SEQUENCE, MAGIC, OUTSIDE};
use cophase_link::layout::{FLASH_ADDRESS, SLOT_A_OFFSET, SLOT_B_OFFSET};
use cophase_link::uf2::{self, PAGE_BYTES};
use cophase_link::{Header, MAX_FILE_BYTES, board, encode};
use cophase_scene::file::{AxisOverrides, Fidelity, Wiring};
use cophase_scene::input_file::{self, Unreadable};
use cophase_scene::{Scene, entry};
use host_sim::checked::Checked;
use host_sim::drives::keys_of_torque;
use host_sim::machines::{self, given};

use super::output::write_file;
use super::{CommandError, Status, scenes};

/// Largest size of a settings file in any of its formats, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Addresses of both slots. A file in one slot only would be superseded by a later file in the other slot.
const SLOT_ADDRESSES: [u32; 2] = [FLASH_ADDRESS + SLOT_A_OFFSET, FLASH_ADDRESS + SLOT_B_OFFSET];

#[derive(Debug, clap::Args)]
pub(super) struct SettingsArgs {
    /// A scene file, or the name of a built-in scene
    #[arg(value_name = "SCENE")]
    scene: String,
    /// File to write; with a name that ends in .uf2, a file for drag and drop onto a board
    #[arg(
        short,
        long = "out",
        value_name = "FILE",
        default_value = "cophase.settings"
    )]
    out: PathBuf,
}

pub(super) fn settings(args: &SettingsArgs, out: &mut impl Write) -> Result<Status, CommandError> {
    let checked = scenes::read(&args.scene).map_err(CommandError::Input)?;
    let refused = |error: &dyn std::fmt::Display| CommandError::Input(format!("-o: {error}"));
    let mut buffer = [0; MAX_FILE_BYTES];
    let settings_file = encode(&checked.settings, FIRST_SEQUENCE, OUTSIDE, &mut buffer)
        .map_err(|error| refused(&error))?;
    let header = Header::read(settings_file).map_err(|error| refused(&error))?;
    let summary = summary(&checked, &header, &args.out)?;
    let is_uf2 = args
        .out
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("uf2"));
    let file = if is_uf2 {
        &drag_and_drop(settings_file)
    } else {
        settings_file
    };
    put(&args.out, file).map_err(CommandError::Input)?;
    out.write_all(summary.as_bytes())?;
    let fits = |board: &board::AnyBoard| (board.check)(&checked.settings).is_ok();
    Ok(if board::BOARDS.iter().any(fits) {
        Status::Done
    } else {
        Status::Fault
    })
}

/// Returns a UF2 file that places a settings file in both slots.
fn drag_and_drop(settings_file: &[u8]) -> Vec<u8> {
    let pages = SLOT_ADDRESSES.iter().flat_map(|&start| {
        let addresses = (start..).step_by(PAGE_BYTES);
        addresses.zip(settings_file.chunks(PAGE_BYTES))
    });
    let count = pages.clone().count() as u32;
    let blocks = (0..).zip(pages);
    blocks
        .flat_map(|(number, (address, page))| uf2::block(address, page, number, count))
        .collect()
}

/// Returns a summary of the settings file, with the parts of the scene that it leaves out.
fn summary(checked: &Checked, header: &Header, path: &Path) -> Result<String, CommandError> {
    let settings = &checked.settings;
    let controller = checked
        .controller()
        .map_err(|error| CommandError::Input(error.to_string()))?;
    let ticks = controller.program().0.duration();
    let seconds = ticks as f64 / f64::from(settings.tick_hz);
    let mut text = format!(
        "{}: {} ax{}s, {} ticks a second, a program of {} entr{} that lasts {seconds:.1} s.\n\
         Written to {}: {} bytes (header {HEADER_BYTES}, payload {}), format {}, CRC-32 {:#010x}.\n",
        checked.scene.name,
        settings.axes.len(),
        if settings.axes.len() == 1 { "i" } else { "e" },
        settings.tick_hz,
        settings.program.len(),
        if settings.program.len() == 1 {
            "y"
        } else {
            "ies"
        },
        path.display(),
        header.file_bytes(),
        header.length,
        header.version,
        header.payload_crc,
    );
    if *settings.name != *checked.scene.name {
        text += &format!("Its name is cut to `{}`.\n", settings.name);
    }
    if let Some(coupling) = report::coupling(checked) {
        text += &format!("{coupling}\n");
    }
    let left_out = left_out(&checked.scene);
    if !left_out.is_empty() {
        text += &format!(
            "Not in it, as they belong to the simulation: {}.\n",
            left_out.join(", ")
        );
    }
    for board in board::BOARDS {
        text += &match (board.check)(settings) {
            Ok(()) => format!(
                "Longest tick on the {} board: at most {:.0} of {} cycles.\n",
                board.name,
                (board.tick_cycles)(settings, settings.tick_hz).ceil(),
                board.clock_hz / settings.tick_hz,
            ),
            Err(unfit) => format!("The {} board will refuse this: {unfit}.\n", board.name),
        };
    }
    if checked.scene.wiring != Wiring::default() {
        text += &format!("Levels: {}.\n", checked.scene.wiring);
    }
    text += "How to get it onto a board: docs/first-machine.md, docs/settings-file.md.\n";
    Ok(text)
}

/// Returns the keys that a scene sets and that do not affect the control loop.
fn left_out(scene: &Scene) -> Vec<String> {
    let axes = &scene.axes;
    let common = [
        ("fidelity", scene.fidelity != Fidelity::Auto),
        ("axes.friction_nm", axes.friction_nm != 0.0),
        ("questions", !scene.questions.is_none()),
    ];
    let apart = |axis: &AxisOverrides| {
        [
            ("start_deg", axis.start_deg != 0.0),
            ("friction_nm", axis.friction_nm.is_some()),
            ("pull_out_scale", axis.pull_out_scale != 1.0),
            ("drive_steps_per_turn", axis.drive_steps_per_turn.is_some()),
        ]
    };
    let happenings = [
        ("[[command]]", !scene.command.is_empty()),
        ("[[input]]", !scene.input.is_empty()),
        ("[[late]]", !scene.late.is_empty()),
        ("[[fault]]", !scene.fault.is_empty()),
        ("[noise]", !scene.noise.is_none()),
        ("[scope]", scene.scope.is_some()),
    ];
    let mut keys: Vec<String> = machines::tables(scene)
        .flat_map(|table| table.simulation_keys(scene))
        .chain(given(&common))
        .chain(keys_of_torque(axes))
        .map(str::to_owned)
        .collect();
    for (i, axis) in scene.axis.iter().enumerate() {
        let number = format!("axis {}", axis.number);
        let place = |key| entry::place(&format!("axis[{i}].{key}"), Some(&number));
        keys.extend(given(&apart(axis)).map(place));
    }
    keys.extend(given(&happenings).map(str::to_owned));
    keys
}

/// Writes a whole file, or nothing.
fn put(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let show = path.display();
    // The finished file is put in place by its name, which would replace anything with that name.
    let is_taken = fs::symlink_metadata(path).is_ok_and(|there| !there.is_file());
    if is_taken && path.file_name().is_some() {
        return Err(match path.is_dir() {
            true => format!("-o: {show} is a folder; give the name of a file in it"),
            false => format!(
                "-o: {show} is there and is not a plain file; take it away, or give another name"
            ),
        });
    }
    if path.starts_with("/dev") {
        return Err(format!(
            "-o: {show} is the name of a device, and no device is there; give the name of a file, and load it with `cophase link load`"
        ));
    }
    // Firmware is flashed, and settings are loaded; a name that confuses the two would mislead.
    let is_firmware = |end: &OsStr| {
        ["hex", "bin", "elf"]
            .iter()
            .any(|kind| end.eq_ignore_ascii_case(kind))
    };
    if path.extension().is_some_and(is_firmware) {
        return Err(format!(
            "-o {show}: settings are no firmware; give my.settings for `cophase link load`, or my.uf2 for drag and drop onto a board"
        ));
    }
    // A mistyped name must not overwrite the scene or another file.
    let is_other = match input_file::read(path, MAX_BYTES) {
        Ok(there) => !(there.starts_with(&MAGIC) || uf2::is_uf2(&there)),
        Err(error) => matches!(error, Unreadable::TooLarge(_)),
    };
    if is_other {
        return Err(format!(
            "-o: {show} is there and is no settings file; take it away, or give another name, such as my.settings"
        ));
    }
    write_file("-o", path, bytes).map_err(|error| error.to_string())
}
