//! What the desk compiles is what a board reads, and stays so.

use std::path::Path;

use clap::Parser;
use cophase::{Command, Status};
use cophase_blob::codec::VERSION;
use cophase_blob::{Header, decode};
use cophase_tests::built_in;
use host_sim::scene::library::SCENES;

/// The default scene as a blob, as it was when its format got its version.
const GOLDEN: &[u8] = include_bytes!("../firmware/blob/golden/default.blob");

/// What `cophase image SCENE` writes.
fn image(scene: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("it.blob");
    let path = Path::new(&file).to_str().expect("UTF-8");
    let command = Command::try_parse_from(["cophase", "image", scene, "-o", path]);
    let status = command.expect("arguments").carry_out(&mut Vec::new());
    assert_eq!(status, Status::Done);
    std::fs::read(file).expect("a file")
}

/// Were it wrong, a board would take a blob of another format for one of its own: both have its version.
#[test]
fn the_format_changes_only_with_its_version() {
    let header = Header::read(GOLDEN).expect("a blob");
    assert_eq!(
        header.version, VERSION,
        "the golden blob is of another version: {RENEW}"
    );
    assert!(
        image("default") == GOLDEN,
        "the default scene is no longer compiled to the golden blob. If the bytes of settings changed, raise \
         cophase_blob::codec::VERSION. Then, or if only the scene changed, {RENEW}"
    );
}

const RENEW: &str = "renew it: cargo sim image default -o firmware/blob/golden/default.blob";

/// Were it wrong, the loop on a board would be another than the one that was simulated.
#[test]
fn a_board_is_told_what_the_simulation_is_told() {
    for scene in SCENES {
        let settings = decode(&image(scene.name)).expect("a blob of this version");
        assert_eq!(settings, built_in(scene.name).settings, "{}", scene.name);
    }
}
