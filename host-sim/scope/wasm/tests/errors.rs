//! Tests that the mistakes of a preview equal those that `cophase run` prints for the same text, line for line.

mod support;

use std::fs;

use clap::Parser;
use cophase_random_scenes::{Kinds, draw};
use cophase_scene::library;

use cophase::{Command, Status};

/// Changes of the built-in scene `default`, each of which makes a wrong text: the replaced text, and the new one.
const WRONG: [(&str, &str); 12] = [
    ("amax_g = 12", "amax_g = 700"),
    ("amax_g = 12", "amax_g = \"70\""),
    ("amax_g = 12", "amax_g = 7,0"),
    ("amax_g = 12", "amax = 70"),
    (
        "amax_g = 12\nramp_s = 4\nhold_s = 10",
        "amax_g = 70\nramp_s = 0\nhold_s = 0",
    ),
    ("repeat = 3", "repeat = 0"),
    ("shape = \"linear\"", "shape = \"straight\""),
    ("speed_hz = 22", "speed_hz = -22"),
    ("[limits]", "[limit]"),
    ("load_kg = 2", "load_kg = 0"),
    ("tick_hz = 2000", "tick_hz = 2001"),
    ("[[program]]              # mix", "[[program]"),
];

/// Returns wrong texts, each with its own mistake.
fn texts() -> Vec<String> {
    let default = library::find("default").expect("a built-in scene").text;
    let changed = WRONG.iter().map(|&(from, to)| {
        assert!(default.contains(from), "{from}");
        default.replacen(from, to, 1)
    });
    // Several mistakes at once are reported together.
    let many = default
        .replacen("amax_g = 12", "amax_g = -1", 1)
        .replacen("load_kg = 2", "load_kg = 0", 1)
        .replacen("steps_per_turn = 3200", "steps_per_turn = 1", 1);
    let others = [String::new(), "name = 1".to_owned(), many];
    changed.chain(others).collect()
}

/// Returns the error text of `cophase run` with a scene file of the name `scene.toml`.
fn of_the_command(text: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, text).expect("a scene is written");
    let command = Command::try_parse_from([
        "cophase".as_ref(),
        "run".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        folder.path().join("out").as_os_str(),
    ]);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = command.expect("arguments").run(&mut out, &mut err);
    assert_eq!(status, Status::BadInput, "of this text:\n{text}");
    let printed = String::from_utf8(err).expect("UTF-8");
    let lines = printed
        .lines()
        .map(|line| line.replacen("cophase: ", "", 1));
    let file = scene.display().to_string();
    let lines: Vec<_> = lines
        .map(|line| line.replace(&file, "scene.toml"))
        .collect();
    lines.join("\n")
}

#[test]
fn preview_mistakes_match_those_of_the_command() {
    let texts = texts();
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let Some(previews) = support::preview(&texts) else {
        return;
    };
    for (text, previewed) in texts.iter().zip(&previews) {
        let mistakes = previewed.answer["mistakes"].as_array().expect("a list");
        let lines: Vec<String> = mistakes
            .iter()
            .map(|mistake| {
                let line = mistake["line"].as_u64();
                let line = line.map_or(String::new(), |line| format!(":{line}"));
                format!(
                    "scene.toml{line}: {}",
                    mistake["text"].as_str().expect("text")
                )
            })
            .collect();
        assert_eq!(
            lines.join("\n"),
            of_the_command(text),
            "of this text:\n{text}"
        );
        assert!(previewed.rows.is_empty());
    }
}

/// A curve from a file is refused, because a page has no folder. The message names the keys to give instead.
#[test]
fn tables_in_files_are_refused() {
    let mut drawn = (0..).map(|seed| draw(seed, Kinds::ALL));
    let drawn = drawn.find(|drawn| drawn.table.is_some());
    let text = drawn.expect("a scene with a table in a file").text;
    let Some(previews) = support::preview(&[&text]) else {
        return;
    };
    let mistakes = previews[0].answer["mistakes"].as_array().expect("a list");
    let text = mistakes[0]["text"].as_str().expect("text");
    assert!(text.starts_with("cam_table["), "{text}");
    assert!(
        text.contains("give the curve as [[cam_table.segment]]"),
        "{text}"
    );
}
