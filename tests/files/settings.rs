//! A board reads the settings file that the host writes, and the file's format does not change.

use std::path::Path;

use clap::Parser;
use cophase::{Command, Status};
use cophase_link::board::{Board, Rp2040};
use cophase_link::file_format::VERSION;
use cophase_link::{Header, decode};
use cophase_scene::library::SCENES;
use cophase_tests::built_in;

/// The default scene as a settings file, from when its format got its version.
const GOLDEN: &[u8] = include_bytes!("../../firmware/link/golden/default.settings");

/// Returns the file that `cophase settings SCENE` writes, even if no board accepts it.
fn settings(scene: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("it.settings");
    let path = Path::new(&file).to_str().expect("UTF-8");
    let command = Command::try_parse_from(["cophase", "settings", scene, "-o", path]);
    let status = command
        .expect("arguments")
        .run(&mut Vec::new(), &mut Vec::new());
    assert_ne!(status, Status::BadInput);
    std::fs::read(file).expect("a file")
}

/// If this fails, a board takes a settings file of another format for one of its own, because both have the same
/// version.
#[test]
fn format_changes_only_with_its_version() {
    let header = Header::read(GOLDEN).expect("a settings file");
    assert_eq!(
        header.version, VERSION,
        "the golden settings file is of another version: {RENEW}"
    );
    assert!(
        settings("default") == GOLDEN,
        "the default scene is no longer compiled to the golden settings file. If the bytes of settings changed, raise \
         cophase_link::file_format::VERSION. Then, or if only the scene changed, {RENEW}"
    );
}

const RENEW: &str = "renew it: cargo sim settings default -o firmware/link/golden/default.settings";

/// If this fails, the settings of the loop on a board differ from those of the simulation.
#[test]
fn board_gets_the_settings_of_the_simulation() {
    for scene in SCENES {
        let mut settings = decode(&settings(scene.name)).expect("a settings file of this version");
        settings.clock_hz = Rp2040::CLOCK_HZ; // Set by the board.
        assert_eq!(settings, built_in(scene.name).settings, "{}", scene.name);
    }
}
