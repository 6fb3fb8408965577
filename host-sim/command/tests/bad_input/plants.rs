//! Errors in machines other than platforms on cranks: their loads and their motors.

use cophase_scene::library;

use super::{assert_all_refused, case};

#[test]
fn invalid_crushers_are_refused() {
    let crusher = library::find("jaw-crusher").unwrap().text;
    let with = |from: &str, to: &str| {
        assert!(crusher.contains(from), "{from}");
        crusher.replacen(from, to, 1)
    };
    assert_all_refused(&[
        case(
            "crusher whose shaft cannot turn",
            with("toggle_mm = 250", "toggle_mm = 5"),
            "crusher.ground_mm",
            "the shaft cannot turn all round",
            "change it, or the lengths",
        ),
        case(
            "crusher with two keys of a platform",
            with("[crusher]", "[crusher]\nload_kg = 3\nmount_radius_mm = 200"),
            "crusher.load_kg",
            "load_kg, mount_radius_mm are keys of [machine], and a scene has one machine, here [crusher]",
            "leave them out",
        ),
        case(
            "crusher with one key of a platform",
            with("[crusher]", "[crusher]\nmount_radius_mm = 200"),
            "crusher.mount_radius_mm",
            "it belongs under [machine], and a scene has one machine",
            "leave it out",
        ),
        case(
            "crusher with two axes",
            with("count = 1", "count = 2"),
            "axes.count",
            "2",
            "1",
        ),
        case(
            "crusher with a force below its jaw's end",
            with("jaw_centre_mm = 463.4", "jaw_centre_mm = 900"),
            "crusher.jaw_centre_mm",
            "outside 0 to 800",
            "0 to 800",
        ),
        case(
            "crusher whose rock ends before it begins",
            with("rock_turns = [24, 54]", "rock_turns = [24, 20]"),
            "crusher.rock_turns[1]",
            "outside 24 to",
            "24",
        ),
        case(
            "induction drive without its motor",
            with(
                "induction = {",
                "servo = { velocity_gain_nms = 5, limit_nm = 5 } # {",
            ),
            "axes.servo.position_gain_per_s",
            "missing",
            "",
        ),
        case(
            "induction motor without its drive",
            with("drive = \"induction\"", "drive = \"pulse-servo\""),
            "axes.induction",
            "no axis here has drive = \"induction\"",
            "leave it out",
        ),
        case(
            "motor without slip",
            with("rated_slip_hz = 0.1351", "rated_slip_hz = 0"),
            "axes.induction.rated_slip_hz",
            "outside",
            "0.0001",
        ),
        case(
            "crusher that tilts",
            with("common_limit_deg = 25", "tilt_limit_mrad = 1 #"),
            "drift.tilt_limit_mrad",
            "[crusher] has none",
            "leave it out",
        ),
        case(
            "crusher on a frame",
            with(
                "[limits]",
                "[frame]\nmass_kg = 60\nsuspension_n_per_mm = 40\n[limits]",
            ),
            "frame",
            "[crusher] has none",
            "leave it out",
        ),
        case(
            "crusher whose tilt is a question",
            with("[questions]", "[questions]\ntilt_mrad = 1"),
            "questions.tilt_mrad",
            "[crusher] has none",
            "leave it out",
        ),
        case(
            "crusher with torque setpoints",
            with("drive = \"induction\"", "drive = \"servo\""),
            "axes.drive",
            "knows no torque of a jaw crusher",
            "takes STEP and DIR",
        ),
    ]);
}

#[test]
fn invalid_five_bar_arms_are_refused() {
    let arm = library::find("five-bar").unwrap().text;
    let with = |from: &str, to: &str| {
        assert!(arm.contains(from), "{from}");
        arm.replacen(from, to, 1)
    };
    let path = "path_mm = [[0, 300], [200, 300]]";
    assert_all_refused(&[
        case(
            "path out of reach",
            with(path, "path_mm = [[450, 300], [0, 300]]"),
            "five_bar.path_mm",
            "from the axis, and links 1 and 4 reach 500 mm",
            "lengthen the links",
        ),
        case(
            "path through the axis",
            with(path, "path_mm = [[-100, 0.001], [100, 0.001]]"),
            "five_bar.path_mm",
            "nearly singular there",
            "move the path or lower the margin",
        ),
        case(
            "path to the edge of the reach",
            with(path, "path_mm = [[0, 300], [0, 499]]"),
            "five_bar.path_mm",
            "below five_bar.margin = 0.2",
            "move the path",
        ),
        case(
            "path of one point",
            with(path, "path_mm = [[0, 300]]"),
            "five_bar.path_mm",
            "fewer than two points",
            "give the points",
        ),
        case(
            "line that is too short for its blends",
            with(path, "path_mm = [[0, 300], [5, 300]]"),
            "five_bar.path_mm",
            "too short for blends",
            "shorten the blends",
        ),
        case(
            "surface along a triangle",
            with(path, "path_mm = [[0, 300], [200, 300], [100, 350]]"),
            "five_bar.contact",
            "more than two points",
            "give two",
        ),
        case(
            "arm with three motors",
            with("count = 2", "count = 3"),
            "axes.count",
            "is not 2",
            "a five-bar arm has",
        ),
        case(
            "arm with a table of its own",
            with(
                "[control]",
                "[[cam_table]]\nname = \"x\"\nsegment = [{ deg = 100 }]\n[control]",
            ),
            "cam_table[0]",
            "makes the tables of both joints",
            "leave it out",
        ),
        case(
            "joint with a table of its own",
            with(
                "[[program]]",
                "[[axis]]\nnumber = 1\ncam = \"x\"\n\n[[program]]",
            ),
            "axis[0].cam",
            "makes the tables of both joints",
            "leave it",
        ),
        case(
            "joint whose table is shifted",
            with(
                "[[program]]",
                "[[axis]]\nnumber = 0\ncam = \"joint-1\"\ncam_shift_deg = 90\n\n[[program]]",
            ),
            "axis[0].cam",
            "makes the tables of both joints",
            "leave it",
        ),
        case(
            "table with the name of a joint's",
            with(
                "[control]",
                "[[cam_table]]\nname = \"joint-1\"\nsegment = [{ deg = 100 }]\n[control]",
            ),
            "cam_table[0]",
            "makes the tables of both joints",
            "leave it out",
        ),
        case(
            "path through a point that is no number",
            with(path, "path_mm = [[nan, 300], [200, 300]]"),
            "five_bar.path_mm[0][0]",
            "NaN is not a finite number",
            "-20000",
        ),
        case(
            "arm without a mass",
            with(
                "links_kg = [1.2, 0.6, 0.6, 1.0]",
                "links_kg = [1.2, 0, 0.6, 1.0]",
            ),
            "five_bar.links_kg[1]",
            "outside",
            "0.001",
        ),
        case(
            "program level that is too fast",
            with("ramp_s = 1\n", "amax_g = 1\nramp_s = 1\n"),
            "program[0].amax_g",
            "over limits.speed_hz",
            "give at most",
        ),
    ]);
}

/// If this fails, a screen runs up with motors that its resonance may capture, and the user gets only a warning.
#[test]
fn screens_without_torque_for_the_resonance_are_refused() {
    let text = library::find("screen").unwrap().text;
    let edit = |from: &str, to: &str| {
        assert!(text.contains(from), "the screen has no {from}");
        text.replacen(from, to, 1)
    };
    // Each shaft needs 103 N·m for the damping and 71 N·m for a block's weight (docs/machines/screen.md).
    let weak = edit("limit_nm = 399", "limit_nm = 150");
    let stepper = edit(
        "servo = { position_gain_per_s = 40, velocity_gain_nms = 700, limit_nm = 399, following_error_deg = 30 }",
        "damping_nms = 30\npull_out = [[0, 200.0], [3, 160.0], [60, 100.0]]",
    );
    let stepper = stepper.replacen("pulse-servo", "stepper", 1);
    assert_all_refused(&[
        case(
            "a weak servo",
            weak.clone(),
            "axes.servo.limit_nm",
            "173.5 N·m",
            "screen.allow_capture = true",
        ),
        case(
            "a weak stepper",
            stepper,
            "axes.pull_out",
            "reserve is -",
            "raise the torque",
        ),
    ]);
    let dir = tempfile::tempdir().unwrap();
    let allowed = weak.replacen("[screen]", "[screen]\nallow_capture = true", 1);
    std::fs::write(dir.path().join("scene.toml"), allowed).unwrap();
    let output = super::cophase(dir.path(), &["run", "scene.toml"]);
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_ne!(output.status.code(), Some(2), "{words}");
}
