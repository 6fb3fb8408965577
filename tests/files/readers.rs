//! Independent readers get the run's own values from its files.
//!
//! `steps.vcd` goes through sigrok's stepper motor decoder, `trace.csv` through Python's `csv` module. If
//! one of these is not installed, its test says so and passes. With `COPHASE_REQUIRE_READERS=1` the test
//! fails, so that a skipped test is not taken for a passed one.

use std::io::Write;
use std::process::{Command, Stdio};

use cophase_files::trace::{Every, Window};
use cophase_tests::{Run, bench_scene, record};

/// Under two seconds of motion. Axis 1 is reversed, and axis 2 has its own gear and steps. Axis 0 is
/// trimmed against its sense, so that its direction line changes.
fn short_run() -> Run {
    let short = bench_scene()
        .with(
            r#"
machine = { allow_commanded_tilt = true, crank_radius_mm = 20, lambda = 0.3 }
control = { settle_s = 0.05 }
limits = { speed_hz = 8, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 2000, homing_speed_hz = 5 }
drift = { tilt_limit_mrad = 20 }
axes = { steps_per_turn = 400, trim_rate_deg_per_s = 40 }
axis = [
  { number = 0, trim_deg = -4.5 },
  { number = 1, reversed = true },
  { number = 2, steps_per_turn = 1000, gear = [2, 3], index = false },
]
"#,
        )
        .program([(5.0, 0.5, 0.3), (1.0, 0.3, 0.1)]);
    record(&short.checked(), Every::Ticks(1), Window::All)
}

/// Reports a missing reader. Panics if readers are required.
fn missing(reader: &str) {
    let required = std::env::var("COPHASE_REQUIRE_READERS").is_ok_and(|value| value == "1");
    assert!(
        !required,
        "{reader} is not installed, and COPHASE_REQUIRE_READERS=1"
    );
    // The test harness hides the output of a passing test. This line bypasses it.
    let _ = writeln!(std::io::stderr(), "NOT TESTED: {reader} is not installed");
}

fn is_installed(reader: &str) -> bool {
    let version = Command::new(reader)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let found = version.is_ok_and(|status| status.success());
    if !found {
        missing(reader);
    }
    found
}

/// A line of sigrok's decoder: from one rising edge to the next, ns since power-up, and the position.
fn decoded(line: &str) -> (u64, u64, i64) {
    let (samples, words) = line.split_once(' ').expect("samples, then words");
    let (from, to) = samples.split_once('-').expect("first-last");
    let position = words
        .strip_prefix("stepper_motor-1: ")
        .and_then(|words| words.strip_suffix(" steps"))
        .expect("a position");
    // A sample is 8 ns: a cycle of the step clock, on which all edges lie.
    let ns = |sample: &str| sample.parse::<u64>().expect("a sample's number") * 8;
    (ns(from), ns(to), position.parse().expect("whole steps"))
}

/// If this fails, a logic analyser's software shows another motion than the trace.
///
/// The decoder starts from 0 and counts each rising edge by DIR's level at that edge. When it detects the
/// next step, it prints the position between the two steps.
#[test]
fn sigrok_decodes_the_positions_of_the_trace() {
    if !is_installed("sigrok-cli") {
        return;
    }
    let run = short_run();
    let (trace, edges) = (run.trace(), run.edges());
    for (name, wire) in &edges.wires {
        let off = wire.changes.iter().find(|(at, _)| at % 8 != 0);
        assert_eq!(off, None, "{name} changes between cycles of the step clock");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("steps.vcd");
    std::fs::write(&file, &run.vcd).expect("a file");
    for axis in 0..3 {
        let output = Command::new("sigrok-cli")
            .args(["-I", "vcd:downsample=8:skip=-8", "-i"])
            .arg(&file)
            .args([
                "-P",
                &format!("stepper_motor:step=step_{axis}:dir=dir_{axis}"),
            ])
            .args([
                "-A",
                "stepper_motor=position",
                "--protocol-decoder-samplenum",
            ])
            .output()
            .expect("sigrok-cli runs");
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let lines: Vec<_> = text.lines().map(decoded).collect();
        let rises: Vec<u64> = edges.wire(&format!("step_{axis}")).rises().collect();
        assert_eq!(lines.len() + 1, rises.len(), "N steps give N - 1 lines");
        assert!(lines.len() > 1000, "axis {axis} moves");

        let steps = trace.axis("steps", axis);
        // DIR high counts up in the decoder. At the pin of a reversed axis that is backwards.
        let sense = if axis == 1 { -1 } else { 1 };
        let (mut compared, mut back, mut last) = (0, 0, 0);
        for (i, &(from_ns, to_ns, position)) in lines.iter().enumerate() {
            assert_eq!(
                (from_ns, to_ns),
                (rises[i], rises[i + 1]),
                "axis {axis}, line {i}"
            );
            back += u32::from(sense * (position - last) < 0);
            last = position;
            // If a tick ends between the two steps, the trace has a row to compare with.
            let row = trace.row_at(from_ns as f64 * 1e-9);
            let t_ns = (trace.column("t_s")[row] * 1e9).round() as u64;
            if (from_ns..to_ns).contains(&t_ns) {
                assert_eq!(
                    position,
                    sense * steps[row] as i64,
                    "axis {axis} at {t_ns} ns"
                );
                compared += 1;
            }
        }
        assert!(compared > 500, "axis {axis}: {compared} rows compared");
        assert_eq!(back > 0, axis == 0, "axis 0 is trimmed back, and no other");
    }
}

/// Reads a trace from its standard input and prints each field. It prints a number by all its bits.
const PYTHON: &str = r"
import csv, struct, sys
rows = csv.reader(sys.stdin)
header = next(rows)
print(' '.join(header))
for row in rows:
    assert len(row) == len(header)
    for name, field in zip(header, row):
        print(field if name in ('state', 'version', 'commit') else struct.pack('>d', float(field)).hex())
";

/// If this fails, a spreadsheet or a notebook gets other numbers than the trace's.
#[test]
fn python_reads_the_numbers_that_rust_reads() {
    if !is_installed("python3") {
        return;
    }
    let run = short_run();
    let mut python = Command::new("python3")
        .args(["-c", PYTHON])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 runs");
    let mut stdin = python.stdin.take().expect("a pipe");
    let csv = run.csv.clone();
    let feeding = std::thread::spawn(move || stdin.write_all(&csv));
    let output = python.wait_with_output().expect("python3 ends");
    feeding.join().expect("no panic").expect("all is read");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(' ').collect();
    let trace = run.trace();
    for row in 0..trace.rows() {
        for name in &names {
            let actual = lines.next().expect("a field");
            if *name == "state" {
                assert_eq!(actual, trace.states[row]);
            } else if !["version", "commit"].contains(name) {
                let bits = trace.column(name)[row].to_bits();
                assert_eq!(actual, format!("{bits:016x}"), "{name} in row {row}");
            }
        }
    }
    assert_eq!(lines.next(), None, "as many rows");
}
