//! `cophase design`: its page, its JSON object and its refusals.

use std::f64::consts::TAU;

use clap::Parser;
use cophase_scene::units::STANDARD_GRAVITY_MPS2;

use cophase::design::{DesignArgs, DesignCommandError, run};

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

/// Parses the arguments as the command does, and runs it.
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

/// If this fails, a field of the JSON object is missing, added, renamed or in another unit.
#[test]
fn json_has_exactly_the_promised_fields() {
    let text = command(&format!("{FIRST} --json")).expect("a design");
    let json: serde_json::Value = serde_json::from_str(&text).expect("one JSON value");
    let object = json.as_object().expect("an object");
    // These are figures of items 1, 3, 4 and 9. A motor has a sixth of the torque, and safety doubles it.
    let numbers = [
        ("crank_radius_mm", 4.6055, 5e-5),
        ("electrical_cycle_deg", 7.2, 1e-12),
        ("gravity_mps2", 10.0, 0.0),
        ("motor_torque_nm", 38.121, 2e-3),
        ("motor_torque_with_safety_nm", 76.242, 4e-3),
        ("peak_power_w", 141_700.0, 50.0),
        ("rod_length_mm", 46.055, 5e-4),
        ("speed_rad_s", TAU * 100.0, 1e-9),
        ("step_rate_max_hz", 320_000.0, 1e-6),
        ("torque_max_exact_nm", 228.81, 0.05),
        ("torque_max_two_term_nm", 228.725, 0.01),
        ("torque_required_nm", 76.242, 4e-3),
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

/// If this fails, figures of the motor are those of the crank, or its scene has other motors than the design.
#[test]
fn figures_behind_a_gear_are_the_motors_own() {
    let flags = "--load-kg 10 --amax-g 10 --freq-hz 5 --lambda 0.3 --motors 3 --gear 57:11 --steps-per-turn 25600 --rotor-inertia-kgm2 2e-3";
    let json = |flags: &str| -> serde_json::Value {
        let text = command(&format!("{flags} --json")).expect("a design");
        serde_json::from_str(&text).expect("JSON")
    };
    let json = json(flags);
    let of = |name: &str| json[name].as_f64().expect("a number");
    let ratio = 57.0 / 11.0;
    assert_near("cycle", of("electrical_cycle_deg"), 7.2 / ratio, 1e-12);
    assert_near("rate", of("step_rate_max_hz"), 5.0 * ratio * 25_600.0, 1e-6);
    let at_crank = of("motor_torque_with_safety_nm");
    assert_near("torque", of("torque_required_nm"), at_crank / ratio, 1e-12);
    // A crank at a right angle to its rod moves the load at about its radius.
    let radius_m = of("crank_radius_mm") / 1e3;
    let about = 10.0 / 3.0 * radius_m * radius_m / (ratio * ratio) / 2e-3;
    let found = of("inertia_ratio");
    assert!(
        (about..1.2 * about).contains(&found),
        "{found}, about {about}"
    );
    let scene = command(&format!("{flags} --scene")).expect("a scene");
    for line in [
        "gear = [57, 11]",
        "steps_per_turn = 25600",
        "rotor_inertia_kgm2 = 0.002",
    ] {
        assert!(scene.contains(line), "{line}: {scene}");
    }
    let refused = command(&flags.replace("57:11", "0:11")).expect_err("no gear");
    assert!(refused.to_string().contains("--gear 0"), "{refused}");
}

/// If this fails, defaults are not the documented ones, or negative numbers and bad counts are reported incorrectly.
#[test]
fn defaults_are_as_documented_and_bad_values_are_refused() {
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

/// A field of a JSON object, its value and a tolerance.
type Field = (&'static str, f64, f64);

/// Returns the JSON object of a machine. It must have these numbers and the given count of other fields.
fn machine(arguments: &str, numbers: &[Field], others: usize) -> serde_json::Value {
    let text = command(&format!("{arguments} --json")).expect("a design");
    let json: serde_json::Value = serde_json::from_str(&text).expect("one JSON value");
    for &(name, value, tolerance) in numbers {
        let ours = json[name].as_f64().expect("a number");
        assert_near(name, ours, value, tolerance);
    }
    let object = json.as_object().expect("an object");
    assert_eq!(object.len(), numbers.len() + others, "{text}");
    let page = command(arguments).expect("a design");
    let document = include_str!("../../../docs/design-command.md");
    assert!(
        document.contains(page.trim_end()),
        "docs/design-command.md lacks:\n{page}"
    );
    json
}

/// If one of these fails, a field of a machine's JSON object is missing, added, renamed or in another unit, or the page differs from
/// the documentation.
#[test]
fn a_crank_rocker_has_exactly_the_promised_fields() {
    let arguments =
        "crank-rocker --swing-deg 60 --pressure-deg 20 --time-ratio 0.9 --screw-lead-mm 12";
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
    let json = machine(arguments, &numbers, 1);
    for (k, value) in [29.171, 199.697].into_iter().enumerate() {
        let ours = json["dead_centre_deg"][k].as_f64().expect("a number");
        assert_near("dead_centre_deg", ours, value, 5e-4);
    }
    let (without, _) = arguments.split_once(" --screw").expect("a screw");
    let without = command(&format!("{without} --json")).expect("a design");
    let without: serde_json::Value = serde_json::from_str(&without).expect("JSON");
    assert!(without["stroke_mm"].is_null(), "there is no screw");
    let refused = command("crank-rocker --swing-deg 60 --pressure-deg 30 --time-ratio 0.9");
    let message = refused
        .expect_err("the linkage would fold flat")
        .to_string();
    assert!(message.starts_with("--pressure-deg 30: "), "{message}");
}

/// If this fails, the drawing is not to scale, lacks a dead centre, or is left half-written after a write error.
#[test]
fn a_crank_rocker_is_drawn_at_both_dead_centres() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("linkage.svg");
    let arguments = "crank-rocker --swing-deg 60 --pressure-deg 20 --time-ratio 0.9 --svg";
    command(&format!("{arguments} {}", file.display())).expect("a drawing");
    let svg = std::fs::read_to_string(&file).expect("it is written");
    for label in [
        "A",
        "B1",
        "C1",
        "B2",
        "C2",
        "D",
        "ground 1.9279",
        "folded: crank at 199.70°",
    ] {
        assert!(svg.contains(&format!(">{label}</text>")), "no {label}");
    }
    // The circles are crank pivot, rocker pivot and the joints. Ground and rocker have the ratio of their lengths.
    let circle = |n: usize| {
        let text = svg.split("<circle cx=\"").nth(n + 1).expect("a joint");
        let mut parts = text.split('"');
        let x: f64 = parts.next().and_then(|x| x.parse().ok()).expect("x");
        let y: f64 = parts.nth(1).and_then(|y| y.parse().ok()).expect("y");
        [x, y]
    };
    let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let (ends, pivots) = ([circle(1), circle(3)], [circle(4), circle(5)]);
    for end in ends {
        let ratio = apart(pivots[0], pivots[1]) / apart(end, pivots[1]);
        assert_near("ground over rocker", ratio, 1.9279, 1e-3);
    }
    let inside = file.join("no-folder.svg");
    let refused = command(&format!("{arguments} {}", inside.display()));
    let message = refused.expect_err("a file is no folder").to_string();
    assert!(message.starts_with("--svg "), "{message}");
    assert_eq!(
        std::fs::read_dir(folder.path())
            .expect("it is there")
            .count(),
        1
    );
}

#[test]
fn a_screen_has_exactly_the_promised_fields() {
    let arguments = "screen --exciter-kg 166 --vibrating-kg 2900 --eccentricity-mm 87.27 --speed-rpm 840 --deck-deg 24";
    let numbers = [
        ("speed_rad_s", 87.9646, 5e-5),
        ("throw_index", 3.944, 4e-3),
        ("stiffness_kgf_per_cm", 1310.4, 1.3),
        ("natural_speed_rpm", 195.5, 0.2),
        ("speed_ratio", 4.297, 4e-3),
        ("amplitude_mm", 4.996, 6e-4),
        ("wheel_wobble_mm", 0.004, 6e-4),
        ("static_deflection_mm", 23.4, 0.05),
    ];
    machine(arguments, &numbers, 0);
    let message =
        command("screen --exciter-kg 166 --vibrating-kg 2900 --eccentricity-mm 0 --speed-rpm 840");
    let message = message.expect_err("no exciter").to_string();
    assert!(message.starts_with("--eccentricity-mm 0: "), "{message}");
}

#[test]
fn a_five_bar_has_exactly_the_promised_fields() {
    let arguments = "five-bar --l1-m 0.25 --l4-m 0.25 --x-m 0 --y-m 0.3";
    let json = machine(arguments, &[], 1);
    let solutions = json["solutions"].as_array().expect("a list");
    let published = [[143.130, 36.870, -0.06], [36.870, 143.130, 0.06]];
    assert_eq!(solutions.len(), published.len());
    for (solution, published) in solutions.iter().zip(published) {
        assert_eq!(solution.as_object().expect("an object").len(), 3);
        for (name, value) in ["q1_deg", "q2_deg", "det_j_m2"].into_iter().zip(published) {
            let ours = solution[name].as_f64().expect("a number");
            assert_near(name, ours, value, 5e-4);
        }
    }
    let message = command("five-bar --l1-m 0.25 --l4-m 0.25 --x-m 0.4 --y-m 0.4");
    let message = message.expect_err("out of reach").to_string();
    assert!(message.starts_with("--x-m 0.4, --y-m 0.4: "), "{message}");
}

#[test]
fn a_flywheel_has_exactly_the_promised_fields() {
    let arguments = "flywheel --power-kw 15 --rated-rpm 970 --synchronous-rpm 1000 --overload 2 --belt-ratio 3.7 --mass-kg 281 \
                     --diameter-m 0.762 --fastest-rad-s 28.303 --slowest-rad-s 26.118";
    let numbers = [
        ("synchronous_rad_s", 28.3026, 5e-5),
        ("rated_rad_s", 27.4536, 5e-5),
        ("rated_torque_nm", 147.68, 5e-3),
        ("breakdown_torque_nm", 295.36, 5e-3),
        ("breakdown_motor_rad_s", 92.995, 5e-4),
        ("rim_inertia_kgm2", 40.790, 5e-4),
        ("disc_inertia_kgm2", 20.40, 5e-3),
        ("shaft_torque_rated_nm", 546.4, 0.06),
        ("shaft_torque_fastest_nm", 0.0, 0.5),
        ("shaft_torque_slowest_nm", 1030.0, 0.5),
        ("irregularity", 0.0803, 5e-5),
        ("energy_swing_j", 2425.2, 0.1),
    ];
    let json = machine(arguments, &numbers, 1);
    assert_eq!(json["torque_curve"].as_array().map(Vec::len), Some(3));
    assert!(json.get("under_rock").is_none());
    let rock = format!("{arguments} --rock-kn 1310 --rock second-half --irregularity 0.05 --json");
    let json: serde_json::Value = serde_json::from_str(&command(&rock).expect("it turns")).unwrap();
    let under_rock = json["under_rock"].as_object().unwrap();
    let fields = [
        "fastest_rad_s",
        "slowest_rad_s",
        "mean_rad_s",
        "irregularity",
        "nodes",
        "nodes_fastest_rad_s",
        "nodes_slowest_rad_s",
        "nodes_mean_rad_s",
        "required_inertia_kgm2",
    ];
    assert!(fields.iter().all(|field| under_rock[*field].is_number()));
    assert_eq!(under_rock.len(), fields.len());
    let message = command(&arguments.replace("970", "1000"));
    let message = message.expect_err("no slip").to_string();
    assert!(message.starts_with("--rated-rpm 1000: "), "{message}");
}

/// If this fails, the speeds under rock in the documentation differ from the printed ones.
#[test]
fn documented_speeds_under_rock_are_what_is_printed() {
    let page = command(
        "flywheel --power-kw 15 --rated-rpm 970 --synchronous-rpm 1000 --overload 2 --belt-ratio 3.7 --mass-kg 281 --diameter-m 0.762 \
         --rock-kn 1310 --rock second-half --irregularity 0.05",
    )
    .expect("a design");
    let under_rock = &page[page.find("Under ").expect("speeds under rock")..];
    let document = include_str!("../../../docs/design-command.md");
    assert!(document.contains(under_rock.trim_end()), "{under_rock}");
}

/// If this fails, the page differs from the documentation in at least one character.
#[test]
fn documented_session_is_what_is_printed() {
    let page = command(FIRST).expect("a design");
    let document = include_str!("../../../docs/design-command.md");
    assert!(
        document.contains(page.trim_end()),
        "docs/design-command.md lacks:\n{page}"
    );
}

/// If this fails, the page is wider than the terminal, or a step is missing or out of order.
#[test]
fn the_page_lists_all_steps_within_ninety_columns() {
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
