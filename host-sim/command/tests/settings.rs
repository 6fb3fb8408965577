//! `cophase settings`: the settings file holds the loop's settings, and the summary lists the keys that it does not hold.
//! Bad input is refused as `run` refuses it, and no file is left half-written.

use std::fs;
use std::path::Path;
use std::process::Output;

use cophase_link::header::{FIRST_SEQUENCE, OUTSIDE};
use cophase_link::{Header, decode};
use cophase_scene::load;
use host_sim::checked::Checked;

/// A scene that runs, with every key given.
const BASE: &str = include_str!("bad_input/base.toml");

fn settings(dir: &Path, arguments: &[&str]) -> Output {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
    command.current_dir(dir).arg("settings").args(arguments);
    command.output().unwrap()
}

fn names(dir: &Path) -> Vec<String> {
    let entries = fs::read_dir(dir).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Returns the message of a successful run.
#[track_caller]
fn said(output: &Output) -> String {
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{words}");
    assert!(output.stderr.is_empty(), "{words}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Runs a command that must be refused, and returns its one-line message.
#[track_caller]
fn refusal(dir: &Path, arguments: &[&str]) -> String {
    let before = names(dir);
    let output = settings(dir, arguments);
    let words = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{words}");
    assert!(output.stdout.is_empty());
    assert_eq!(names(dir), before, "something was written");
    let line = words.strip_suffix('\n').expect("a line ends");
    assert!(
        line.starts_with("cophase: ") && !line.contains('\n'),
        "{line}"
    );
    line.to_owned()
}

/// Reads a UF2 file as the RP2040's boot ROM does. Returns the flash contents that it writes.
fn flashed(uf2: &[u8]) -> std::collections::BTreeMap<u32, Vec<u8>> {
    let word = |block: &[u8], at: usize| u32::from_le_bytes(block[at..at + 4].try_into().unwrap());
    let blocks = uf2.as_chunks::<512>().0;
    assert_eq!(blocks.len() * 512, uf2.len());
    let mut pages = std::collections::BTreeMap::new();
    for (number, block) in blocks.iter().enumerate() {
        assert_eq!((word(block, 0), word(block, 4)), (0x0A324655, 0x9E5D5157));
        assert_eq!(word(block, 508), 0x0AB16F30);
        assert_eq!((word(block, 8), word(block, 28)), (0x2000, 0xE48BFF56));
        assert_eq!(word(block, 16), 256);
        assert_eq!(
            (word(block, 20) as usize, word(block, 24) as usize),
            (number, blocks.len())
        );
        assert!(
            pages
                .insert(word(block, 12), block[32..288].to_vec())
                .is_none()
        );
    }
    pages
}

/// If this fails, the settings are in one slot only, and an older file in the other slot can take precedence.
#[test]
fn a_uf2_file_places_the_settings_in_both_slots() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("scene.toml"), BASE).unwrap();
    said(&settings(dir.path(), &["scene.toml", "-o", "my.settings"]));
    said(&settings(dir.path(), &["scene.toml", "-o", "my.uf2"]));
    said(&settings(dir.path(), &["scene.toml", "-o", "my.uf2"]));
    let file = fs::read(dir.path().join("my.settings")).unwrap();
    let pages = flashed(&fs::read(dir.path().join("my.uf2")).unwrap());
    assert_eq!(pages.len(), 2 * file.len().div_ceil(256));
    for slot in [0x101F_0000, 0x101F_8000] {
        let placed: Vec<u8> = pages
            .range(slot..slot + 0x8000)
            .flat_map(|(_, page)| page.clone())
            .collect();
        assert_eq!(placed[..file.len()], file);
        assert!(placed[file.len()..].iter().all(|byte| *byte == 0xFF));
    }
}

/// If this fails, the settings on a board differ from those of the simulated machine.
#[test]
fn a_scene_becomes_a_settings_file_of_the_same_setup() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("scene.toml"), BASE).unwrap();
    let summary = said(&settings(dir.path(), &["scene.toml", "-o", "my.settings"]));
    assert_eq!(names(dir.path()), ["my.settings", "scene.toml"]);
    let settings_file = fs::read(dir.path().join("my.settings")).unwrap();
    let checked = Checked::new(load::parse(BASE).unwrap()).unwrap();
    let mut decoded = decode(&settings_file).unwrap();
    decoded.clock_hz = checked.settings.clock_hz; // Set by the board.
    assert_eq!(decoded, checked.settings);
    let header = Header::read(&settings_file).unwrap();
    assert_eq!((header.sequence, header.origin), (FIRST_SEQUENCE, OUTSIDE));

    for words in [
        "base: 3 axes, 2000 ticks a second, a program of 4 entries that lasts 2.0 s.",
        &format!(
            "my.settings: {} bytes (header 256, payload {})",
            settings_file.len(),
            header.length
        ),
        &format!("CRC-32 {:#010x}", header.payload_crc),
    ] {
        assert!(summary.contains(words), "not `{words}`: {summary}");
    }
}

/// If this fails, a user expects a board to do things that only the simulation does.
#[test]
fn the_summary_names_the_keys_left_out() {
    let dir = tempfile::tempdir().unwrap();
    let left_out = |text: &str| {
        fs::write(dir.path().join("scene.toml"), text).unwrap();
        let summary = said(&settings(dir.path(), &["scene.toml"]));
        let line = summary
            .lines()
            .find_map(|line| line.strip_prefix("Not in it, "));
        let keys = line.map(|line| line.split_once(": ").unwrap().1.to_owned());
        keys.unwrap_or_default()
    };
    assert_eq!(
        left_out(BASE),
        "machine.tilt_inertia_kgm2, frame, axes.pull_out, axes.servo, [[command]], [[input]], [[late]], [scope]."
    );
    // First without any of these keys, then with each one alone.
    let (loop_only, _) = BASE.split_once("[[command]]").unwrap();
    let of_torque = ["pull_out =", "tilt_inertia"];
    let loop_only: String = loop_only
        .split_inclusive("\n\n")
        .filter(|table| !table.starts_with("[frame") && !table.starts_with("[axes.servo]"))
        .flat_map(str::lines)
        .filter(|line| !of_torque.iter().any(|key| line.starts_with(key)))
        .flat_map(|line| [line, "\n"])
        .collect();
    assert_eq!(left_out(&loop_only), "");
    for (from, to, keys) in [
        ("\"auto\"", "\"kinematic\"", "fidelity."),
        (
            "rotor_inertia",
            "friction_nm = 0.1\nrotor_inertia",
            "axes.friction_nm.",
        ),
        (
            "start_deg = 0",
            "start_deg = 1",
            "axis[0].start_deg (1st [[axis]] entry, axis 1).",
        ),
        (
            "reversed = true",
            "friction_nm = 1",
            "axis[1].friction_nm (2nd [[axis]] entry, axis 2).",
        ),
    ] {
        assert_eq!(left_out(&loop_only.replace(from, to)), keys);
    }
    let weaker = BASE.replace("pull_out_scale = 1", "pull_out_scale = 0.9");
    assert!(
        left_out(&weaker)
            .contains("axis[0].pull_out_scale (1st [[axis]] entry, axis 1), [[command]]")
    );
}

#[test]
fn long_names_are_cut_and_the_cut_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    let long = format!("{}ü", "n".repeat(31)); // 33 bytes
    let text = BASE.replace("\"base\"", &format!("\"{long}\""));
    fs::write(dir.path().join("scene.toml"), text).unwrap();
    let summary = said(&settings(dir.path(), &["scene.toml"]));
    let cut = "n".repeat(31);
    assert!(
        summary.contains(&format!("Its name is cut to `{cut}`.")),
        "{summary}"
    );
    let settings_file = fs::read(dir.path().join("cophase.settings")).unwrap();
    assert_eq!(decode(&settings_file).unwrap().name, *cut);
}

#[test]
fn a_folder_is_made_and_an_earlier_file_replaced() {
    let dir = tempfile::tempdir().unwrap();
    said(&settings(
        dir.path(),
        &["default", "-o", "new/folder/it.settings"],
    ));
    assert_eq!(names(&dir.path().join("new/folder")), ["it.settings"]);
    let first = fs::read(dir.path().join("new/folder/it.settings")).unwrap();
    said(&settings(
        dir.path(),
        &["patent-4", "--out", "new/folder/it.settings"],
    ));
    assert_eq!(names(&dir.path().join("new/folder")), ["it.settings"]);
    assert_ne!(
        fs::read(dir.path().join("new/folder/it.settings")).unwrap(),
        first
    );
}

/// If this fails, a board gets an incomplete settings file, or the settings file of an earlier scene is lost.
#[test]
fn a_bad_scene_leaves_an_earlier_file_alone() {
    let dir = tempfile::tempdir().unwrap();
    said(&settings(dir.path(), &["default"]));
    let before = fs::read(dir.path().join("cophase.settings")).unwrap();
    for (from, to, words) in [
        (
            "speed_hz = 20\n",
            "speed_hz = 2000\n",
            ["limits.speed_hz: 2000 rev/s is outside", "0.1 to 200"],
        ),
        (
            "amax_g = 5",
            "amax_g = 190",
            [
                "program[1].amax_g (2nd [[program]] entry): 190 g",
                "give at most 41.86 g",
            ],
        ),
        (
            "amax_g = 4,",
            "amax_g = -4,",
            [
                "program[2].segments[0].amax_g (1st entry of segments in the 3rd [[program]] entry): -4 g is outside",
                "0 to 1019.7 g",
            ],
        ),
        (
            "trim_deg = 0",
            "trim_deg = 6",
            [
                "axis[0].trim_deg (1st [[axis]] entry, axis 1): 6° is outside -5 to 5°",
                "raise axes.trim_limit_deg",
            ],
        ),
        (
            "count = 3",
            "count = 7",
            ["axes.count: 7 is outside", "2 to 6"],
        ),
        ("load_kg", "load", ["machine.load", "load_kg"]),
    ] {
        assert!(BASE.contains(from), "{from}");
        fs::write(dir.path().join("scene.toml"), BASE.replacen(from, to, 1)).unwrap();
        let line = refusal(dir.path(), &["scene.toml"]);
        assert!(line.starts_with("cophase: scene.toml:"), "{line}");
        for words in words {
            assert!(line.contains(words), "not `{words}`: {line}");
        }
        assert_eq!(
            fs::read(dir.path().join("cophase.settings")).unwrap(),
            before
        );
    }
    let line = refusal(dir.path(), &["defualt"]);
    assert!(line.contains("did you mean `default`?"), "{line}");
}

#[test]
fn unusable_output_paths_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("taken"), "a file").unwrap();
    fs::create_dir(dir.path().join("folder")).unwrap();
    for (out, words) in [
        (
            "folder",
            ["-o: folder is a folder", "give the name of a file in it"],
        ),
        // A board that is not plugged in: a plain file in its place would hide it.
        (
            "/dev/no-such-board",
            ["is the name of a device", "`cophase link load`"],
        ),
        // Protects a file that is not a settings file. A scene is easily overwritten by mistake, as with `-o my.toml`.
        (
            "taken",
            [
                "-o: taken is there and is no settings file",
                "give another name",
            ],
        ),
        (
            "my.hex",
            ["-o my.hex: settings are no firmware", "give my.settings"],
        ),
        ("..", ["-o ..: it is no name of a file", "give a file"]),
        (
            "taken/it.settings",
            [
                "-o taken/it.settings: cannot create the folder taken",
                "give a file in a folder that can be written",
            ],
        ),
    ] {
        let line = refusal(dir.path(), &["default", "-o", out]);
        for words in words {
            assert!(line.contains(words), "not `{words}`: {line}");
        }
    }
    assert_eq!(fs::read(dir.path().join("taken")).unwrap(), b"a file");
}

/// If this fails, the summary does not mention that the board will refuse the settings. The refusal after flashing costs
/// more.
#[test]
fn the_summary_warns_of_settings_the_board_refuses() {
    let dir = tempfile::tempdir().unwrap();
    let text = BASE.replacen("drive = \"stepper\"", "drive = \"servo\"", 1);
    let (text, _) = text.split_once("[[command]]").unwrap();
    let text = text.replace("pull_out = [[0, 20.0], [10, 18.0], [20, 15.0]]\n", "");
    fs::write(dir.path().join("scene.toml"), text).unwrap();
    let output = settings(dir.path(), &["scene.toml"]);
    assert_eq!(output.status.code(), Some(1), "no board takes it");
    assert!(dir.path().join("cophase.settings").exists());
    let summary = String::from_utf8(output.stdout).unwrap();
    assert!(
        summary.contains(
            "RP2040 board will refuse this: axis 0 is a servo that takes setpoints over a fieldbus"
        ),
        "{summary}"
    );
}

/// If this fails, a scene whose longest tick the board does not finish in time gets a settings file or runs, and a deadline is missed; or
/// the fix that the refusal names is no fix. The scene missed one when only the axes and their steps counted.
#[test]
fn a_tick_rate_that_no_board_keeps_is_refused_and_the_named_one_is_accepted() {
    const SCENE: &str = include_str!("../../../tests/emulator/scenes/missed-deadline.toml");
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("scene.toml");
    fs::write(&file, SCENE).unwrap();
    let line = refusal(dir.path(), &["scene.toml"]);
    assert!(line.contains("control.tick_hz: at 8000 Hz"), "{line}");
    let mut run = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
    run.current_dir(dir.path());
    let run = run.args(["run", "scene.toml", "--out", "out"]).output();
    let run = run.unwrap();
    assert_eq!(run.status.code(), Some(2), "{run:?}");
    assert!(!dir.path().join("out").exists());
    let (_, named) = line.split_once("give at most ").unwrap();
    let max_hz = named.split(' ').next().unwrap();
    let rate = format!("tick_hz = {max_hz}");
    fs::write(&file, SCENE.replace("tick_hz = 8000", &rate)).unwrap();
    let output = settings(dir.path(), &["scene.toml"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = String::from_utf8(output.stdout).unwrap();
    assert!(
        summary.contains("Longest tick on the RP2040 board: at most "),
        "{summary}"
    );
}

/// If this fails, gains that the program derives get onto a board without appearing in the summary.
#[test]
fn the_summary_reports_derived_coupling_gains() {
    let dir = tempfile::tempdir().unwrap();
    let text = "name = \"servos\"\n[machine]\ncrank_radius_mm = 12\nlambda = 0.25\nload_kg = 5\n\
                [limits]\nspeed_hz = 40\nacceleration_hz_per_s = 30\njerk_hz_per_s2 = 300\n\
                [axes]\ncount = 3\ndrive = \"servo\"\nsteps_per_turn = 32768\nencoder = true\n\
                rotor_inertia_kgm2 = 1e-3\nservo = { position_gain_per_s = 120, velocity_gain_nms = 1.0 }\n\
                [correction]\ncouple = true\n[[program]]\namax_g = 10\nramp_s = 1\nhold_s = 1\n";
    fs::write(dir.path().join("scene.toml"), text).unwrap();
    let output = settings(dir.path(), &["scene.toml"]);
    let summary = String::from_utf8(output.stdout.clone()).unwrap();
    assert_ne!(output.status.code(), Some(2), "{output:?}");
    assert!(
        summary.contains("Cross-coupling of the setpoints: gain "),
        "{summary}"
    );
    assert!(summary.contains(" 1/s (derived)."), "{summary}");
}
