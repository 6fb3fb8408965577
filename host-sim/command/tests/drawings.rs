//! `cophase scenes NAME --svg FILE`: the drawing of each machine has its symbols and matches the documentation.

use std::path::Path;
use std::process::Output;

/// Scene, the picture from docs/machines/, and labels that the picture must have.
const DRAWINGS: [(&str, &str, &[&str]); 8] = [
    (
        "default",
        "../machine.svg",
        &[
            "R",
            "L = R/λ",
            "α",
            "ω",
            "z",
            "x",
            "y",
            "amax",
            "at α = 0",
            "platform with its load, mass m",
            "direction of the pin at α = 0",
            "the same of a reversed axis",
            "mount radius 200 mm",
            "tilt x &gt; 0: the side of axis 0 is high",
            "tilt y &gt; 0: the +y side is high",
        ],
    ),
    (
        "scotch-yoke",
        "scotch-yoke-drawing.svg",
        &["R", "α", "slot", "mount radius 200 mm"],
    ),
    (
        "crank-rocker",
        "crank-rocker.svg",
        &["A", "B1", "C1", "C2", "D", "rocker 1"],
    ),
    (
        "wrapper",
        "cam-drawing.svg",
        &["m1", "m2", "m3", "k1, c1: shaft", "s", "pusher"],
    ),
    (
        "electronic-cam",
        "electronic-cam-drawing.svg",
        &["rise", "dwell", "return", "H"],
    ),
    (
        "screen",
        "screen-drawing.svg",
        &["p1", "p2", "G", "R", "K/2, ζ"],
    ),
    (
        "jaw-crusher",
        "jaw-crusher-drawing.svg",
        &["l", "r", "g", "rock F"],
    ),
    (
        "five-bar",
        "five-bar-drawing.svg",
        &["l1", "l2", "l3 = l1", "l4", "q1", "q2", "path"],
    ),
];

fn scenes(dir: &Path, arguments: &[&str]) -> Output {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
    command.current_dir(dir).arg("scenes").args(arguments);
    command.output().unwrap()
}

/// If this fails, a drawing lacks a symbol that the machine's page explains, or differs from the one on that page. The command on the page
/// writes the drawing again.
#[test]
fn each_machine_is_drawn_with_its_symbols() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/machines");
    for (scene, picture, labels) in DRAWINGS {
        let folder = tempfile::tempdir().unwrap();
        let output = scenes(folder.path(), &[scene, "--svg", "drawing.svg"]);
        assert!(output.status.success(), "{scene}: {output:?}");
        assert!(output.stdout.is_empty());
        let svg = std::fs::read_to_string(folder.path().join("drawing.svg")).unwrap();
        for label in labels {
            assert!(svg.contains(&format!(">{label}<")), "{scene}: no {label}");
        }
        let committed = std::fs::read_to_string(docs.join(picture)).unwrap();
        assert!(
            svg == committed,
            "docs/machines/{picture} is not the drawing of {scene}"
        );
    }
}

/// If this fails, a view shows more or fewer axes than the platform has, or a platform below its cranks has its acceleration drawn the
/// wrong way.
#[test]
fn both_views_have_every_axis() {
    for (scene, count) in [
        ("default", 4),
        ("patent-1", 6),
        ("patent-2", 2),
        ("patent-4", 3),
        ("scotch-yoke", 3),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = scenes(folder.path(), &[scene, "--svg", "drawing.svg"]);
        assert!(output.status.success(), "{scene}: {output:?}");
        let svg = std::fs::read_to_string(folder.path().join("drawing.svg")).unwrap();
        for axis in 0..=6 {
            let drawn = svg.matches(&format!(">{axis}</text>")).count();
            let expected = if axis < count { 2 } else { 0 };
            assert_eq!(drawn, expected, "{scene}: axis {axis}");
        }
        let is_above = !scene.starts_with("patent");
        // Each letter has one meaning: x and y are in the view from above, z is the height.
        for label in ["x", "y", if is_above { "z" } else { "−z" }] {
            let drawn = svg.matches(&format!(">{label}</text>")).count();
            assert_eq!(drawn, 1, "{scene}: {label}");
        }
        let [platform, arrow] = ["platform with its load, mass m", "amax"].map(|label| {
            let (before, _) = svg.split_once(&format!(">{label}<")).expect("a label");
            let (_, y) = before.rsplit_once(" y=\"").expect("its place");
            let y: f64 = y.split('"').next().unwrap().parse().expect("a number");
            y
        });
        assert_eq!(platform < arrow, is_above, "{scene}: towards the cranks");
    }
}

/// If this fails, a drawing is written without a scene, or to a place where no file can be.
#[test]
fn bad_arguments_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str], what: &str| {
        let output = scenes(folder.path(), arguments);
        let words = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(words.contains(what), "{words}");
    };
    refused(&["--svg", "x.svg"], "NAME");
    refused(
        &["no-such-scene", "--svg", "x.svg"],
        "there is no built-in scene",
    );
    refused(&["screen", "--svg", ".."], "--svg");
    assert!(!folder.path().join("x.svg").exists());
}

/// If this fails, one command creates the folder of its output, and another one refuses it.
#[test]
fn folders_of_outputs_are_created_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let design = "design --load-kg 10 --amax-g 10 --freq-hz 5 --lambda 0.3 --motors 3 --svg";
    for (arguments, output, written) in [
        ("scenes default --svg", "a/new/x.svg", "a/new/x.svg"),
        (design, "b/new/x.svg", "b/new/x.svg"),
        ("reproduced --out", "c/new/x.md", "c/new/x.md"),
        (
            "settings default --out",
            "d/new/x.settings",
            "d/new/x.settings",
        ),
        ("man", "e/new", "e/new/cophase.1"),
        ("run patent-4 --out", "f/new", "f/new/report.json"),
    ] {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
        let command = command
            .current_dir(&folder)
            .args(arguments.split(' '))
            .arg(output);
        let done = command.output().unwrap();
        assert_ne!(done.status.code(), Some(2), "{arguments}: {done:?}");
        assert!(folder.path().join(written).exists(), "{arguments}");
    }
}

/// If this fails, the list omits which sensors a scene has, or whether it corrects the measured phase errors.
#[test]
fn the_list_has_sensors_and_correction() {
    let folder = tempfile::tempdir().unwrap();
    let output = scenes(folder.path(), &[]);
    let list = String::from_utf8(output.stdout).unwrap();
    let heading = list.lines().next().unwrap();
    let columns = ["sensors", "correction", "description"].map(|name| heading.find(name).unwrap());
    for (scene, sensors, correction) in [
        ("default", "index", "none"),
        ("coupling-slip", "index", "trim"),
        ("five-bar", "none", "none"),
    ] {
        let row = list
            .lines()
            .find(|line| line.trim_start().starts_with(&format!("{scene} ")))
            .unwrap();
        let cell = |from: usize, to: usize| row[from..to].trim();
        assert_eq!(cell(columns[0], columns[1]), sensors, "{scene}");
        assert_eq!(cell(columns[1], columns[2]), correction, "{scene}");
    }
}
