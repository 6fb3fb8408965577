//! Reads the files of `cophase run --trace` with common readers, and checks the layouts for viewers.
//!
//! GTKWave's `fst2vcd` reads `steps.fst`, the Python package `mcap` reads `trace.mcap`. Where one of these is not installed, its
//! test prints this and passes. If `COPHASE_REQUIRE_READERS=1` is set, it fails.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use cophase_files::trace::WRITTEN_BY;

/// Runs a built-in scene, and returns the names of the files in its folder.
fn run(scene: &str, out: &Path, options: &[&str]) -> BTreeSet<String> {
    let status = Command::new(env!("CARGO_BIN_EXE_cophase"))
        .args(["run", scene, "--quiet", "--out"])
        .arg(out)
        .args(options)
        .status()
        .expect("the command starts");
    assert!(matches!(status.code(), Some(0 | 1)), "{status}");
    let entries = fs::read_dir(out).expect("a folder");
    let name = |entry: fs::DirEntry| entry.file_name().into_string().expect("UTF-8");
    entries
        .map(|entry| name(entry.expect("an entry")))
        .collect()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn missing(reader: &str) {
    let required = std::env::var("COPHASE_REQUIRE_READERS").is_ok_and(|value| value == "1");
    assert!(
        !required,
        "{reader} is not installed, and COPHASE_REQUIRE_READERS=1"
    );
    // Writes to standard error directly, because the test harness hides what a passing test prints.
    let _ = writeln!(std::io::stderr(), "NOT TESTED: {reader} is not installed");
}

/// If this fails, a run writes a file that was not requested, or omits one that was.
#[test]
fn the_requested_files_are_written_and_no_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let always = ["report.json", "scope.svg", "torque.svg"];
    for (list, files) in [
        ("csv", vec!["trace.csv"]),
        ("fst", vec!["steps.fst", "steps.gtkw"]),
        ("mcap,mcap", vec!["trace.mcap"]),
        ("vcd,fst", vec!["steps.vcd", "steps.fst", "steps.gtkw"]),
    ] {
        let found = run("patent-4", &folder.path().join(list), &["--trace", list]);
        let expected = files.into_iter().chain(always).map(str::to_owned);
        assert_eq!(found, expected.collect(), "--trace {list}");
    }
}

/// If this fails, an option without effect is ignored silently.
#[test]
fn options_without_effect_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for (options, words) in [
        (
            ["--trace", "csv", "--window", "0..1"],
            "--window: --trace csv writes no edges",
        ),
        (
            ["--trace", "csv,mcap", "--window", "all"],
            "add vcd or fst to --trace",
        ),
        (
            ["--trace", "vcd,fst", "--every", "5"],
            "--every: --trace vcd,fst writes no rows",
        ),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_cophase"))
            .args(["run", "patent-4", "--out", "out"])
            .args(options)
            .current_dir(&folder)
            .output()
            .expect("the command starts");
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        let message = String::from_utf8(output.stderr).expect("UTF-8");
        assert!(message.contains(words), "no `{words}` in: {message}");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0);
    }
}

/// If this fails, a misspelt format is ignored silently, or the message does not list the right names.
#[test]
fn a_format_that_does_not_exist_is_refused_with_the_list() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new(env!("CARGO_BIN_EXE_cophase"))
        .args(["run", "--trace", "csv,fsdb", "--out", "out"])
        .current_dir(&folder)
        .output()
        .expect("the command starts");
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    for part in ["--trace fsdb", "csv, vcd, fst, mcap"] {
        assert!(message.contains(part), "no `{part}` in: {message}");
    }
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0);
}

/// Returns the changes of a value change dump by signal: the time in ns and the value as written. Checks the line of the time
/// unit.
///
/// Signals that do not change at the start of the window have their initial value there.
fn changes(vcd: &str) -> BTreeMap<String, Vec<(u64, String)>> {
    let mut words = vcd.split_whitespace().peekable();
    let mut names = BTreeMap::new();
    let mut changes: BTreeMap<String, Vec<(u64, String)>> = BTreeMap::new();
    let mut now = 0;
    while let Some(word) = words.next() {
        match word {
            "$var" => {
                let declared: Vec<&str> =
                    words.by_ref().take_while(|word| *word != "$end").collect();
                let [_, _, code, name] = declared[..] else {
                    panic!("a variable of four words: {declared:?}")
                };
                names.insert(code.to_owned(), name.to_owned());
            }
            "$dumpvars" | "$end" => {}
            _ if word.starts_with('$') => {
                let text: Vec<&str> = words.by_ref().take_while(|word| *word != "$end").collect();
                assert!(
                    word != "$timescale" || text.concat() == "1ns",
                    "times are nanoseconds: {text:?}"
                );
            }
            _ if word.starts_with('#') => now = word[1..].parse().expect("a time"),
            _ => {
                let (value, code) = match word.strip_prefix('r') {
                    Some(number) => (number, words.next().expect("a code")),
                    None => word.split_at(1),
                };
                let name = names[code].clone();
                changes
                    .entry(name)
                    .or_default()
                    .push((now, value.to_owned()));
            }
        }
    }
    changes
}

/// Returns `steps.fst` of a run, read by `fst2vcd`, or `None` if that is not installed.
fn fst_changes(out: &Path) -> Option<BTreeMap<String, Vec<(u64, String)>>> {
    let Ok(output) = Command::new("fst2vcd").arg(out.join("steps.fst")).output() else {
        missing("fst2vcd");
        return None;
    };
    assert!(output.status.success(), "{output:?}");
    Some(changes(&String::from_utf8(output.stdout).expect("UTF-8")))
}

/// If this fails, GTKWave shows different edges in the two formats.
#[test]
fn fst_has_the_edges_of_vcd() {
    let folder = tempfile::tempdir().expect("a folder");
    // The windows are from power-up, from the middle, and longer than one block of changes.
    for (window, many_blocks) in [("0..0.3", false), ("10.5..10.6", false), ("all", true)] {
        let out = folder.path().join(window);
        let options = ["--trace", "vcd,fst", "--window", window];
        run("lost-steps", &out, &options);
        let Some(fst) = fst_changes(&out) else { return };
        let header = fs::read(out.join("steps.fst")).expect("a file");
        let blocks = u64::from_be_bytes(header[65..73].try_into().expect("eight bytes"));
        assert_eq!(blocks > 1, many_blocks, "{window}: {blocks} blocks");
        let vcd = changes(&fs::read_to_string(out.join("steps.vcd")).expect("a file"));
        assert!(vcd["step_0"].len() > 100, "{window}: something moves");
        for (name, expected) in &vcd {
            // Before the window the value of a wire is unknown.
            let known: Vec<_> = fst[name].iter().filter(|(_, value)| value != "x").collect();
            assert_eq!(
                known,
                expected.iter().collect::<Vec<_>>(),
                "{window}: {name}"
            );
        }
    }
}

/// If this fails, a curve in GTKWave shows other numbers, or other times, than a plot of the table.
#[test]
fn fst_has_the_numbers_of_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let options = [
        "--trace",
        "csv,fst",
        "--every",
        "1",
        "--window",
        "10.4..10.7",
    ];
    run("lost-steps", folder.path(), &options);
    let Some(fst) = fst_changes(folder.path()) else {
        return;
    };
    let mut rows = csv::Reader::from_path(folder.path().join("trace.csv")).expect("a trace");
    let names = rows.headers().expect("a header").clone();
    let rows: Vec<_> = rows.records().map(|row| row.expect("a row")).collect();
    let time_ns = |row: &csv::StringRecord| {
        let t_s: f64 = row[0].parse().expect("a time");
        (t_s * 1e9).round() as u64
    };
    for (column, name) in names
        .iter()
        .enumerate()
        .filter(|(_, name)| *name != "state" && !WRITTEN_BY.contains(name))
    {
        let mut held = f64::NAN;
        let mut changes = fst[name].iter().peekable();
        let mut compared = 0;
        for row in &rows {
            let now = time_ns(row);
            while let Some((_, value)) = changes.next_if(|(at, _)| *at <= now) {
                held = value.parse().expect("a number");
            }
            if (10_400_500_000..=10_700_000_000).contains(&now) {
                let expected: f64 = row[column].parse().expect("a number");
                // fst2vcd prints 16 digits.
                assert!(
                    (held - expected).abs() <= expected.abs() * 1e-15,
                    "{name} at {now} ns: {held}, not {expected}"
                );
                compared += 1;
            }
        }
        assert_eq!(compared, 600, "{name}: ticks of 0.5 ms");
    }
}

/// Reads an MCAP file. Prints topic, time and each value with all its bits, then the count of messages in its index.
const PYTHON: &str = r#"
import json, struct, sys
from mcap.reader import make_reader
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        assert schema.encoding == "jsonschema" and channel.message_encoding == "json"
        properties = json.loads(schema.data)["properties"]
        data = json.loads(message.data)
        assert list(properties) and set(properties) == set(data)
        assert message.log_time == message.publish_time
        for name, value in data.items():
            known = {"string": str, "integer": int, "number": (int, float)}
            assert isinstance(value, known[properties[name]["type"]]), (name, value)
            value = value if isinstance(value, str) else struct.pack(">d", value).hex()
            print(channel.topic, message.log_time, name, value)
    print("messages", reader.get_summary().statistics.message_count)
"#;

/// If this fails, a plot in Foxglove or PlotJuggler shows other numbers than the table.
#[test]
fn python_reads_the_rows_of_csv_from_mcap() {
    let python = root().join("target/readers/bin/python");
    if !python.exists() {
        missing("the Python package mcap (tests/readers/install)");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let options = ["--trace", "csv,mcap", "--every", "7"];
    run("lost-steps", folder.path(), &options);
    let output = Command::new(python)
        .args(["-c", PYTHON])
        .arg(folder.path().join("trace.mcap"))
        .output()
        .expect("Python runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut found: BTreeMap<(u64, String), String> = BTreeMap::new();
    let (mut messages, mut values) = (None, 0);
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        if let ["messages", count] = words[..] {
            messages = Some(count.parse::<usize>().expect("a count"));
            continue;
        }
        let [topic, time_ns, name, value] = words[..] else {
            panic!("four words: {line}")
        };
        let column = match topic.strip_prefix("/axis/") {
            Some(axis) => format!("{name}_{axis}"),
            None => name.to_owned(),
        };
        found.insert((time_ns.parse().expect("a time"), column), value.to_owned());
        values += 1;
    }
    assert_eq!(found.len(), values, "each value once");
    let mut rows = csv::Reader::from_path(folder.path().join("trace.csv")).expect("a trace");
    let names = rows.headers().expect("a header").clone();
    let axes = names
        .iter()
        .filter(|name| name.starts_with("steps_"))
        .count();
    let mut count = 0;
    for row in rows.records() {
        let row = row.expect("a row");
        let t_s: f64 = row[0].parse().expect("a time");
        let time_ns = (t_s * 1e9).round() as u64;
        let fields = names.iter().zip(&row);
        for (name, field) in fields.filter(|(name, _)| !WRITTEN_BY.contains(name)) {
            let expected = match field.parse::<f64>() {
                Ok(number) => format!("{:016x}", number.to_bits()),
                Err(_) => field.to_owned(),
            };
            let value = found.remove(&(time_ns, name.to_owned()));
            assert_eq!(value, Some(expected), "{name} at {time_ns} ns");
        }
        count += 1;
    }
    assert!(count > 1000 && found.is_empty(), "{count} rows; {found:?}");
    assert_eq!(
        messages,
        Some(count * (axes + 2)),
        "a message a topic and row"
    );
}

/// Returns the names in a layout: the values of `name` of curves, or the lines of signals.
fn names_in(layout: &str) -> Vec<String> {
    let curve = |line: &str| {
        let (_, rest) = line.split_once("<curve name=\"")?;
        Some(rest.split_once('"')?.0.to_owned())
    };
    let signal = |line: &str| line.strip_prefix("cophase.").map(str::to_owned);
    let names: Vec<_> = layout
        .lines()
        .filter_map(|line| curve(line).or_else(|| signal(line)))
        .collect();
    assert!(names.len() > 10, "{names:?}");
    names
}

/// If this fails, a supplied layout opens empty.
#[test]
fn layouts_name_only_signals_of_the_default_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    run(
        "default",
        folder.path(),
        &["--trace", "csv,fst", "--every", "1000"],
    );
    let rows = csv::Reader::from_path(folder.path().join("trace.csv"));
    let columns = rows.expect("a trace").headers().expect("a header").clone();
    let has = |column: &str| columns.iter().any(|name| name == column);
    let layouts = root().join("docs/layouts");
    let of_manual = |name| fs::read_to_string(layouts.join(name)).expect("a layout");
    let table = names_in(&of_manual("plotjuggler.xml"));
    let live = names_in(&of_manual("plotjuggler-udp.xml"));
    for name in &table {
        assert!(has(name), "trace.csv has no {name}");
    }
    let slashed: Vec<_> = table.iter().map(|name| format!("/{name}")).collect();
    assert_eq!(
        live, slashed,
        "PlotJuggler's JSON parser begins names with a slash"
    );
    let layout = fs::read_to_string(folder.path().join("steps.gtkw")).expect("a layout");
    if let Some(fst) = fst_changes(folder.path()) {
        for name in names_in(&layout) {
            assert!(fst.contains_key(&name), "steps.fst has no {name}");
        }
    }
}

/// If this fails, axes beyond the fourth are not shown, or the layout names axes that the run does not have.
#[test]
fn the_layout_has_the_axes_of_the_run() {
    for (scene, axes) in [("patent-2", 2), ("patent-1", 6)] {
        let folder = tempfile::tempdir().expect("a folder");
        run(scene, folder.path(), &["--trace", "fst"]);
        let layout = fs::read_to_string(folder.path().join("steps.gtkw")).expect("a layout");
        for wire in ["step", "dir", "index", "phase_error_deg"] {
            let shown = (0..8).filter(|axis| layout.contains(&format!("cophase.{wire}_{axis}\n")));
            assert_eq!(shown.count(), axes, "{scene}: {wire}");
        }
    }
}
