//! Errors in cams with followers, and keys that belong to cranks.

use cophase_scene::library;

use super::edit::{BASE, append, replace};
use super::{Case, assert_all_refused, case};

/// Returns the built-in scene for cams with a part of its text replaced.
#[track_caller]
fn edit(from: &str, to: &str) -> String {
    let wrapper = library::find("wrapper").unwrap().text;
    assert!(wrapper.contains(from), "the wrapper scene has no {from}");
    wrapper.replace(from, to)
}

/// Returns that same scene with text appended.
fn after(text: &str) -> String {
    format!("{}\n{text}", library::find("wrapper").unwrap().text)
}

const MASSES: &str = "masses_kg = [0.525, 0.102, 1.01]";
const SPRINGS: &str = "stiffness_n_per_mm = [7680, 7500, 102000]";
const DAMPERS: &str = "dampers_ns_per_m = [402, 175, 2030]";

#[test]
fn a_scene_needs_either_a_machine_or_a_cam() {
    let cam = "[cam]\nrise_mm = 84\nrise_deg = 120\ndwell_deg = 135\nreturn_deg = 105\n";
    let (name, rest) = BASE.split_once("[machine]").unwrap();
    let (_, rest) = rest.split_once("[control]").unwrap();
    let neither = format!("{name}[control]{rest}");
    assert_all_refused(&[
        case(
            "both",
            append(cam),
            "cam",
            "together with [machine]",
            "leave one out",
        ),
        case("neither", neither, "machine", "missing", "or [cam]"),
    ]);
}

/// Machines without a platform may have ratios to the master.
#[test]
fn invalid_ratios_of_cam_shafts_are_refused() {
    let ratio = |name, pair: &str, wrong, right| {
        let text = edit("[axes]\n", &format!("[axes]\nratio = {pair}\n"));
        case(name, text, "axes.ratio", wrong, right)
    };
    assert_all_refused(&[
        ratio("nothing", "[0, 1]", "numerator 0 is outside", "1 to 1000"),
        ratio(
            "over nothing",
            "[1, 0]",
            "denominator 0 is outside",
            "1 to 1000",
        ),
        ratio(
            "too fast",
            "[1000, 1]",
            "turns a tick",
            "lower limits.speed_hz or the ratio",
        ),
    ]);
}

#[test]
fn invalid_cam_angles_and_heights_are_refused() {
    let number = |name, from, to, key, wrong, right| case(name, edit(from, to), key, wrong, right);
    assert_all_refused(&[
        number(
            "more than a turn",
            "dwell_deg = 135",
            "dwell_deg = 140",
            "cam.return_deg",
            "365 of the 360",
            "at most 100",
        ),
        number(
            "no rise",
            "rise_deg = 120",
            "rise_deg = 0",
            "cam.rise_deg",
            "0° is outside",
            "5 to 355°",
        ),
        number(
            "NaN",
            "rise_mm = 84",
            "rise_mm = nan",
            "cam.rise_mm",
            "is not a",
            "finite number",
        ),
        number(
            "steeper than a crank",
            "return_deg = 105",
            "return_deg = 40",
            "cam.rise_mm",
            "866.1170",
            "0.0097 to 48.4922 mm",
        ),
        number(
            "no such law",
            "\"modified-sine\"",
            "\"modified-cosine\"",
            "cam.law",
            "none of its values",
            "did you mean \"modified-sine\"?",
        ),
        number(
            "key of a crank",
            "rise_mm = 84",
            "crank_radius_mm = 84\nrise_mm = 84",
            "cam.crank_radius_mm",
            "unknown key",
            "[machine]",
        ),
        number(
            "without a rise",
            "rise_mm = 84\n",
            "",
            "cam.rise_mm",
            "missing",
            "such as `rise_mm = 84`",
        ),
    ]);
}

#[test]
fn invalid_masses_springs_and_dampers_are_refused() {
    let number =
        |name, from, to: &str, key, wrong, right| case(name, edit(from, to), key, wrong, right);
    assert_all_refused(&[
        number(
            "masses alone",
            SPRINGS,
            "",
            "cam.stiffness_n_per_mm",
            "missing beside cam.masses_kg",
            "give three",
        ),
        number(
            "springs alone",
            MASSES,
            "",
            "cam.masses_kg",
            "missing beside",
            "give three",
        ),
        number(
            "two masses",
            MASSES,
            "masses_kg = [0.5, 1]",
            "cam.masses_kg",
            "has 2 in it, where a list of three numbers belongs",
            "such as",
        ),
        number(
            "four dampers",
            DAMPERS,
            "dampers_ns_per_m = [402, 175, 2030, 1]",
            "cam.dampers_ns_per_m",
            "has 4 in it, where a list of three numbers belongs",
            "such as",
        ),
        number(
            "a mass of nothing",
            MASSES,
            "masses_kg = [0.5, 0, 1]",
            "cam.masses_kg[1]",
            "0 is outside",
            "0.0001 to 1000",
        ),
        number(
            "in N/m",
            SPRINGS,
            "stiffness_n_per_m = [7680, 7500, 102000]",
            "cam.stiffness_n_per_m",
            "unknown key",
            "`stiffness_n_per_mm`, in N/mm",
        ),
        number(
            "no damping",
            DAMPERS,
            "",
            "cam.zeta",
            "missing",
            "such as 0.1, or cam.dampers_ns_per_m",
        ),
        number(
            "damping twice",
            DAMPERS,
            &format!("{DAMPERS}\nzeta = 0.1"),
            "cam.zeta",
            "together with cam.dampers_ns_per_m",
            "leave one out",
        ),
        case(
            "dampers of nothing",
            edit(MASSES, "").replace(SPRINGS, ""),
            "cam.dampers_ns_per_m",
            "damps nothing",
            "cam.masses_kg",
        ),
        number(
            "where a damper ends",
            "damper = \"cam\"",
            "damper = \"shaft\"",
            "cam.damper",
            "none of its values",
            "\"cam\", \"ground\"",
        ),
    ]);
}

#[test]
fn unsuitable_model_levels_and_methods_are_refused() {
    let model_level = |name: &'static str, key, wrong, right| {
        let text = format!(
            "fidelity = \"{name}\"\n{}",
            library::find("wrapper").unwrap().text
        );
        case(name, text, key, wrong, right)
    };
    let method = |name, text: &str, wrong, right| {
        case(
            name,
            after(&format!("[method]\n{text}\n")),
            "method",
            wrong,
            right,
        )
    };
    let mut cases: Vec<Case> = vec![
        model_level(
            "quasi-static",
            "fidelity",
            "\"quasi-static\" is no model level of a cam shaft",
            "it has kinematic, elastic",
        ),
        model_level(
            "rigid",
            "fidelity",
            "\"rigid\" is no model level of a cam shaft",
            "it has kinematic, elastic",
        ),
        model_level(
            "phased",
            "fidelity",
            "\"phased\" is no model level of a cam shaft",
            "it has kinematic, elastic",
        ),
        case(
            "elastic without masses",
            format!(
                "fidelity = \"elastic\"\n{}",
                edit(MASSES, "").replace(SPRINGS, "").replace(DAMPERS, "")
            ),
            "cam.masses_kg",
            "missing",
            "let fidelity be \"kinematic\"",
        ),
        // RK4's limit is 81.1 us: 6 steps are 83.3, 7 are 71.4.
        method(
            "too coarse",
            "name = \"rk4\"\nsteps_per_tick = 6",
            "83.3333 us is beyond the stability limit of RK4",
            "steps_per_tick = 7 or more, or a method without a limit",
        ),
        method(
            "explicit",
            "name = \"explicit-euler\"\nsteps_per_tick = 1",
            "beyond the stability limit of explicit Euler with this follower, 20.1",
            "steps_per_tick = 25 or more",
        ),
        case(
            "exact for rotors",
            replace("fidelity = \"auto\"", "fidelity = \"phased\"")
                + "\n[method]\nname = \"exact\"\n",
            "method",
            "exact discretisation needs a linear system",
            "take RK4",
        ),
    ];
    for (key, line) in [
        ("axes.pull_out", "pull_out = [[0, 20.0]]"),
        ("axes.friction_nm", "friction_nm = 1"),
        (
            "axes.servo",
            "servo = { position_gain_per_s = 1, velocity_gain_nms = 1 }",
        ),
    ] {
        let text = edit("count = 4", &format!("count = 4\n{line}"));
        cases.push(case(key, text, key, "concerns torque", "leave it out"));
    }
    let tilt = edit("warp_limit_deg = 1", "tilt_limit_mrad = 2");
    cases.push(case(
        "tilt",
        tilt,
        "drift.tilt_limit_mrad",
        "is of a platform",
        "drift.warp_limit_deg",
    ));
    assert_all_refused(&cases);
}
