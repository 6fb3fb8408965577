//! Files that are not scenes, and folders that cannot be written to.

use std::fs;
use std::path::Path;

use super::edit::BASE;
use super::{cophase, refusal, refused};

#[track_caller]
fn assert_holds(line: &str, words: &[&str]) {
    for word in words {
        assert!(line.contains(word), "not `{word}`: {line}");
    }
}

/// Asserts that the file as a whole is refused: `cophase: FILE: …`, with these words.
#[track_caller]
fn assert_no_scene(dir: &Path, file: &str, words: &[&str]) {
    let line = refusal(file, dir, &["run", file, "--out", "out"]);
    assert!(line.starts_with(&format!("cophase: {file}:")), "{line}");
    assert_holds(&line, words);
}

#[test]
fn files_that_are_not_text_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let utf16 = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        let units = format!("\u{feff}{BASE}");
        units.encode_utf16().flat_map(bytes).collect()
    };
    let mut latin_1 = BASE.as_bytes().to_vec();
    latin_1.extend(b"# gr\xf6sser\n");
    let rubbish: Vec<u8> = (0_u32..10 << 20)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    for (name, bytes, words) in [
        (
            "utf-16-le",
            utf16(u16::to_le_bytes),
            ["UTF-16", "save it as UTF-8"],
        ),
        (
            "utf-16-be",
            utf16(u16::to_be_bytes),
            ["UTF-16", "save it as UTF-8"],
        ),
        (
            "load.uf2",
            b"UF2\n\x57\x51\x5d\x9e".to_vec(),
            ["is a UF2 file", "cophase scenes default > my.toml"],
        ),
        (
            "firmware",
            b"\x7fELF\x01\x01".to_vec(),
            ["is firmware (ELF)", "cophase scenes default > my.toml"],
        ),
        (
            "firmware.hex",
            b":020000041000EA\n".to_vec(),
            [
                "is firmware (Intel HEX)",
                "cophase scenes default > my.toml",
            ],
        ),
        (
            "latin-1",
            latin_1,
            ["is not UTF-8; in Latin-1 it is `", "save it as UTF-8"],
        ),
        (
            "nul",
            vec![0; 100],
            ["byte 0 is NUL", "cophase scenes default > my.toml"],
        ),
        (
            "rubbish",
            rubbish,
            ["larger than 1 MiB", "cophase scenes default > my.toml"],
        ),
    ] {
        fs::write(dir.path().join(name), bytes).unwrap();
        assert_no_scene(dir.path(), name, &words);
    }
}

#[test]
fn missing_files_and_folders_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("folder")).unwrap();
    assert_no_scene(
        dir.path(),
        "folder",
        &["is a directory", "give a scene file"],
    );
    assert_no_scene(
        dir.path(),
        "missing.toml",
        &[
            "cannot be opened",
            "`cophase scenes` lists the built-in scenes",
        ],
    );
    assert_no_scene(
        dir.path(),
        "lost_steps.toml",
        &[
            "cannot be opened",
            "did you mean the built-in scene `lost-steps`?",
        ],
    );
    assert_no_scene(
        dir.path(),
        "defualt",
        &[
            "no built-in scene of that name",
            "did you mean `default`?",
            "nor is there a file",
        ],
    );
    assert_no_scene(
        dir.path(),
        "xyz",
        &["no built-in scene of that name", "there are default, "],
    );
}

/// A gigabyte is refused as quickly, and in as little memory, as a megabyte.
#[cfg(target_os = "linux")]
#[test]
fn files_without_an_end_are_refused_in_little_memory() {
    let dir = tempfile::tempdir().unwrap();
    let sparse = fs::File::create(dir.path().join("sparse")).unwrap();
    sparse.set_len(2 << 30).unwrap();
    std::os::unix::fs::symlink("/dev/zero", dir.path().join("zero")).unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(dir.path().join("pipe"))
        .status()
        .unwrap();
    assert!(made.success());
    let names = super::listing(dir.path());
    // No program writes to the pipe, so that a reader would wait forever.
    for (file, problem, fix) in [
        ("sparse", "is larger than 1 MiB", "a few kilobytes of TOML"),
        ("zero", "is a pipe or a device", "save the scene to a file"),
        ("pipe", "is a pipe or a device", "save the scene to a file"),
    ] {
        // The limit is 256 MiB of address space, including the program and its libraries.
        let output = assert_cmd::Command::new("sh")
            .args(["-c", "ulimit -v 262144; exec \"$@\"", "sh"])
            .args([env!("CARGO_BIN_EXE_cophase"), "run", file, "--out", "out"])
            .current_dir(dir.path())
            .timeout(super::PATIENCE)
            .output()
            .unwrap();
        assert_holds(
            &refused(file, &output),
            &[&format!("cophase: {file}: {problem}"), fix],
        );
    }
    assert_eq!(super::listing(dir.path()), names);
}

#[test]
fn unusable_output_folders_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("scene.toml"), BASE).unwrap();
    fs::write(dir.path().join("taken"), "a file").unwrap();
    fs::create_dir_all(dir.path().join("half/trace.csv")).unwrap();
    for (out, words) in [
        (
            "taken",
            ["--out: cannot create the folder taken", "give a directory"],
        ),
        (
            "taken/below/it",
            [
                "--out: cannot create the folder taken/below/it",
                "give a directory",
            ],
        ),
        // If this error were found only at the end of a run, the files written before `trace.csv` would remain.
        (
            "half",
            ["--out: half/trace.csv is a directory", "give another --out"],
        ),
    ] {
        let line = refusal(out, dir.path(), &["run", "scene.toml", "--out", out]);
        assert_holds(&line, &words);
    }
    assert_eq!(fs::read(dir.path().join("taken")).unwrap(), b"a file");
}

/// If this fails, a user reads about the syntax or the size of a file where the problem is its kind.
#[test]
fn a_file_of_another_kind_is_named_by_its_kind() {
    let dir = tempfile::tempdir().unwrap();
    for (name, content, kind) in [
        ("trace.csv", "t_s,state\n", "a table (CSV)"),
        ("report.json", "{\"events\": []}\n", "data (JSON)"),
        ("steps.vcd", "$date\n", "a waveform (VCD)"),
        ("scope.svg", "<svg></svg>\n", "a drawing (SVG)"),
        ("photo.png", "\u{fffd}PNG", "a bitmap"),
        ("tool.py", "print(1)\n", "a Python program"),
        ("nameless", "{\"a\": 1}\n", "data (JSON)"),
    ] {
        let path = dir.path().join(name);
        fs::write(&path, content).unwrap();
        // The size does not matter.
        let file = fs::File::options().append(true).open(&path).unwrap();
        file.set_len(2 << 20).unwrap();
        let line = refusal(name, dir.path(), &["link", "load", name, "--to", "sim"]);
        let expected = format!(
            "cophase: {name}: is {kind} and no scene; link load takes a scene (.toml), the name of a built-in scene, or a settings file"
        );
        assert_eq!(line, expected);
    }
    fs::write(dir.path().join("my.bin"), b"COPHASE\0").unwrap();
    let line = refusal(
        "my.bin",
        dir.path(),
        &["link", "load", "my.bin", "--to", "sim"],
    );
    assert_holds(&line, &["is a settings file", "rename it to my.settings"]);
    let scope = ["scope", "--to", "sim", "--scene", "trace.csv"];
    let line = refusal("scope", dir.path(), &scope);
    assert_holds(&line, &["is a table (CSV) and no scene"]);
}

/// If this fails, a user takes a whole run for one that is cut off.
#[test]
fn what_is_no_run_is_not_compared() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &str| fs::write(dir.path().join(name), content).unwrap();
    for folder in ["run", "cut", "empty"] {
        fs::create_dir(dir.path().join(folder)).unwrap();
    }
    write("a.toml", BASE);
    write("run/trace.csv", "t_s,z_m\n0.1,0\n");
    write("run/report.json", "{\"events\": []}\n");
    write("cut/report.json", "{\"events\": []}\n");
    write("steps.vcd", "$date\n");
    write("notes", "one\ntwo, three\n");
    for (name, expected) in [
        (
            "a.toml",
            "a.toml: is a scene, not a run; run it first: cophase run a.toml --out DIR, then compare DIR",
        ),
        (
            "run/report.json",
            "run/report.json: is data (JSON) and no trace of a run; give run/trace.csv",
        ),
        (
            "steps.vcd",
            "steps.vcd: is a waveform (VCD) and no trace of a run; give the folder of a run, or its trace.csv",
        ),
        (
            "cut",
            "cut/trace.csv: is not there, as cut is of a run without it; run it again with csv in --trace",
        ),
        (
            "empty",
            "empty/trace.csv: is not there, so empty is not the folder of a run; give one that `cophase run` wrote",
        ),
        (
            "notes",
            "notes: there is no row with a time in column t_s; give a trace.csv that `cophase run` wrote",
        ),
    ] {
        let line = refusal(name, dir.path(), &["compare", name, "run"]);
        assert_eq!(line, format!("cophase: {expected}"));
    }
}

/// If this fails, a value that an option cannot take is used, or the message does not say which it can take.
#[test]
fn invalid_command_line_values_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("scene.toml"), BASE).unwrap();
    for (argument, value, right) in [
        ("--every", "0", "give a whole number, 1 or more"),
        ("--every", "-1", "give a whole number, 1 or more"),
        ("--every", "1.5", "give a whole number, 1 or more"),
        ("--window", "nonsense", "give FROM..TO in seconds"),
        ("--window", "nan..1", "give FROM..TO in seconds"),
        ("--window", "2..1", "swap the two"),
        ("--window", "-1..1", "0 or later"),
    ] {
        let argument = format!("{argument}={value}");
        let run = ["run", "scene.toml", "--out", "out", &argument];
        let line = refusal(&argument, dir.path(), &run);
        assert_holds(&line, &[value, right]);
    }
}

/// If this fails, a window after the end gives a file without edges, and the status reports success.
#[test]
fn a_window_outside_the_run_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("scene.toml"), BASE).unwrap();
    let window = ["run", "scene.toml", "--out", "out", "--window", "100..101"];
    let line = refusal("--window", dir.path(), &window);
    let words = [
        "--window: 100 to 101 s is outside the run, which lasted ",
        "give a window inside it",
    ];
    assert_holds(&line, &words);

    let scope = BASE.replace("from_s = 0.5\nto_s = 1", "from_s = 50\nto_s = 51");
    assert_ne!(scope, BASE);
    fs::write(dir.path().join("scene.toml"), scope).unwrap();
    let line = refusal("scope", dir.path(), &["run", "scene.toml", "--out", "out"]);
    let words = ["cophase: scene.toml: scope.from_s: 50 to 51 s is outside the run"];
    assert_holds(&line, &words);
}

/// If this fails, the window shows the first motion instead of the time at which a fault stops the run.
#[test]
fn the_default_window_shows_the_fault() {
    let dir = tempfile::tempdir().unwrap();
    let (scene, _) = BASE.split_once("[scope]").unwrap();
    let scene = format!("{scene}[[input]]\nat_s = 2.2\nline = \"enable\"\nactive = false\n");
    fs::write(dir.path().join("scene.toml"), scene).unwrap();
    let output = cophase(dir.path(), &["run", "scene.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let report = fs::read(dir.path().join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    let at_s = report["faults"][0]["t_s"].as_f64().unwrap();
    let [from_s, to_s] =
        ["window_from_s", "window_to_s"].map(|key| report["written"][key].as_f64().unwrap());
    assert!((at_s - 0.05 - from_s).abs() < 1e-6, "{from_s} to {to_s}");
    assert!(to_s > at_s, "{from_s} to {to_s}");
}
