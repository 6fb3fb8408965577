//! User-level tests of charts of a user's scene.

use std::collections::HashMap;
use std::path::Path;

use cophase_lab::chart::CHARTS;
use cophase_scene::library;

use super::{assert_documented, chart, number, rows};

type Row = HashMap<String, String>;

/// Draws a small chart of a scene, and returns its data, its picture and the message of the command. Its columns are checked.
fn drawn(name: &str, scene: &str) -> (Vec<Row>, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap();
    let output = chart(&[name, scene, "--size", "small", "--out", place]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let stem = Path::new(scene).file_stem().unwrap().to_str().unwrap();
    let read = |ending| {
        let file = folder.path().join(format!("{name}-{stem}.{ending}"));
        std::fs::read_to_string(file).unwrap()
    };
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    let said = String::from_utf8(output.stdout).unwrap();
    let csv = read("csv");
    let documented = match name {
        "fidelity" => name.to_owned(),
        _ => format!("{name}-SCENE"),
    };
    assert_documented(&documented, &csv);
    (rows(&csv), read("svg"), said)
}

/// Writes a built-in scene with one text replaced as a file, and returns its folder and its path.
fn scene_file(scene: &str, text: &str, by: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my-machine.toml");
    let built_in = library::find(scene).unwrap().text;
    assert!(built_in.contains(text), "{text}");
    std::fs::write(&path, built_in.replacen(text, by, 1)).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (folder, path)
}

/// Returns the message with which a chart of a scene is refused.
fn refused(name: &str, scene: &str) -> String {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("charts");
    let out = folder.to_str().unwrap();
    let output = chart(&[name, scene, "--size", "small", "--out", out]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(!folder.exists(), "nothing is written");
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

fn are_finite(rows: &[Row], columns: &[&str]) {
    for row in rows {
        for column in columns {
            assert!(number(row, column).is_finite(), "{column} in {row:?}");
        }
    }
}

/// Returns the orders of convergence of a method: how the error falls from each step length to its half.
fn orders(rows: &[Row], method: &str) -> Vec<f64> {
    let is_of = |row: &&Row| row["method"] == method && row["taken"] == "false";
    let runs: Vec<_> = rows.iter().filter(is_of).collect();
    // Nearer to the uncertainty the reference's own error has an effect.
    let is_clear = |row: &Row| number(row, "error") > 100.0 * number(row, "reference_uncertainty");
    let clear = runs.windows(2).filter(|pair| is_clear(pair[1]));
    let ratio = |pair: &[&Row]| number(pair[0], "error") / number(pair[1], "error");
    clear.map(|pair| ratio(pair).log2()).collect()
}

/// If this fails, the errors of the chart are not those of the methods: the reference, the commands or the times of steps are wrong.
#[test]
fn errors_on_a_scene_fall_with_the_order_of_the_method() {
    for scene in ["patent-3", "suspended"] {
        let (rows, ..) = drawn("methods", scene);
        for (method, order) in [
            ("explicit Euler", 1.0),
            ("implicit midpoint", 2.0),
            ("RK4", 4.0),
        ] {
            let found = orders(&rows, method);
            assert!(found.len() >= 2, "{scene}: {method}: {found:?}");
            for found in found {
                assert!((found - order).abs() < 0.5, "{scene}: {method}: {found}");
            }
        }
    }
}

/// If this fails, a chart is not about the step that a run takes.
#[test]
fn the_method_chart_of_a_scene_marks_its_own_method_and_step() {
    let (_folder, scene) = scene_file(
        "wrapper",
        "[cam]",
        "[method]\nname = \"rk4\"\nsteps_per_tick = 24\n\n[cam]",
    );
    let (rows, svg, said) = drawn("methods", &scene);
    are_finite(
        &rows,
        &["step_s", "evaluations_per_s", "reference_uncertainty"],
    );
    let own: Vec<_> = rows.iter().filter(|row| row["taken"] == "true").collect();
    let [own] = own[..] else {
        panic!("{own:?}");
    };
    assert_eq!((&*own["method"], &*own["steps_per_tick"]), ("RK4", "24"));
    // Each of its steps evaluates the rates four times, at the scene's 2000 ticks a second.
    assert_eq!(number(own, "evaluations_per_s"), 24.0 * 4.0 * 2000.0);
    assert!(number(own, "error") > 10.0 * number(own, "reference_uncertainty"));
    assert!(said.contains("takes RK4 with 24 steps a tick"), "{said}");
    for text in [
        "RK4 (taken by the scene)",
        "24 steps a tick",
        "10 × uncertainty",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

/// If this fails, the chart states another limit than the one by which a scene with such a step is refused.
#[test]
fn a_step_beyond_the_longest_stable_step_of_the_chart_is_refused() {
    for (scene, scheme, key) in [
        ("default", "velocity Verlet", "velocity-verlet"),
        ("wrapper", "RK4", "rk4"),
    ] {
        let with = |steps: u32| {
            let by = format!(
                "fidelity = \"{}\"\nmethod = {{ name = \"{key}\", steps_per_tick = {steps} }}\ndescription",
                if scene == "default" {
                    "phased"
                } else {
                    "elastic"
                }
            );
            scene_file(scene, "description", &by)
        };
        let many = 50;
        let (_folder, fine) = with(many);
        let (rows, svg, said) = drawn("stability", &fine);
        are_finite(
            &rows,
            &["mode_rad_s", "zeta", "step_s", "h_omega", "growth"],
        );
        assert!(svg.contains(&format!("{scheme} (taken by the scene)")));
        let own = rows.iter().find(|row| row["taken"] == "true").unwrap();
        assert_eq!(own["method"], scheme);
        let (limit_s, step_s) = (number(own, "longest_stable_step_s"), number(own, "step_s"));
        let margin = number(own, "margin");
        assert!((margin * step_s / limit_s - 1.0).abs() < 1e-5);
        assert!(said.contains(&format!("{margin:.2} times that")), "{said}");
        let min_steps = (f64::from(many) / margin).ceil() as u32;
        assert!(min_steps > 1, "no step of {scene} is too long");
        let (_folder, longest) = with(min_steps);
        drawn("stability", &longest);
        let (_folder, longer) = with(min_steps - 1);
        let said = refused("stability", &longer);
        assert!(said.contains("beyond the stability limit"), "{said}");
    }
}

/// If this fails, a user cannot see with which model level the scene's outputs are within their tolerances.
#[test]
fn the_fidelity_chart_of_a_scene_has_each_requested_output_on_each_level() {
    let (_folder, scene) = scene_file("suspended", "[questions]", "[questions]\nspread_deg = 0.5");
    let (rows, svg, said) = drawn("fidelity", &scene);
    are_finite(&rows, &["crank_evaluations", "tolerance", "off_top"]);
    for level in ["kinematic", "rigid", "phased", "elastic"] {
        for output in ["lag_deg", "spread_deg", "amax_percent"] {
            let is_it = |row: &&Row| row["model_level"] == level && row["output"] == output;
            let row = rows.iter().find(is_it);
            let row = row.unwrap_or_else(|| panic!("{level}: {output}"));
            assert_eq!(row["taken"], (level == "elastic").to_string());
            assert!(svg.contains(&format!(">{output}<")), "{output}");
        }
        assert!(svg.contains(&format!(">{level}<")), "{level}");
    }
    assert!(said.contains("auto takes the elastic level"), "{said}");
}

/// If this fails, a user is not told why a scene has no method, or what to change.
#[test]
fn a_scene_that_is_not_integrated_is_refused_with_the_levels_that_are() {
    for chart in ["methods", "stability"] {
        let said = refused(chart, "default");
        assert!(
            said.contains("default: fidelity: the kinematic model level")
                && said.contains("let fidelity be \"rigid\" or \"phased\""),
            "{said}"
        );
        let said = refused(chart, "electronic-cam");
        assert!(
            said.contains("for another level cam.masses_kg: missing"),
            "{said}"
        );
    }
    let said = refused("fidelity", "electronic-cam");
    assert!(
        said.contains("questions: the scene requests no output"),
        "{said}"
    );
}

/// If this fails, a mistake in a scene is reported otherwise than by a run.
#[test]
fn errors_in_a_scene_are_those_of_a_run() {
    let (_folder, wrong) = scene_file("patent-3", "[axes]", "[axes]\nspeed = 3");
    for scene in [&*wrong, "patent-33", "nowhere.toml"] {
        let run = assert_cmd::Command::cargo_bin("cophase").unwrap();
        let run = { run }.args(["run", scene]).output().unwrap();
        let run = String::from_utf8(run.stderr).unwrap();
        assert_eq!(refused("methods", scene), run);
    }
}

#[test]
fn a_chart_that_is_not_about_scenes_refuses_one_and_names_those_that_are() {
    let list = String::from_utf8(chart(&["list"]).stdout).unwrap();
    for chart in CHARTS {
        let line = list
            .lines()
            .find(|line| line.starts_with(chart.name))
            .unwrap();
        let takes_scene = chart.draw_scene.is_some();
        assert_eq!(line.contains("of a SCENE"), takes_scene, "{line}");
        if !takes_scene {
            let said = refused(chart.name, "patent-3");
            assert!(
                said.contains("give it to one of methods, stability, fidelity"),
                "{said}"
            );
        }
    }
}
