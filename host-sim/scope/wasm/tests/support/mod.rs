//! Previews by the WebAssembly module of the page, which Node runs.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Numbers of a row: two times, then smallest and largest value of each channel.
const ROW: usize = 2 + 2 * cophase_scope_wasm::CHANNELS;

/// Preview of one scene.
pub struct Previewed {
    /// The answer.
    pub answer: serde_json::Value,
    /// One row per tick.
    pub rows: Vec<[f64; ROW]>,
}

/// Previews the texts of scenes. Returns `None` if Node is not installed and not required.
pub fn preview(texts: &[&str]) -> Option<Vec<Previewed>> {
    if !has_node() {
        return None;
    }
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a folder for scenes");
    let stem = |number: usize| folder.path().join(number.to_string());
    for (number, text) in texts.iter().enumerate() {
        fs::write(stem(number).with_extension("toml"), text).expect("a scene is written");
    }
    let status = Command::new("node")
        .arg(here.join("tests/preview.mjs"))
        .arg(here.join("../page/program.wasm"))
        .arg(folder.path())
        .status()
        .expect("node runs");
    assert!(status.success(), "preview.mjs: {status}");
    let read = |number: usize| {
        let answer = fs::read(stem(number).with_extension("json")).expect("an answer");
        let rows = fs::read(stem(number).with_extension("rows")).expect("rows");
        Previewed {
            answer: serde_json::from_slice(&answer).expect("JSON"),
            rows: rows.chunks_exact(8 * ROW).map(row).collect(),
        }
    };
    Some((0..texts.len()).map(read).collect())
}

fn row(bytes: &[u8]) -> [f64; ROW] {
    std::array::from_fn(|i| f64::from_ne_bytes(std::array::from_fn(|byte| bytes[8 * i + byte])))
}

fn has_node() -> bool {
    if Command::new("node").arg("--version").output().is_ok() {
        return true;
    }
    let required = std::env::var("COPHASE_REQUIRE_READERS").is_ok_and(|value| value == "1");
    assert!(
        !required,
        "node is not installed, and COPHASE_REQUIRE_READERS=1"
    );
    eprintln!("node is not installed: not tested");
    false
}
