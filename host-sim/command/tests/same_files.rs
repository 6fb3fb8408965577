//! The files that `cophase run` writes are the same on every run of a scene, byte for byte, except
//! for the report's `speed`. `--every` and `--window` change the files but not the run.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs a built-in scene into a folder and returns its exit status.
fn run(scene: &str, out: &Path, options: &[&str]) -> i32 {
    let status = Command::new(env!("CARGO_BIN_EXE_cophase"))
        .args(["run", scene, "--quiet", "--out"])
        .arg(out)
        .args(options)
        .status()
        .expect("the command starts");
    status.code().expect("and is not killed")
}

/// Returns `report.json` without the keys that may differ.
fn report(folder: &Path, without: &[&str]) -> serde_json::Value {
    let text = fs::read(folder.join("report.json")).expect("a report");
    let mut report: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    for name in without {
        let removed = report.as_object_mut().expect("an object").remove(*name);
        assert!(removed.is_some(), "the report has `{name}`");
    }
    report
}

fn assert_same_bytes(one: &Path, other: &Path, file: &str) {
    let read = |folder: &Path| fs::read(folder.join(file)).expect("a file");
    let (one, other) = (read(one), read(other));
    assert!(!one.is_empty() && one == other, "{file} differs");
}

/// If this fails, two users with the same scene get different runs.
#[test]
fn the_same_scene_writes_the_same_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let (one, other) = (folder.path().join("one"), folder.path().join("other"));
    for (scene, status) in [("lost-steps", 1), ("patent-4", 0)] {
        let formats = ["--trace", "csv,vcd,fst,mcap"];
        assert_eq!(run(scene, &one, &formats), status);
        assert_eq!(run(scene, &other, &formats), status);
        let traces = ["trace.csv", "steps.vcd", "steps.fst", "trace.mcap"];
        for file in traces.into_iter().chain(["scope.svg", "torque.svg"]) {
            assert_same_bytes(&one, &other, file);
        }
        assert_eq!(
            report(&one, &["speed"]),
            report(&other, &["speed"]),
            "{scene}"
        );
    }
}

/// If this fails, a finer trace changes the run that it records.
#[test]
fn every_and_window_options_change_only_the_written_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let (one, other) = (folder.path().join("one"), folder.path().join("other"));
    assert_eq!(
        run("lost-steps", &one, &["--every", "1", "--window", "all"]),
        1
    );
    assert_eq!(
        run(
            "lost-steps",
            &other,
            &["--every", "5", "--window", "10.5..10.6"]
        ),
        1
    );
    assert_same_bytes(&one, &other, "scope.svg");
    let kept = ["speed", "written"];
    assert_eq!(report(&one, &kept), report(&other, &kept));

    let trace = |folder: &Path| fs::read_to_string(folder.join("trace.csv")).expect("a trace");
    let (all, some) = (trace(&one), trace(&other));
    let fifth: Vec<&str> = all.lines().skip(5).step_by(5).collect();
    assert_eq!(some.lines().skip(1).collect::<Vec<_>>(), fifth);
}
