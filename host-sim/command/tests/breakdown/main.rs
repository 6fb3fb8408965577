//! The failures that the `breakdown` chart shows, and the check that catches each one.

mod branch;
mod cam;
mod capture;
mod friction;
mod motors;
mod self_synchronisation;
mod singular;
mod stall;
mod steps;

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use cophase_core::supervisor::State;
use cophase_lab::chart::breakdown::{band, lambda, root, runs};
use cophase_lab::chart::{Size, find};

/// Runs `cophase run` on a scene, with its output in `out` below a folder.
fn cophase(folder: &Path, text: &str) -> Output {
    std::fs::write(folder.join("scene.toml"), text).unwrap();
    Command::cargo_bin("cophase")
        .expect("the command is built")
        .current_dir(folder)
        .args(["run", "scene.toml", "--out", "out"])
        .output()
        .expect("it runs")
}

/// Asserts that a scene is refused with status 2 and that no file is written. Returns the message.
#[track_caller]
fn refused(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = cophase(folder.path(), text);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(!folder.path().join("out").exists(), "something was written");
    String::from_utf8(output.stderr).unwrap()
}

/// Asserts that a run ends with status 1 and writes all its files. Returns its report.
#[track_caller]
fn failed(text: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let output = cophase(folder.path(), text);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    // The trace has a header and a row for each tick up to the end of the run. The run goes far enough for 100 rows.
    assert!(read("trace.csv").lines().count() > 100);
    assert!(read("steps.vcd").contains("$enddefinitions"));
    assert!(read("scope.svg").trim_end().ends_with("</svg>"));
    serde_json::from_str(&read("report.json")).unwrap()
}

/// If this fails, a program that starts from rest commands an acceleration that no machine has, or causes a fault.
#[test]
fn a_ramp_from_rest_keeps_the_acceleration_limit() {
    let facts = root::measure().unwrap();
    // In its first tick of length h, the root rises to √(40 g h / R (1 + λ)) / 2π, which is 1261 rev/s² h.
    let requested = facts.requested_hz_per_s();
    assert!((1250.0..1270.0).contains(&requested), "{requested} rev/s²");
    // A speed is a whole number of 2⁻⁴⁸ turns a tick. A difference of two speeds is off by at most one such unit: 1.4e-8 rev/s².
    let max = facts.commanded_hz_per_s();
    assert!(max <= root::LIMIT_HZ_PER_S + 1e-6, "{max} rev/s²");
    assert!(max > 0.999 * root::LIMIT_HZ_PER_S, "the limit is used");
    // The command lags until a linear rise meets √t: 28.2 √t = 60 t at 0.22 s. Jerk of 6000 rev/s³ adds 10 ms at either end.
    let behind_s = facts.behind_s().expect("it is reported");
    assert!((0.21..0.25).contains(&behind_s), "{behind_s} s");
    assert_eq!(facts.outcome.fault, None);
    assert_eq!(facts.outcome.state, State::Parked);
}

/// If this fails, the frame's amplitude does not depend on the time at the resonance, or a shaft stays in the band longer than
/// necessary.
#[test]
fn slower_band_crossings_give_larger_amplitudes() {
    let facts = band::measure(Size::Small).unwrap();
    // Theory of one mass: m R / (M + m) · 1/2ζ = 5.95 mm. Harmonics and the weight of the displaced mass add a few per cent.
    let theory_um = 5e-3 / 21.0 / (2.0 * 0.02) * 1e6;
    let off = facts.dwelling_um / theory_um - 1.0;
    assert!(
        off.abs() < 0.05,
        "{} µm, theory {theory_um}",
        facts.dwelling_um
    );
    for pair in facts.crossings.windows(2) {
        assert!(pair[0].frame_um > 1.2 * pair[1].frame_um, "{pair:?}");
    }
    assert!(facts.crossings[0].frame_um < facts.dwelling_um);
    // At 10.2 rev/s the amplitude of a mass without damping is r²/(1 − r²) = 2.56 times m R / (M + m). The transient is up to
    // twice that.
    let edge_um = 2.0 * 2.56 * 5e-3 / 21.0 * 1e6;
    assert!(facts.held_um < edge_um, "{} µm", facts.held_um);
    assert!(
        edge_um < 0.25 * facts.dwelling_um,
        "the edge is no resonance"
    );
    let held_s = facts.held_s.expect("it is reported");
    assert!(held_s > 3.9, "{held_s} s");
    // The shaft crosses the width at full acceleration, which it reaches long before the band and keeps until long after. Add a
    // tick at either end.
    for crossing in &facts.crossings {
        let width_hz = band::BAND_HZ.1 - band::BAND_HZ.0;
        let max_s = width_hz / crossing.hz_per_s + 1.1e-3;
        assert!(
            crossing.inside_s <= max_s,
            "{crossing:?}, at most {max_s} s"
        );
    }
}

/// Item 7 of `docs/reproduced.md`. If this fails, the error of the two-term approximation is wrong, or a λ outside the allowed
/// range is accepted.
#[test]
fn published_errors_hold_at_both_ends_of_lambda() {
    for (ratio, published_percent) in [(0.1, 0.046), (0.6, 9.375)] {
        let facts = lambda::measure(ratio).unwrap();
        // The tolerance is half of the last published digit.
        assert!(
            (facts.error * 100.0 - published_percent).abs() <= 5e-4,
            "{facts:?}"
        );
        let from_90 = (facts.at_deg.rem_euclid(180.0) - 90.0).abs();
        assert!(from_90 < 0.01, "{facts:?}");
        assert_eq!(runs::refusal(&lambda::scene(ratio)), None);
    }
    for ratio in [0.05, 0.7] {
        let said = refused(&lambda::scene(ratio));
        assert!(
            said.contains("machine.lambda") && said.contains("0.1 to 0.6"),
            "{said}"
        );
    }
}

/// If this fails, the chart lacks a panel or its picture, or differs between runs.
#[test]
fn the_chart_has_all_panels() {
    let chart = find("breakdown").expect("it is a chart");
    let draw = || (chart.draw)(Size::Small, &mut |_, _| {}).unwrap();
    let (one, other) = (draw(), draw());
    assert_eq!(one.files("breakdown"), other.files("breakdown"));
    let mut panels: Vec<String> = csv::Reader::from_reader(one.csv.as_bytes())
        .records()
        .map(|record| record.unwrap()[0].to_owned())
        .collect();
    panels.dedup();
    assert_eq!(
        panels,
        [
            "root",
            "band",
            "pull-out",
            "chain",
            "rods",
            "overload",
            "lambda",
            "branch",
            "cam",
            "capture",
            "self-synchronisation",
            "stall",
            "singular",
            "friction",
        ]
    );
    let parts: Vec<_> = one.pictures.iter().map(|picture| picture.part).collect();
    let expected: Vec<_> = panels.iter().map(|panel| Some(panel.as_str())).collect();
    assert_eq!(parts, expected);
    // The text has one sentence for each panel.
    assert_eq!(one.says.lines().count(), panels.len());
    for says in one.says.lines() {
        let sentence = says.strip_suffix('.').expect("a sentence");
        assert!(!sentence.contains(". "), "more than one: {says}");
    }
    // Each legend has the lines of its own panel.
    for record in csv::Reader::from_reader(one.csv.as_bytes()).records() {
        let record = record.unwrap();
        let (panel, line, is_level) = (&record[0], &record[1], record[2].is_empty());
        let picture = one
            .pictures
            .iter()
            .find(|picture| picture.part == Some(panel))
            .expect("each panel has a picture");
        let entry = line.replace(", of the true peak", "");
        assert!(is_level || picture.svg.contains(&entry), "{panel}: {line}");
    }
}
