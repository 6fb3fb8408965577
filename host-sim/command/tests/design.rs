//! `cophase design`: its page, its JSON object and what it refuses.

use std::f64::consts::TAU;

use clap::Parser;
use cophase::design::{DesignArgs, DesignCommandError, run};
use host_sim::design::STANDARD_GRAVITY_MPS2;

/// The source's embodiments: load kg, amax g, frequency Hz, λ, motors.
const EXAMPLES: [(f64, f64, f64, f64, u32); 4] = [
    (50.0, 200.0, 100.0, 0.1, 6),
    (50.0, 200.0, 200.0, 0.1, 2),
    (10.0, 100.0, 20.0, 0.6, 4),
    (10.0, 10.0, 5.0, 0.3, 3),
];

#[track_caller]
fn assert_near(what: &str, ours: f64, theirs: f64, tolerance: f64) {
    let off = (ours - theirs).abs();
    assert!(
        off <= tolerance,
        "{what}: {ours}, expected {theirs} ± {tolerance}"
    );
}

#[derive(Parser)]
struct CommandLine {
    #[command(flatten)]
    design: DesignArgs,
}

/// Parses as the command would, and runs it.
fn command(arguments: &str) -> Result<String, DesignCommandError> {
    let words = std::iter::once("design").chain(arguments.split_whitespace());
    let parsed = CommandLine::try_parse_from(words).expect("a command line that parses");
    let mut out = Vec::new();
    let done = run(&parsed.design, &mut out);
    assert!(
        done.is_ok() || out.is_empty(),
        "wrote in spite of bad input"
    );
    done.map(|()| String::from_utf8(out).expect("text"))
}

const FIRST: &str = "--load-kg 50 --amax-g 200 --freq-hz 100 --lambda 0.1 --motors 6 --gravity 10";

/// If this fails, whoever reads the JSON finds a field missing, added, renamed or in another unit.
#[test]
fn json_has_exactly_the_promised_fields() {
    let text = command(&format!("{FIRST} --json")).expect("a design");
    let json: serde_json::Value = serde_json::from_str(&text).expect("one JSON value");
    let object = json.as_object().expect("an object");
    // Figures of items 1, 3, 4 and 9; a motor has a sixth of the torque, and safety doubles it.
    let numbers = [
        ("crank_radius_mm", 4.6055, 5e-5),
        ("gravity_mps2", 10.0, 0.0),
        ("motor_torque_nm", 38.121, 2e-3),
        ("motor_torque_with_safety_nm", 76.242, 4e-3),
        ("peak_power_w", 141_700.0, 50.0),
        ("rod_length_mm", 46.055, 5e-4),
        ("speed_rad_s", TAU * 100.0, 1e-9),
        ("torque_max_exact_nm", 228.81, 0.05),
        ("torque_max_two_term_nm", 228.725, 0.01),
    ];
    for (name, value, tolerance) in numbers {
        let ours = object[name].as_f64().expect("a number");
        assert_near(name, ours, value, tolerance);
    }
    let warnings = object["warnings"].as_array().expect("a list");
    assert!(!warnings.is_empty());
    for warning in warnings {
        assert!(
            warning.as_str().is_some_and(|w| w.ends_with('.')),
            "{warning}"
        );
    }
    assert_eq!(object.len(), numbers.len() + 1, "{text}");
}

/// If this fails, defaults are not the documented ones, or negative numbers and bad counts are not
/// reported as what they are.
#[test]
fn command_line_defaults_and_refusals() {
    let text = command("--load-kg 50 --amax-g 200 --freq-hz 100 --lambda 0.1 --motors 6 --json");
    let json: serde_json::Value = serde_json::from_str(&text.expect("a design")).expect("JSON");
    assert_eq!(json["gravity_mps2"].as_f64(), Some(STANDARD_GRAVITY_MPS2));
    let [motor, safe] = ["motor_torque_nm", "motor_torque_with_safety_nm"]
        .map(|name| json[name].as_f64().expect("a number"));
    assert_near("safety 2", safe, 2.0 * motor, 1e-12 * safe);

    let bad = command("--load-kg -3e-5 --amax-g nan --freq-hz 100 --lambda 0.1 --motors 1 --json");
    let message = bad.expect_err("three flags out of range").to_string();
    assert_eq!(message.lines().count(), 3, "{message}");
    for (line, flag) in message
        .lines()
        .zip(["--load-kg -3e-5:", "--amax-g NaN:", "--motors 1:"])
    {
        assert!(line.starts_with(flag), "{line}");
    }
    let refused = CommandLine::try_parse_from(["design", "--motors", "-2"]).err();
    let refused = refused.expect("not a count").to_string();
    assert!(
        refused.contains("--motors") && refused.contains("whole number"),
        "{refused}"
    );
}

/// If this fails, whoever reads the JSON of a crank-rocker finds a field missing, added, renamed or in another unit.
#[test]
fn a_crank_rocker_has_exactly_the_promised_fields() {
    const EXAMPLE: &str = "crank-rocker --swing-deg 60 --pressure-deg 20 --time-ratio 0.9";
    let text = command(&format!("{EXAMPLE} --screw-lead-mm 12 --json")).expect("a design");
    let json: serde_json::Value = serde_json::from_str(&text).expect("one JSON value");
    let numbers = [
        ("crank_ratio", 0.485_209_4, 1e-6),
        ("coupler_ratio", 1.540_214_8, 1e-6),
        ("ground_ratio", 1.927_919_0, 1e-6),
        ("theta_deg", 9.473_684, 1e-6),
        ("grashof_margin", 0.12709, 5e-6),
        ("swing_deg", 60.0, 1e-6),
        ("time_ratio", 0.9, 1e-9),
        ("pressure_max_deg", 52.7162, 5e-5),
        ("pressure_min_deg", -24.7746, 5e-5),
        ("pressure_mean_deg", 12.2529, 5e-5),
        ("rocker_speed_max", 0.53075, 1e-4),
        ("rocker_speed_min", -0.50649, 1e-4),
        ("rocker_acceleration_max", 0.69621, 1e-4),
        ("rocker_acceleration_min", -0.62101, 1e-4),
        ("stroke_mm", 2.0, 1e-9),
    ];
    for (name, value, tolerance) in numbers {
        assert_near(
            name,
            json[name].as_f64().expect("a number"),
            value,
            tolerance,
        );
    }
    for (k, value) in [29.171, 199.697].into_iter().enumerate() {
        let ours = json["dead_centre_deg"][k].as_f64().expect("a number");
        assert_near("dead_centre_deg", ours, value, 5e-4);
    }
    let object = json.as_object().expect("an object");
    assert_eq!(object.len(), numbers.len() + 1, "{text}");
    let without = command(&format!("{EXAMPLE} --json")).expect("a design");
    let without: serde_json::Value = serde_json::from_str(&without).expect("JSON");
    assert!(without["stroke_mm"].is_null(), "there is no screw");

    let page = command(EXAMPLE).expect("a design");
    let document = include_str!("../../../docs/design-command.md");
    assert!(
        document.contains(page.trim_end()),
        "docs/design-command.md lacks:\n{page}"
    );
    let refused = command("crank-rocker --swing-deg 60 --pressure-deg 30 --time-ratio 0.9");
    let message = refused
        .expect_err("the linkage would fold flat")
        .to_string();
    assert!(message.starts_with("--pressure-deg 30: "), "{message}");
}

/// If this fails, the page is not what the documentation shows, to the letter.
#[test]
fn documented_session_is_what_is_printed() {
    let page = command(FIRST).expect("a design");
    let document = include_str!("../../../docs/design-command.md");
    assert!(
        document.contains(page.trim_end()),
        "docs/design-command.md lacks:\n{page}"
    );
}

/// If this fails, the page runs off the terminal, or a step is missing or out of order.
#[test]
fn page_walks_the_steps_within_ninety_columns() {
    for gravity in ["10", "9.80665"] {
        for (load, amax, freq, lambda, motors) in EXAMPLES {
            let page = command(&format!(
                "--load-kg {load} --amax-g {amax} --freq-hz {freq} --lambda {lambda} \
                 --motors {motors} --gravity {gravity}"
            ))
            .expect("a design");
            let is_step =
                |line: &&str| line.get(1..3) == Some("  ") && !line.starts_with([' ', '!']);
            let steps: String = page
                .lines()
                .filter(is_step)
                .map(|line| &line[..1])
                .collect();
            assert_eq!(steps, "ABCDEFGHIJ", "{page}");
            for line in page.lines() {
                assert!(
                    line.chars().count() <= 90 && line.trim_end() == line,
                    "{line}"
                );
            }
        }
    }
}
