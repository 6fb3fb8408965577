//! `cophase compare` on runs of the real command.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;

const STANDARD_GRAVITY_MPS2: f64 = 9.80665;

fn scene(level_g: f64) -> String {
    format!(
        "name = \"compared\"\nfidelity = \"kinematic\"\n\
         [machine]\ncrank_radius_mm = 12\nlambda = 0.3\nload_kg = 5\n\
         [control]\nsettle_s = 0.01\n\
         [limits]\nspeed_hz = 20\nacceleration_hz_per_s = 100\njerk_hz_per_s2 = 4000\nhoming_speed_hz = 5\n\
         [axes]\ncount = 3\ndrive = \"stepper\"\nsteps_per_turn = 3200\n\
         [[program]]\namax_g = 1\nramp_s = 0.2\nhold_s = 0.2\n\
         [[program]]\namax_g = {level_g}\nramp_s = 0.2\nhold_s = 0.1\n"
    )
}

/// Runs a scene into a folder below `scratch`.
fn run(scratch: &Path, name: &str, scene: &str, options: &[&str]) -> PathBuf {
    let file = scratch.join(format!("{name}.toml"));
    fs::write(&file, scene).unwrap();
    let out = scratch.join(name);
    let mut command = Command::cargo_bin("cophase").unwrap();
    command
        .arg("run")
        .arg(&file)
        .arg("--quiet")
        .arg("--out")
        .arg(&out);
    command.args(options).assert().success();
    out
}

/// Exit status, output and errors of a comparison.
fn compare(a: &Path, b: &Path, options: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("cophase").unwrap();
    let output = command
        .arg("compare")
        .args([a, b])
        .args(options)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap(),
        text(output.stdout),
        text(output.stderr),
    )
}

#[test]
fn two_runs_of_a_scene_are_equal() {
    let scratch = tempfile::tempdir().unwrap();
    let text = scene(2.0);
    let all = run(
        scratch.path(),
        "all",
        &text,
        &["--every", "1", "--window", "all"],
    );
    let some = run(
        scratch.path(),
        "some",
        &text,
        &["--every", "7", "--window", "0.5..0.6"],
    );
    let (status, out, _) = compare(&all, &some, &[]);
    assert_eq!(status, 0, "{out}");
    assert!(
        out.contains("The runs are equal within the tolerances."),
        "{out}"
    );
    assert!(
        out.contains("Edges from 0.5 to 0.6 s:") && out.contains("0 shifted"),
        "{out}"
    );
    // Compares two traces without their folders.
    let (status, out, _) = compare(&all.join("trace.csv"), &some.join("trace.csv"), &[]);
    assert_eq!(status, 0, "{out}");
    assert!(out.contains("Edges: not compared"), "{out}");
}

/// The requested amax differs from that of the other run on the second ramp, by x³ (10 − 15 x + 6 x²) of the difference of
/// both levels.
#[test]
fn the_first_difference_is_where_the_programs_differ() {
    let scratch = tempfile::tempdir().unwrap();
    let options = ["--every", "1"];
    let a = run(scratch.path(), "a", &scene(2.0), &options);
    let b = run(scratch.path(), "b", &scene(3.0), &options);
    let drawn = scratch.path().join("drawn");
    let tolerance = "amax_requested_mps2=0.5";
    let options = [
        "--json",
        "--tolerance",
        tolerance,
        "--out",
        drawn.to_str().unwrap(),
    ];
    let (status, out, errors) = compare(&a, &b, &options);
    assert_eq!(status, 1, "{errors}");
    let compared: serde_json::Value = serde_json::from_str(&out).unwrap();
    let columns = compared["columns"].as_array().unwrap();
    let column = |name: &str| {
        columns
            .iter()
            .find(|column| column["name"] == name)
            .unwrap()
    };

    let trace = fs::read_to_string(a.join("trace.csv")).unwrap();
    let first_of_run = trace.lines().find(|line| line.contains(",run,")).unwrap();
    let run_s: f64 = first_of_run.split(',').next().unwrap().parse().unwrap();
    // Finds by bisection the time at which the difference of the ramps equals the tolerance.
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-9 {
        let x = 0.5 * (low + high);
        let part: f64 = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        if part * STANDARD_GRAVITY_MPS2 > 0.5 {
            high = x;
        } else {
            low = x;
        }
    }
    let expected_s = run_s + 0.4 + 0.2 * high;
    let found_s = column("amax_requested_mps2")["exceeds_at_s"]
        .as_f64()
        .unwrap();
    // The first row after that time, at 2 kHz. A row has the time of the end of its tick.
    assert!(
        (found_s - expected_s).abs() <= 0.0010,
        "{found_s} for {expected_s}"
    );
    let max = column("amax_requested_mps2")["largest"].as_f64().unwrap();
    assert!((max - STANDARD_GRAVITY_MPS2).abs() < 1e-3, "{max}");
    // Nothing differs before the second ramp.
    let part_s = compared["parts"]["at_s"].as_f64().unwrap();
    assert!(part_s > run_s + 0.4 && part_s <= found_s, "{part_s}");
    let svg = fs::read_to_string(drawn.join("compare.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("amax B-A, g"));
}

#[test]
fn bad_input_is_refused_and_nothing_is_written() {
    let scratch = tempfile::tempdir().unwrap();
    let a = run(scratch.path(), "a", &scene(2.0), &["--every", "10"]);
    let cut = scratch.path().join("cut.csv");
    let trace = fs::read_to_string(a.join("trace.csv")).unwrap();
    fs::write(&cut, &trace[..trace.len() / 2]).unwrap();
    let drawn = scratch.path().join("drawn");
    let out = ["--out", drawn.to_str().unwrap()];
    for (b, options, problem) in [
        (cut, vec![], "cut.csv: the file ends within a line"),
        (scratch.path().join("none"), vec![], "none: "),
        (scratch.path().to_owned(), vec![], "trace.csv: "),
        (
            a.clone(),
            vec!["--tolerance", "accel=1"],
            "did you mean `accel_mps2`?",
        ),
        (
            a.clone(),
            vec!["--tolerance", "accel_mps2"],
            "give COLUMN=VALUE",
        ),
        (
            a.clone(),
            vec!["--tolerance", "accel_mps2=-1"],
            "below zero",
        ),
    ] {
        let (status, printed, errors) = compare(&a, &b, &[&options[..], &out].concat());
        assert_eq!((status, printed.as_str()), (2, ""), "{errors}");
        assert!(errors.contains(problem), "{errors}");
        assert!(!drawn.exists());
    }
}
