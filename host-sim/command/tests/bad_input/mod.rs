//! Bad input ends with status 2. Each error is one line that names the file, the line, the key, the problem and the fix. No
//! file is written.
//!
//! Each case breaks one thing in a scene that runs. A test checks that the unbroken scene runs. Otherwise a case could be
//! refused for another reason than its own.

mod axes;
mod cam;
mod cam_table;
mod edit;
mod events;
mod faults;
mod files;
mod form;
mod limits;
mod machine;
mod plants;
mod program;
mod sweep;

use std::path::Path;
use std::process::Output;
use std::time::Duration;

use edit::BASE;

/// A broken scene, and the text that its message must contain.
struct Case {
    name: &'static str,
    text: String,
    /// The key path. It is empty if the error concerns the file as a whole.
    key: &'static str,
    wrong: &'static str,
    right: &'static str,
}

fn case(
    name: &'static str,
    text: String,
    key: &'static str,
    wrong: &'static str,
    right: &'static str,
) -> Case {
    Case {
        name,
        text,
        key,
        wrong,
        right,
    }
}

/// Timeout, far longer than a refusal takes. Only a hang exceeds it.
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs `cophase` with these arguments in this directory.
fn cophase(dir: &Path, arguments: &[&str]) -> Output {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
    command.current_dir(dir).args(arguments).timeout(PATIENCE);
    command.output().unwrap()
}

/// Lists everything below a directory.
fn listing(dir: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        found.push(path.display().to_string());
        if path.is_dir() && !path.is_symlink() {
            found.extend(listing(&path));
        }
    }
    found.sort();
    found
}

/// Runs a command that must be refused, and returns its one-line message.
#[track_caller]
fn refusal(name: &str, dir: &Path, arguments: &[&str]) -> String {
    let before = listing(dir);
    let output = cophase(dir, arguments);
    assert_eq!(listing(dir), before, "{name}: something was written");
    refused(name, &output)
}

/// Asserts that the output is a refusal, and returns its one-line message.
#[track_caller]
fn refused(name: &str, output: &Output) -> String {
    let words = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{name}: {words}");
    assert!(output.stdout.is_empty(), "{name}: stdout is not empty");
    let line = words.strip_suffix('\n').expect("a line ends");
    assert!(line.starts_with("cophase: "), "{name}: {line}");
    assert!(!line.contains("panicked"), "{name}: {line}");
    assert!(!line.contains(char::is_control), "{name}: {line}");
    assert!(line.len() < 1000, "{name}: {line}");
    line.to_owned()
}

/// Runs a broken scene and checks every part of its message.
#[track_caller]
fn assert_refused(case: &Case) {
    let Case {
        name,
        text,
        key,
        wrong,
        right,
    } = case;
    assert_ne!(text, BASE, "{name}: nothing is broken");
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("scene.toml");
    std::fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let line = refusal(name, dir.path(), &["run", file, "--out", "out"]);

    let place = line
        .strip_prefix(&format!("cophase: {file}:"))
        .unwrap_or_else(|| panic!("{name}: the file is not named: {line}"));
    let (number, said) = place.split_once(": ").unwrap_or_default();
    let problem = if key.is_empty() {
        place
    } else if let Some(problem) = place.strip_prefix(&format!(" {key}: ")) {
        // A message has no line number only if something is missing from the file as a whole.
        assert!(problem.starts_with("missing"), "{name}: no line: {line}");
        problem
    } else {
        let number: usize = number
            .parse()
            .unwrap_or_else(|_| panic!("{name}: no line: {line}"));
        let at = text.lines().nth(number - 1).unwrap_or_default();
        let own = key.rsplit('.').next().unwrap();
        let own = own.split('[').next().unwrap();
        // This is the key's own line (spelled differently if in quotes), or the line of the table that lacks it.
        assert!(
            at.contains(own) || at.starts_with(['[', '"', 'λ']) || said.contains(": missing"),
            "{name}: line {number} is `{at}`: {line}"
        );
        let (place, problem) = said.split_once(": ").unwrap_or_default();
        let entry = place
            .strip_prefix(key)
            .unwrap_or_else(|| panic!("{name}: not at {key}: {line}"));
        // The message also describes list entries in words.
        assert_eq!(!entry.is_empty(), key.contains('['), "{name}: {line}");
        problem
    };
    if problem.contains(" is outside ") || problem.contains(" finite number") {
        assert!(problem.contains("; "), "{name}: no fix: {line}");
    }
    assert!(problem.contains(wrong), "{name}: not `{wrong}`: {line}");
    assert!(problem.contains(right), "{name}: not `{right}`: {line}");
}

#[track_caller]
fn assert_all_refused(cases: &[Case]) {
    for case in cases {
        assert_refused(case);
    }
}

/// Returns the message about a scene with these values in place of its own, line by line.
fn lines_of(changes: &[(&str, &str)]) -> Vec<String> {
    let mut text = BASE.to_owned();
    for (from, to) in changes {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text = text.replace(from, to);
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("scene.toml"), text).unwrap();
    let output = cophase(dir.path(), &["run", "scene.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!dir.path().join("out").exists());
    let words = String::from_utf8(output.stderr).unwrap();
    words.lines().map(str::to_owned).collect()
}

/// If this fails, the user corrects one error per run, or one error causes messages about others.
#[test]
fn all_errors_are_reported_together() {
    let wrong = [
        ("load_kg = 10", "load_kg = 500", "machine.load_kg"),
        ("settle_s = 0.1", "settle_s = -1", "control.settle_s"),
        (
            "speed_hz = 20\nacc",
            "speed_hz = -4\nacc",
            "limits.speed_hz",
        ),
        ("width_ns = 2000", "width_ns = 0", "pulse.width_ns"),
        (
            "steps_per_turn = 3200",
            "steps_per_turn = 2",
            "axes.steps_per_turn",
        ),
        (
            "trim_limit_deg = 5",
            "trim_limit_deg = 99",
            "axes.trim_limit_deg",
        ),
        (
            "pull_out_scale = 1",
            "pull_out_scale = 11",
            "axis[0].pull_out_scale",
        ),
        (
            "warp_limit_deg = 3",
            "warp_limit_deg = nan",
            "drift.warp_limit_deg",
        ),
        ("by_us = 50", "by_us = -1", "late[0].by_us"),
        ("from_s = 0.5", "from_s = -0.5", "scope.from_s"),
    ];
    let changes = wrong.map(|(from, to, _)| (from, to));
    let lines = lines_of(&changes);
    assert_eq!(lines.len(), wrong.len(), "{lines:#?}");
    for (line, (_, _, key)) in lines.iter().zip(wrong) {
        assert!(line.starts_with("cophase: scene.toml:"), "{line}");
        let place = line.split(": ").nth(2).unwrap();
        let (path, _) = place.split_once(' ').unwrap_or((place, ""));
        assert_eq!(path, key, "{line}");
    }
    let places = lines.iter().map(|line| line.split(':').nth(2).unwrap());
    let numbers: Vec<u32> = places.map(|place| place.parse().unwrap()).collect();
    assert!(numbers.is_sorted(), "{numbers:?}");

    // Unknown keys and wrong types are reported as well as wrong values.
    let forms = [
        ("load_kg = 10", "load_kg = \"10\"", "machine.load_kg"),
        (
            "platform = \"above\"",
            "platform = \"abov\"",
            "machine.platform",
        ),
        ("gravity_mps2", "gravity_g", "machine.gravity_g"),
        ("settle_s = 0.1", "settle_s = -1", "control.settle_s"),
        ("drive = \"stepper\"", "drive = \"steper\"", "axes.drive"),
        ("line = \"enable\"", "line = \"enabl\"", "input[0].line"),
    ];
    let lines = lines_of(&forms.map(|(from, to, _)| (from, to)));
    assert_eq!(lines.len(), forms.len(), "{lines:#?}");
    for (line, (_, _, key)) in lines.iter().zip(forms) {
        assert!(line.contains(&format!(": {key}")), "not {key}: {line}");
    }
    // A key that is missing because it is misspelt counts as one error.
    assert_eq!(lines_of(&[("lambda =", "lamda =")]).len(), 1);
    assert_eq!(lines_of(&[("[limits]", "[limit]")]).len(), 1);

    // So are numbers whose range another key decides, and what is wrong for the machine.
    let decided = [
        (
            "acceleration_hz_per_s = 20",
            "acceleration_hz_per_s = 5e4",
            "limits.acceleration_hz_per_s",
        ),
        ("trim_deg = 0", "trim_deg = 7", "axis[0].trim_deg"),
        ("width_us = 2", "width_us = 200", "index.width_us"),
        (
            "tilt_limit_mrad = 3",
            "tilt_limit_mrad = -3",
            "drift.tilt_limit_mrad",
        ),
    ];
    let combined = [
        (
            "step = \"high\"",
            "step = \"high\"\n[[fault]]\nat_s = 1\nkind = \"slip\"",
            "fault[0].axis",
        ),
        (
            "pull_out_scale = 1",
            "pull_out_scale = 1\ncam = \"lobe\"",
            "axis[0].cam",
        ),
        (
            "[[axis]]\nnumber = 2",
            "[[axis]]\nnumber = 7",
            "axis[1].number",
        ),
        ("amax_g = 3\n", "", "program[0].amax_g"),
        ("to_s = 1", "to_s = 0.2", "scope.to_s"),
    ];
    for wrong in [&decided[..], &combined] {
        let changes: Vec<_> = wrong.iter().map(|&(from, to, _)| (from, to)).collect();
        let lines = lines_of(&changes);
        assert_eq!(lines.len(), wrong.len(), "{lines:#?}");
        for (line, (_, _, key)) in lines.iter().zip(wrong) {
            assert!(line.contains(&format!(": {key}")), "not {key}: {line}");
        }
    }
    // A range that a wrong number decides is not known.
    let jerk = ("jerk_hz_per_s2 = 200", "jerk_hz_per_s2 = 1e9");
    assert_eq!(lines_of(&[jerk]).len(), 1);
    assert_eq!(lines_of(&[changes[2], jerk]).len(), 1);

    // A run reports at most ten errors.
    let more = [("full_steps_per_turn = 200", "full_steps_per_turn = 1")];
    assert_eq!(lines_of(&[&changes[..], &more].concat()).len(), 10);
    // A level that is too high for the speed limit is not reported beside an error in that limit. The limit is unknown until
    // that error is corrected.
    let program = [changes[2], ("amax_g = 5", "amax_g = 190")];
    assert_eq!(lines_of(&program).len(), 1);
}

/// If this fails, the user writes keys of a machine that the scene is not to have.
#[test]
fn a_second_machine_is_one_error() {
    for crusher in [
        "[crusher]\n\n[control]",
        "[crusher]\njaw_mm = 800\n\n[control]",
    ] {
        let lines = lines_of(&[("[control]", crusher)]);
        assert_eq!(lines.len(), 1, "{lines:#?}");
        let words =
            ": crusher: given together with [machine]; a scene has one machine: leave one out";
        assert!(lines[0].contains(words), "{lines:#?}");
    }
}

/// If this fails, the advice about a heading leads to another error.
#[test]
fn a_heading_of_one_axis_in_the_place_of_all_is_one_error() {
    let (kept, entries) = BASE.split_once("[[axis]]").unwrap();
    let (_, rest) = entries.split_once("[index]").unwrap();
    let alone = format!("{kept}[index]{rest}").replace("[axes]", "[axis]");
    for text in [alone.replace("[axes.servo]", "[axis.servo]"), alone] {
        let line = refusal_of(&text);
        let words = "are keys of [axes]; write [axes] in the place of [axis]";
        assert!(line.contains(words), "{line}");
    }
    let beside = BASE.replace("[axes]", "[axis]");
    let line = refusal_of(&beside);
    let words =
        "given before as a table; write [[axis]] there, too, or [axes] if its keys are those";
    assert!(line.contains(words), "{line}");
}

/// Returns the one line about a text that is no scene.
fn refusal_of(text: &str) -> String {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("scene.toml"), text).unwrap();
    refusal(
        "scene.toml",
        dir.path(),
        &["run", "scene.toml", "--out", "out"],
    )
}

/// A message names the place of an entry in the list and its axis number, which can differ.
#[test]
fn entries_are_named_by_their_place_and_their_axis() {
    let changes = [("[[axis]]\nnumber = 2", "[[axis]]\nnumber = 7")];
    let lines = lines_of(&changes);
    let words = ": axis[1].number (2nd [[axis]] entry, axis 7): there is no axis 7";
    assert!(lines[0].contains(words), "{lines:#?}");
    // A value of the wrong type is named in the same way.
    let changes = [("start_deg = 0", "start_deg = \"a\"")];
    let lines = lines_of(&changes);
    let words = ": axis[0].start_deg (1st [[axis]] entry, axis 1): `\"a\"` is text";
    assert!(lines[0].contains(words), "{lines:#?}");
}

/// The positive control: the base scene of all cases runs, and writes its files and no others.
#[test]
fn the_base_scene_runs() {
    // Some editors put a byte order mark before the text. It has no effect.
    for text in [BASE.to_owned(), format!("\u{feff}{BASE}")] {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("scene.toml"), text).unwrap();
        let output = cophase(dir.path(), &["run", "scene.toml", "--out", "out"]);
        let words = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{words}");
        let mut names: Vec<_> = std::fs::read_dir(dir.path().join("out"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(
            names,
            [
                "report.json",
                "scope.svg",
                "steps.vcd",
                "torque.svg",
                "trace.csv"
            ]
        );
    }
}
