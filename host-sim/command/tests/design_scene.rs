//! `cophase design … --scene` and `--svg`: a design gives a scene that runs and meets the design's figures.

use std::path::Path;
use std::process::Output;

use serde_json::Value;

/// Load kg, amax g, frequency Hz, λ, motors: the source's four examples, then two, three and five motors.
const DESIGNS: [(f64, f64, f64, f64, u32); 7] = [
    (50.0, 200.0, 100.0, 0.1, 6),
    (50.0, 200.0, 200.0, 0.1, 2),
    (10.0, 100.0, 20.0, 0.6, 4),
    (10.0, 10.0, 5.0, 0.3, 3),
    (2.0, 12.0, 8.0, 0.25, 2),
    (5.0, 40.0, 15.0, 0.3, 3),
    (30.0, 15.0, 3.0, 0.2, 5),
];

fn cophase(dir: &Path, arguments: &str) -> Output {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
    let words = arguments.split_whitespace();
    command.current_dir(dir).args(words).output().unwrap()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn flags((load_kg, amax_g, freq_hz, lambda, motors): (f64, f64, f64, f64, u32)) -> String {
    format!(
        "design --load-kg {load_kg} --amax-g {amax_g} --freq-hz {freq_hz} --lambda {lambda} --motors {motors}"
    )
}

/// Runs a scene, which must end without a fault or a warning, and returns its report.
fn run(dir: &Path, scene: &str) -> Value {
    std::fs::write(dir.join("my.toml"), scene).unwrap();
    let output = cophase(dir, "run my.toml --out out");
    let text = printed(&output);
    assert!(!text.contains("Warning"), "{scene}\n{text}");
    serde_json::from_slice(&std::fs::read(dir.join("out/report.json")).unwrap()).unwrap()
}

fn number(report: &Value, key: &str) -> f64 {
    report[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} in {report}"))
}

#[track_caller]
fn assert_within_percent(what: &str, ours: f64, theirs: f64) {
    let off = ours / theirs - 1.0;
    assert!(off.abs() < 0.01, "{what}: {ours}, designed for {theirs}");
}

/// If this fails, a design does not run as it was designed: it faults, does not hold amax, turns at another speed, or lacks torque.
#[test]
fn a_design_runs_and_holds_its_amplitude() {
    for design in DESIGNS {
        let (load_kg, amax_g, freq_hz, _, motors) = design;
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path();
        let scene = printed(&cophase(dir, &format!("{} --scene", flags(design))));
        let report = run(dir, &scene);
        let amax_mps2 = amax_g * 9.80665;
        assert_within_percent("amax", number(&report, "amax_top_mps2"), amax_mps2);
        assert_within_percent("speed", number(&report, "speed_top_hz"), freq_hz);
        let holding = &report["holding"];
        assert!(number(holding, "worst_relative_error") < 1e-6, "{holding}");
        assert_eq!(
            report["axes"].as_array().map(Vec::len),
            Some(motors as usize)
        );
        assert_eq!(report["scene"]["machine"]["load_kg"], load_kg);
        assert!(dir.join("out/torque.svg").exists());
        // The design's torque has a safety factor of 2. A motor is loaded to half of it where the two-term formula is right.
        let json = printed(&cophase(dir, &format!("{} --json", flags(design))));
        let json: Value = serde_json::from_str(&json).unwrap();
        let torque_nm = number(&json, "motor_torque_with_safety_nm");
        let axis = &report["axes"][0];
        if scene.contains("\"pulse-servo\"") {
            assert_within_percent("platform", number(&report, "accel_worst_mps2"), amax_mps2);
            let limit_nm = number(&report["scene"]["axes"]["servo"], "limit_nm");
            assert_within_percent("limit", limit_nm, torque_nm);
            assert!(number(axis, "torque_worst_nm") < 0.7 * limit_nm, "{axis}");
        } else {
            let curve = &report["scene"]["axes"]["pull_out"];
            assert_within_percent("pull-out", curve[1][1].as_f64().unwrap(), torque_nm);
            let used = number(axis, "pull_out_used");
            assert!((0.45..0.6).contains(&used), "{axis}");
        }
    }
}

/// If this fails, the sources of the other designs and their scenes disagree, or their scenes do not run.
#[test]
fn a_crank_rocker_and_a_screen_run() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let design = "design crank-rocker --swing-deg 60 --pressure-deg 20 --time-ratio 0.9";
    let scene = printed(&cophase(
        dir,
        &format!("{design} --screw-lead-mm 30 --scene"),
    ));
    let report = run(dir, &scene);
    assert_within_percent("speed", number(&report, "speed_top_hz"), 6.0);
    // The stroke is 5 mm: 30 mm times the swing over a turn.
    let trace = std::fs::read_to_string(dir.join("out/trace.csv")).unwrap();
    let mut lines = trace.lines();
    let column = lines
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "z_m");
    let heights = lines.map(|line| line.split(',').nth(column.unwrap()).unwrap());
    let heights = heights.map(|z_m| z_m.parse::<f64>().unwrap());
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
        (low.min(z), high.max(z))
    });
    assert_within_percent("stroke", high - low, 5e-3);
    let output = cophase(dir, &format!("{design} --scene"));
    assert_refused(&output, "give --screw-lead-mm");

    let design = "design screen --exciter-kg 166 --vibrating-kg 2900 --eccentricity-mm 87.27 --speed-rpm 840";
    let scene = printed(&cophase(dir, &format!("{design} --scene")));
    let report = run(dir, &scene);
    assert_within_percent("speed", number(&report, "speed_top_hz"), 14.0);
    let json = printed(&cophase(dir, &format!("{design} --json")));
    let json: Value = serde_json::from_str(&json).unwrap();
    let natural_hz = number(&json, "natural_speed_rpm") / 60.0;
    let figures = &report["machine_figures"];
    let [from_hz, to_hz] =
        ["from", "to"].map(|end| number(figures, &format!("resonance_{end}_hz")));
    assert!(from_hz < natural_hz && natural_hz < to_hz, "{figures}");
}

#[track_caller]
fn assert_refused(output: &Output, what: &str) {
    let words = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{words}");
    assert!(output.stdout.is_empty());
    assert!(words.contains(what), "{words}");
}

/// If this fails, a scene is written for a design that cannot run, or two outputs are mixed on standard output.
#[test]
fn designs_that_cannot_run_and_two_outputs_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let small = flags((5.0, 10.0, 200.0, 0.1, 2));
    for option in ["--scene", "--svg x.svg"] {
        let output = cophase(dir, &format!("{small} {option}"));
        assert_refused(&output, "machine.crank_radius_mm: 0.056456 mm is outside");
    }
    let output = cophase(dir, &format!("{} --scene --json", flags(DESIGNS[3])));
    assert_refused(&output, "--json, --scene: both print to standard output");
    let five_bar = "design five-bar --l1-m 0.25 --l4-m 0.25 --x-m 0 --y-m 0.3 --scene";
    assert_refused(&cophase(dir, five_bar), "cophase scenes five-bar");
    assert!(!dir.join("x.svg").exists());
}

/// If this fails, the picture of a design differs from that of a run of its scene, or it replaces the page.
#[test]
fn a_design_and_its_run_draw_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let flags = flags(DESIGNS[3]);
    let page = printed(&cophase(dir, &flags));
    assert_eq!(
        printed(&cophase(dir, &format!("{flags} --svg a.svg"))),
        page
    );
    let scene = printed(&cophase(dir, &format!("{flags} --scene --svg b.svg")));
    run(dir, &scene);
    let read = |name: &str| std::fs::read_to_string(dir.join(name)).unwrap();
    assert_eq!(read("a.svg"), read("out/torque.svg"));
    assert_eq!(read("b.svg"), read("out/torque.svg"));
    assert!(read("a.svg").contains(">available</text>"));
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/design-torque.svg");
    let committed = std::fs::read_to_string(docs).unwrap();
    assert!(read("a.svg") == committed, "docs/design-torque.svg");
}
