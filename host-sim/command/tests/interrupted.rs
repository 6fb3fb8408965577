//! A command that a signal ends removes its unfinished files.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Timeout, far longer than a start takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// A program of one hour. No test waits for its end.
const LONG: &str = "name = \"long\"\n[machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 5\n\
     [limits]\nspeed_hz = 20\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
     [axes]\ncount = 6\ndrive = \"stepper\"\nsteps_per_turn = 25600\n\
     [[program]]\namax_g = 10\nramp_s = 1\nhold_s = 3600\n";

fn parts(dir: &Path) -> usize {
    let entries = fs::read_dir(dir).into_iter().flatten().flatten();
    entries
        .filter(|entry| entry.path().extension().is_some_and(|end| end == "part"))
        .count()
}

/// Ends a run in its middle, and returns its exit status.
fn ended_by(signal: &str, dir: &Path, out: &str) -> Option<i32> {
    fs::write(dir.join("long.toml"), LONG).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_cophase"))
        .args(["run", "long.toml", "--quiet", "--out", out])
        .current_dir(dir)
        .spawn()
        .unwrap();
    let began = Instant::now();
    while parts(&dir.join(out)) < 4 {
        assert!(began.elapsed() < PATIENCE, "nothing is being written");
        assert!(
            child.try_wait().unwrap().is_none(),
            "it has ended by itself"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    child.wait().unwrap().code()
}

/// If this fails, hidden files of hundreds of megabytes accumulate unnoticed.
#[test]
fn a_signal_leaves_no_unfinished_files() {
    for (signal, status) in [("-INT", 130), ("-TERM", 143)] {
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(ended_by(signal, dir.path(), "a/b"), Some(status));
        assert!(!dir.path().join("a").exists(), "{signal}: folders are left");

        // Files from before the run stay.
        fs::create_dir(dir.path().join("out")).unwrap();
        fs::write(dir.path().join("out/report.json"), "an earlier run").unwrap();
        assert_eq!(ended_by(signal, dir.path(), "out"), Some(status));
        let left: Vec<_> = fs::read_dir(dir.path().join("out")).unwrap().collect();
        assert_eq!(left.len(), 1, "{signal}");
        let report = fs::read(dir.path().join("out/report.json")).unwrap();
        assert_eq!(report, b"an earlier run");
    }
}
