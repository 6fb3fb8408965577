//! A case of a campaign is run alone: by the command that the campaign prints, and with the options of a part of the campaign. Runs,
//! campaigns and cases do not mix their files.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const COPHASE: &str = env!("CARGO_BIN_EXE_cophase");

/// Runs the command in a folder, and returns what it prints.
fn printed(folder: &Path, arguments: &[&str]) -> String {
    read(
        Command::new(COPHASE)
            .args(arguments)
            .current_dir(folder)
            .output()
            .unwrap(),
    )
}

fn read(output: Output) -> String {
    // These tests do not check the verdict of a campaign.
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Returns the row that the replay of a case printed.
fn row(said: &str) -> serde_json::Value {
    let (_, row) = said.split_once("As the campaign has it:\n").expect(said);
    serde_json::from_str(row).unwrap()
}

/// Returns the rows of a file of a campaign, with the names of the columns.
fn rows(file: &Path) -> Vec<serde_json::Map<String, serde_json::Value>> {
    let mut reader = csv::Reader::from_path(file).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

/// Returns true if a replay printed a row of the file of a campaign.
fn is_of(row: &serde_json::Value, file: &Path) -> bool {
    let text = |value: &serde_json::Value| match value {
        serde_json::Value::Null => String::new(),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let is_equal = |listed: &serde_json::Map<String, serde_json::Value>| {
        // The columns from `version` on are of the campaign.
        let of_run = listed.iter().filter(|(name, _)| row.get(name).is_some());
        of_run.clone().count() == row.as_object().unwrap().len()
            && of_run.clone().all(|(name, value)| {
                let (listed, shown) = (text(value), text(&row[name]));
                match (listed.parse::<f64>(), shown.parse::<f64>()) {
                    // JSON loses the last digit.
                    (Ok(listed), Ok(shown)) => (listed - shown).abs() <= 1e-12 * listed.abs(),
                    _ => listed == shown,
                }
            })
    };
    rows(file).iter().any(is_equal)
}

/// If this fails, the command that a campaign offers cannot be pasted into a shell, or shows a case of another machine.
#[test]
fn the_printed_command_replays_a_case_of_the_same_scene_and_seed() {
    let place = tempfile::tempdir().unwrap();
    let scene = cophase_scene::library::find("patent-4").unwrap().text;
    fs::write(place.path().join("my machine's.toml"), scene).unwrap();
    let said = printed(
        place.path(),
        &[
            "campaign",
            "my machine's.toml",
            "--runs",
            "3",
            "--seed",
            "8",
            "--threads",
            "2",
        ],
    );
    let command = said.trim_end().lines().last().unwrap().trim();
    assert!(command.contains("--seed 8 --replay "), "{said}");
    let shell = Command::new("sh")
        .args(["-c", command])
        .current_dir(place.path())
        .output();
    let row = row(&read(shell.unwrap()));
    assert_eq!(row["machine"], "patent-4");
    assert!(
        is_of(&row, &place.path().join("out/campaign/campaign.csv")),
        "{row}"
    );
    let number = row["number"].as_u64().unwrap();
    assert!(
        place
            .path()
            .join(format!("out/case-{number}/scene.toml"))
            .is_file()
    );
}

/// If this fails, a case of a shard, or of chosen strata, is another one when it is run alone.
#[test]
fn a_replay_with_the_options_of_a_shard_of_strata_is_the_same_case() {
    let place = tempfile::tempdir().unwrap();
    let shard = [
        "campaign",
        "--seed",
        "5",
        "--only",
        "slip,stuck:index",
        "--others",
        "40",
        "--runs",
        "6",
        "--from",
        "2",
        "--to",
        "5",
        "--threads",
        "1",
    ];
    printed(place.path(), &[&shard[..], &["--quiet"]].concat());
    let file = place.path().join("out/campaign/campaign-2-5.csv");
    let last = rows(&file).pop().unwrap()["number"].to_string();
    let number = last.trim_matches('"');
    // A position in the selection is not the number of the case.
    assert!(number.parse::<u64>().unwrap() > 6, "{number}");
    for clean in [&["--replay", number][..], &["--replay", number, "--clean"]] {
        let row = row(&printed(place.path(), &[&shard[..], clean].concat()));
        assert_eq!(row["number"].to_string(), number);
        assert!(is_of(&row, &file), "{row}");
    }
}

/// If this fails, a run, a campaign and a replay in one folder replace each other's files.
#[test]
fn run_campaign_and_replay_have_folders_of_their_own() {
    let place = tempfile::tempdir().unwrap();
    let files = |folder: &str| {
        let entries = fs::read_dir(place.path().join(folder)).unwrap();
        let files = entries
            .map(|entry| entry.unwrap())
            .filter(|entry| entry.path().is_file());
        let file = |entry: fs::DirEntry| {
            (
                entry.file_name().into_string().unwrap(),
                fs::read(entry.path()).unwrap(),
            )
        };
        files
            .map(file)
            .collect::<std::collections::BTreeMap<_, _>>()
    };
    printed(place.path(), &["run", "patent-4"]);
    let before = files("out");
    printed(place.path(), &["campaign", "--runs", "2"]);
    printed(place.path(), &["campaign", "--replay", "1"]);
    printed(place.path(), &["campaign", "--replay", "1", "--clean"]);
    assert_eq!(files("out"), before);
    assert_eq!(
        files("out/campaign").into_keys().collect::<Vec<_>>(),
        ["campaign-table.md", "campaign.csv", "campaign.svg"]
    );
    assert_ne!(
        files("out/case-1")["report.json"],
        files("out/case-1-clean")["report.json"]
    );
}

/// If this fails, a campaign ends with a panic after its last case.
#[test]
fn a_program_in_a_folder_that_is_not_utf_8_prints_a_command() {
    use std::os::unix::ffi::OsStrExt;

    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join(std::ffi::OsStr::from_bytes(b"caf\xe9"));
    if fs::create_dir(&folder).is_err() {
        // Some file systems have no such names.
        return;
    }
    let program = folder.join("cophase");
    std::os::unix::fs::symlink(COPHASE, &program).unwrap();
    let mut command = Command::new(program);
    command.args(["campaign", "--runs", "1"]);
    let said = read(command.current_dir(place.path()).output().unwrap());
    assert!(
        said.contains("\n    cophase campaign --seed 1 --replay 0"),
        "{said}"
    );
}

/// If this fails, the command that a join offers replaces the scene by a word without saying so.
#[test]
fn a_join_of_shards_of_a_scene_states_that_its_command_lacks_the_scene() {
    let place = tempfile::tempdir().unwrap();
    let shard = ["campaign", "patent-4", "--runs", "2", "--quiet"];
    printed(place.path(), &[&shard[..], &["--to", "1"]].concat());
    printed(place.path(), &[&shard[..], &["--from", "1"]].concat());
    let said = printed(place.path(), &["campaign", "--join", "out/campaign"]);
    let (_, again) = said.split_once("\nTo run a case again").expect(&said);
    assert!(
        again.contains(", with the campaign's scene for SCENE:\n\n"),
        "{said}"
    );
    assert!(
        again.contains(" campaign SCENE --seed 1 --replay "),
        "{said}"
    );
}

/// If this fails, shards that start together into a new folder remove it from under each other.
#[test]
fn shards_that_start_together_share_a_new_folder() {
    for _ in 0..5 {
        let place = tempfile::tempdir().unwrap();
        let start = |number: u32| {
            Command::new(COPHASE)
                .args(["campaign", "--quiet", "--threads", "1", "--runs", "8"])
                .args(["--from", &number.to_string()])
                .args(["--to", &(number + 1).to_string()])
                .current_dir(place.path())
                .stderr(std::process::Stdio::piped())
                .spawn()
                .unwrap()
        };
        let children: Vec<_> = (0..8).map(start).collect();
        for child in children {
            read(child.wait_with_output().unwrap());
        }
        let files = fs::read_dir(place.path().join("out/campaign")).unwrap();
        // A file of each shard, the picture and the table.
        assert_eq!(files.count(), 8 + 2);
    }
}
