//! User-level tests of charts. The charts are small: they have everything that full charts have, with fewer points and shorter runs.

mod of_scene;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::process::Output;
use std::sync::{Arc, Mutex, PoisonError};

use assert_cmd::Command;
use cophase_lab::chart::CHARTS;

fn chart(arguments: &[&str]) -> Output {
    Command::cargo_bin("cophase")
        .expect("the command is built")
        .arg("chart")
        .args(arguments)
        .output()
        .expect("it runs")
}

/// The data of a chart, its concatenated pictures, and the message of the command.
struct Drawn {
    csv: String,
    svg: String,
    said: String,
}

fn draw(name: &str) -> Drawn {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap();
    let output = chart(&[name, "--size", "small", "--out", place]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    let read = |file: &str| std::fs::read_to_string(folder.path().join(file)).unwrap();
    let (_, written) = said.rsplit_once(": ").expect("the files are named");
    let files: Vec<_> = written
        .trim_end()
        .trim_end_matches('.')
        .split(", ")
        .collect();
    let in_folder = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(in_folder, files.len(), "{said}");
    let (data, pictures) = files.split_first().expect("the data");
    assert_eq!(*data, format!("{name}.csv"));
    Drawn {
        csv: read(data),
        svg: pictures.iter().map(|picture| read(picture)).collect(),
        said,
    }
}

/// Returns the chart, drawn once for all tests that only read it.
fn drawn(name: &'static str) -> Arc<Drawn> {
    static ALL: Mutex<BTreeMap<&str, Arc<Drawn>>> = Mutex::new(BTreeMap::new());
    let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    all.entry(name)
        .or_insert_with(|| Arc::new(draw(name)))
        .clone()
}

/// Returns the rows, each as a map from column to value.
fn rows(csv: &str) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column]
        .parse()
        .unwrap_or_else(|_| panic!("{column} in {row:?}"))
}

/// Returns the data without the one column that depends on a clock.
fn untimed(csv: &str) -> Vec<HashMap<String, String>> {
    let mut rows = rows(csv);
    for row in &mut rows {
        row.remove("timing");
    }
    rows
}

/// If this fails, a picture or a number depends on the machine that drew the chart. A chart in the docs can then not be distinguished from
/// another one of the same name.
fn is_the_same_each_time(name: &'static str) {
    let (one, other) = (drawn(name), draw(name));
    assert_eq!(one.svg, other.svg);
    assert_eq!(untimed(&one.csv), untimed(&other.csv));
    assert!(one.svg.starts_with("<svg"), "{}", &one.svg[..40]);
}

macro_rules! the_same_each_time {
    ($($test:ident: $name:literal),* $(,)?) => {
        $(#[test] fn $test() { is_the_same_each_time($name); })*
    };
}

the_same_each_time! {
    methods_are_the_same_each_time: "methods",
    stability_is_the_same_each_time: "stability",
    energy_is_the_same_each_time: "energy",
    functions_are_the_same_each_time: "functions",
    tick_rates_are_the_same_each_time: "tick-rate",
    model_levels_are_the_same_each_time: "fidelity",
    bad_places_are_the_same_each_time: "breakdown",
}

/// If this fails, the measured stability limit of a method or a trim gain contradicts its theory.
#[test]
fn measured_stability_limits_match_theory() {
    let mut compared = HashMap::<String, u32>::new();
    for row in rows(&drawn("stability").csv) {
        let edge = |column: &str| row[column].parse::<f64>();
        match (edge("edge_measured"), edge("edge_theory")) {
            (Ok(measured), Ok(theory)) => {
                assert!(
                    (measured - theory).abs() <= 0.01 * theory.max(1e-6),
                    "{measured}, not {theory}: {row:?}"
                );
                *compared.entry(row["of"].clone()).or_default() += 1;
            }
            // A column has no number if there is no edge, or if theory has no closed form.
            _ => {
                let theory = &row["edge_theory"];
                assert!(
                    theory.is_empty() || theory == &row["edge_measured"],
                    "{row:?}"
                );
            }
        }
    }
    for of in [
        "explicit Euler",
        "symplectic Euler",
        "velocity Verlet",
        "RK4",
        "trim of an axis",
    ] {
        assert!(compared.get(of) >= Some(&5), "{of} in {compared:?}");
    }
}

/// If this fails, the picture recommends a step with which the method diverges on a machine, or a step that is far too short. The region of
/// RK4 is bounded by |z| = 2.6 to 3.0 in the left half plane, and the chain's published limit is 81.5 µs at 34,190.8 rad/s.
#[test]
fn longest_stable_steps_of_the_machines_match_theory() {
    let drawn = drawn("stability");
    let rows = rows(&drawn.csv);
    let edge = |of: &str| {
        let row = rows.iter().find(|row| row["of"] == of);
        number(row.unwrap_or_else(|| panic!("no {of}")), "edge_measured")
    };
    for machine in [
        "jaw crusher",
        "screen's box",
        "five-bar arm",
        "elastic chain",
    ] {
        let found = edge(&format!("RK4 on {machine}"));
        assert!((2.6..3.0).contains(&found), "{machine}: {found}");
        assert!(
            drawn.svg.contains(&format!(">{machine}<"))
                || drawn
                    .svg
                    .contains(&format!(">{}<", machine.replace('\'', "&apos;"))),
            "{machine}"
        );
    }
    let chain = edge("RK4 on elastic chain") / (81.5e-6 * 34_190.8);
    assert!((chain - 1.0).abs() < 0.01, "{chain}");
    // The springs of the box have a damping ratio of 0.07. Explicit Euler is stable up to 2 ζ.
    let screen = edge("explicit Euler on screen's box");
    assert!((screen / 0.14 - 1.0).abs() < 0.01, "{screen}");
}

/// If this fails, a method is drawn below the uncertainty of its reference, or is chosen on the basis of too few steps.
#[test]
fn each_method_has_six_steps_above_the_reference_uncertainty() {
    let drawn = drawn("methods");
    let mut steps = HashMap::<(String, String), u32>::new();
    let mut defaults = HashMap::<String, String>::new();
    for row in rows(&drawn.csv) {
        *steps
            .entry((row["problem"].clone(), row["method"].clone()))
            .or_default() += 1;
        if row["default"] == "true" {
            defaults.insert(row["problem"].clone(), row["method"].clone());
        }
        assert!(number(&row, "timing") > 0.0);
    }
    assert!(steps.values().all(|&steps| steps >= 6), "{steps:?}");
    for (problem, method) in [
        ("one shaft, four steppers", "RK4"),
        ("platform on four cranks out of phase", "RK4"),
        ("elastic chain behind a cam, linear", "exact discretisation"),
    ] {
        assert_eq!(defaults.get(problem).map(String::as_str), Some(method));
        let methods = steps.keys().filter(|(of, _)| of == problem).count();
        assert!(methods >= 6, "{problem}: {methods} methods");
    }
    for problem in cophase_lab::chart::methods::problems::all().unwrap() {
        let (min, max) = problem.shown();
        assert!(min >= 10.0 * problem.uncertainty && max > 100.0 * min);
    }
    assert!(drawn.svg.contains("(default where thick)"));
}

/// If this fails, a machine gains or loses energy over hours although the chart states that the method keeps it.
#[test]
fn the_listed_methods_conserve_energy() {
    let drawn = drawn("energy");
    let finest = |method: &str| {
        let mut of_method = rows(&drawn.csv)
            .into_iter()
            .filter(|row| row["method"] == method);
        number(&of_method.next_back().unwrap(), "drift")
    };
    assert!(finest("implicit midpoint") < 1e-6);
    assert!(finest("explicit Euler") > 1e-2);
    assert!(
        drawn
            .said
            .contains("keeps its energy to 1e-6 over 300 turns with")
    );
    let (keep, lose) = drawn.said.split_once("; ").unwrap();
    assert!(keep.contains("implicit midpoint (from ") && lose.contains("explicit Euler"));
}

/// If this fails, the text omits a function that is better by the table beside it, or does not state that there is none.
#[test]
fn the_text_lists_every_better_function_of_the_table() {
    let drawn = drawn("functions");
    let rows = rows(&drawn.csv);
    for (function, called) in [
        ("root", "cophase `root`"),
        ("sine, cosine", "cophase `sine_cosine`"),
        ("arctangent", "micromath `atan2`"),
    ] {
        let ours = rows.iter().find(|row| row["candidate"] == called).unwrap();
        assert!(number(ours, "timing") > 0.0);
        let is_better = |row: &&HashMap<String, String>| {
            row["function"] == function
                && !row["candidate"].starts_with(called.split(' ').next().unwrap())
                && ["cycles_mean", "error_max"]
                    .iter()
                    .all(|column| number(row, column) < number(ours, column))
        };
        let better: Vec<_> = rows.iter().filter(is_better).collect();
        let name = called.replace('`', "");
        if better.is_empty() {
            assert!(drawn.said.contains(&format!(
                "Nothing of others is both faster and closer than {name}."
            )));
        }
        for row in better {
            let said = drawn
                .said
                .split(&format!("Both faster and closer than {name}:"))
                .nth(1);
            assert!(
                said.unwrap().contains(&row["candidate"].replace('`', "")),
                "{row:?}"
            );
        }
    }
    for by in ["cophase", "micromath", "libm", "idsp", "cordic", "table"] {
        assert!(
            drawn.svg.contains(&format!(">{by}")),
            "{by} is not in the legend"
        );
    }
}

/// If this fails, a faster tick costs processor time without benefit, or a slower tick degrades a ramp.
#[test]
fn a_faster_tick_reduces_only_the_ramp_error() {
    let rows = rows(&drawn("tick-rate").csv);
    for scene in ["default", "patent-3"] {
        let of_scene: Vec<_> = rows.iter().filter(|row| row["scene"] == scene).collect();
        let (slowest, fastest) = (of_scene[0], of_scene[of_scene.len() - 1]);
        let times = number(fastest, "tick_hz") / number(slowest, "tick_hz");
        assert!(times >= 10.0, "{times}");
        // A lag of one and a half ticks is shorter with a shorter tick.
        assert!(number(fastest, "ramp_error") < 0.5 * number(slowest, "ramp_error"));
        for row in of_scene {
            assert!(number(row, "hold_error") < 1e-6, "{row:?}");
            assert!(number(row, "cpu_worst") >= number(row, "cpu_mean"));
        }
    }
}

/// Returns the text of a picture about the share of the processor, with its lines joined.
fn processor_share(svg: &str) -> String {
    let texts = svg.split("<text").skip(1).filter_map(|text| {
        let (_, text) = text.split_once('>')?;
        text.split('<').next()
    });
    let page = texts.collect::<Vec<_>>().join(" ");
    let (_, share) = page.split_once("The default takes ").expect("a sentence");
    share.split_once('.').expect("its end").0.to_owned()
}

/// If this fails, the docs show the cost of an outdated firmware. Their picture must be that of the latest tick counts.
#[test]
fn the_documented_processor_share_matches_the_tick_counts() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/tick-rate.svg");
    let docs = std::fs::read_to_string(docs).unwrap();
    assert_eq!(
        processor_share(&docs),
        processor_share(&drawn("tick-rate").svg)
    );
}

/// Checks that the header of a chart's data lists the columns that the docs describe for the file `name`.
fn assert_documented(name: &str, csv: &str) {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/charts.md");
    let docs = std::fs::read_to_string(docs).unwrap();
    let head = format!("| column of `{name}.csv` | |");
    let (_, table) = docs
        .split_once(&head)
        .unwrap_or_else(|| panic!("no table for {name}"));
    let table = table.split("\n\n").next().unwrap();
    let cells = table.lines().filter_map(|line| line.split('|').nth(1));
    let documented: Vec<_> = cells
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .collect();
    let header: Vec<_> = csv.lines().next().unwrap().split(',').collect();
    assert_eq!(documented, header, "{name}");
}

/// If this fails, a column has no description in the docs, or the docs describe a column that no longer exists.
#[test]
fn columns_are_those_of_the_docs() {
    for chart in CHARTS {
        assert_documented(chart.name, &drawn(chart.name).csv);
    }
}

/// If this fails, the docs contradict the measurement of a method, or an error is measured with too few steps.
#[test]
fn the_documented_decisions_match_the_measurement() {
    let folder = tempfile::tempdir().unwrap();
    let output = chart(&["decisions", "--out", folder.path().to_str().unwrap()]);
    let said = String::from_utf8(output.stdout).unwrap();
    let docs = include_str!("../../../../docs/charts.md").replace('\n', " ");
    let said = said.lines().next().unwrap();
    assert!(docs.contains(said), "{said}");

    let csv = std::fs::read_to_string(folder.path().join("decisions.csv")).unwrap();
    let mut steps = std::collections::BTreeMap::<_, u32>::new();
    for record in csv::Reader::from_reader(csv.as_bytes()).records() {
        let record = record.unwrap();
        *steps
            .entry((record[0].to_owned(), record[1].to_owned()))
            .or_default() += 1;
    }
    assert_eq!(
        steps.len(),
        6 + 6 + 7,
        "scenes and the methods that suit them"
    );
    assert!(steps.values().all(|&count| count >= 6), "{steps:?}");
}

/// Returns what a chart compares for each rule with independent normal errors: the monitor's threshold, or that with the most false
/// alarms up to one a year. Each rule has the turns of all changes, then its loads.
fn rules_of_change_detection(csv: &str) -> BTreeMap<String, Vec<String>> {
    let mut best = BTreeMap::<_, ((bool, f64), Vec<String>)>::new();
    for row in rows(csv).iter().filter(|row| row["noise"] == "normal") {
        let rank = (row["present"] == "true", number(row, "false_alarms_a_year"));
        if !rank.0 && rank.1 > 1.0 {
            continue;
        }
        let cell = row[if row["change"] == "load" {
            "size"
        } else {
            "turns"
        }]
        .clone();
        let of_rule = best
            .entry(row["rule"].clone())
            .or_insert((rank, Vec::new()));
        if rank > of_rule.0 {
            *of_rule = (rank, Vec::new());
        }
        if rank == of_rule.0 {
            of_rule.1.push(cell);
        }
    }
    best.into_iter()
        .map(|(rule, (_, cells))| (rule, cells))
        .collect()
}

/// If this fails, the page on change detection states other figures than its data.
#[test]
fn the_documented_delays_are_those_of_the_data() {
    let docs = include_str!("../../../../docs/change-detection.md");
    let rules = rules_of_change_detection(include_str!("../../../../docs/change-detection.csv"));
    assert_eq!(rules.len(), 8);
    for (rule, cells) in rules {
        let row = format!("| {rule} | {} |", cells.join(" | "));
        assert!(docs.contains(&row), "{row}");
    }
}

/// If this fails, there is a rule that should replace the windows of the monitor: it reports a drift sooner, and tolerates as much load.
#[test]
fn a_rule_that_reports_a_drift_sooner_tolerates_less_load() {
    let rules = rules_of_change_detection(&drawn("change-detection").csv);
    // A drift of 0.001 r a turn, and a slow load.
    let figures = |rule: &str| {
        let cells = &rules[rule];
        let turns: f64 = cells[5].parse().unwrap();
        let load: f64 = cells[8].parse().unwrap();
        (turns, load)
    };
    let windows = figures("windows");
    assert!(windows.1 > 1.5, "{windows:?}");
    for rule in rules.keys().filter(|rule| *rule != "windows") {
        let other = figures(rule);
        assert!(
            other.0 > windows.0 || other.1 < windows.1,
            "{rule}: {other:?}, windows: {windows:?}"
        );
    }
}

#[test]
fn charts_are_listed_and_others_refused() {
    let list = String::from_utf8(chart(&["list"]).stdout).unwrap();
    for chart in CHARTS {
        assert!(
            list.lines().any(|line| line.starts_with(chart.name)),
            "{list}"
        );
    }
    let refused = chart(&["stabilty", "--out", "/nowhere"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.contains("did you mean `stability`?"), "{said}");
    assert!(refused.stdout.is_empty());
}
