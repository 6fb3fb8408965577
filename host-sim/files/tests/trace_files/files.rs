//! `trace.csv`, `steps.vcd`, and the folder of a run.

use std::fs;
use std::io::Write;

use cophase_files::trace::{Levels, Row, RunFiles, Signal, StepsVcd, TraceCsv, TraceError};

use super::{axes, mixing};

#[test]
fn the_csv_header_has_the_specified_columns() {
    let text = TraceCsv::new(Vec::new(), 2).unwrap().finish().unwrap();
    assert_eq!(
        String::from_utf8(text).unwrap(),
        "t_s,state,state_code,amax_requested_mps2,amax_commanded_mps2,omega_rad_s,phase_turns,\
         steps_0,command_turns_0,actual_turns_0,phase_error_deg_0,\
         steps_1,command_turns_1,actual_turns_1,phase_error_deg_1,\
         tilt_x_mrad,tilt_y_mrad,warp_deg,z_m,accel_mps2,amax_actual_mps2,version,commit\n"
    );
}

#[test]
fn a_trace_reads_back_to_the_stated_resolution() {
    let mut rows = Vec::new();
    let mut tick = 0;
    mixing(&[38.0, 40.2, 41.6], |row| {
        if tick % 97 == 0 {
            rows.push(row.clone());
        }
        tick += 1;
    });
    let mut trace = TraceCsv::new(Vec::new(), 3).unwrap();
    for row in &rows {
        trace.write(row).unwrap();
    }
    let text = trace.finish().unwrap();
    let mut reader = csv::Reader::from_reader(&text[..]);
    let names = reader.headers().unwrap().clone();
    let mut read = 0;
    for (line, row) in reader.records().zip(&rows) {
        let line = line.unwrap();
        let field = |name: &str| &line[names.iter().position(|n| n == name).unwrap()];
        // The tolerance is half of the last place, plus a little for the rounding of turns counted in thousands.
        let near = |name: &str, value: f64, resolution: f64| {
            let back: f64 = field(name).parse().unwrap();
            let off = (back - value).abs();
            assert!(off <= 0.51 * resolution, "{name} {value} became {back}");
        };
        assert_eq!(field("state"), row.state);
        assert_eq!(field("state_code"), row.state_code.to_string());
        near("t_s", row.t_s, 1e-9);
        near("amax_requested_mps2", row.amax_requested_mps2, 1e-4);
        near("amax_commanded_mps2", row.amax_commanded_mps2, 1e-4);
        near("omega_rad_s", row.omega_rad_s, 1e-6);
        near("phase_turns", row.phase_turns, 1e-9);
        for (i, axis) in row.axes.iter().enumerate() {
            let steps: i64 = field(&format!("steps_{i}")).parse().unwrap();
            assert_eq!(steps, axis.steps);
            near(&format!("command_turns_{i}"), axis.command_turns, 1e-9);
            near(&format!("actual_turns_{i}"), axis.actual_turns, 1e-9);
            near(&format!("phase_error_deg_{i}"), axis.phase_error_deg, 1e-5);
        }
        near("tilt_x_mrad", row.tilt_x_mrad, 1e-5);
        near("tilt_y_mrad", row.tilt_y_mrad, 1e-5);
        near("warp_deg", row.warp_deg, 1e-5);
        near("z_m", row.z_m, 1e-9);
        near("accel_mps2", row.accel_mps2, 1e-4);
        read += 1;
    }
    assert_eq!(read, rows.len());
    // The second row's time, 97 ticks of 0.5 ms, is written exactly so.
    assert!(String::from_utf8(text).unwrap().contains("\n0.0485,idle,"));
}

/// If this fails, a reader that looks at the first rows takes a column of numbers for whole numbers, and fails or rounds later.
#[test]
fn all_numbers_of_the_first_row_have_a_decimal_point() {
    let mut trace = TraceCsv::new(Vec::new(), 2).unwrap();
    trace.write(&Row::of_axes(2)).unwrap();
    let text = String::from_utf8(trace.finish().unwrap()).unwrap();
    let (names, row) = text.trim_end().split_once('\n').unwrap();
    let whole = [
        "state",
        "state_code",
        "steps_0",
        "steps_1",
        "version",
        "commit",
    ];
    for (name, field) in names.split(',').zip(row.split(',')) {
        assert_eq!(
            field.contains('.') && name != "version",
            !whole.contains(&name),
            "{name}: {field}"
        );
    }
    // Outside the command, no commit is known.
    assert!(
        row.ends_with(concat!(",", env!("CARGO_PKG_VERSION"), ",unknown")),
        "{row}"
    );
}

#[test]
fn a_row_with_other_axes_than_the_header_is_refused_whole() {
    let mut trace = TraceCsv::new(Vec::new(), 2).unwrap();
    let row = Row {
        axes: axes(3),
        ..Row::default()
    };
    assert!(matches!(
        trace.write(&row),
        Err(TraceError::Axes {
            expected: 2,
            actual: 3
        })
    ));
    let text = trace.finish().unwrap();
    assert_eq!(text.iter().filter(|&&byte| byte == b'\n').count(), 1);
}

/// All timestamps, and all changes by wire name in the order of the file, the dumped levels among them.
fn read_vcd(bytes: &[u8]) -> (Vec<u64>, Vec<(u64, String, bool)>) {
    let mut parser = vcd::Parser::new(bytes);
    let header = parser.parse_header().unwrap();
    assert_eq!(header.timescale, Some((1, vcd::TimescaleUnit::NS)));
    assert_eq!(header.date, None);
    let module = header.find_scope(&["cophase"]).unwrap();
    let name_of = |id| {
        module.items.iter().find_map(|item| match item {
            vcd::ScopeItem::Var(var) if var.code == id => Some(var.reference.clone()),
            _ => None,
        })
    };
    let (mut times, mut changes) = (Vec::new(), Vec::new());
    for command in parser {
        match command.unwrap() {
            vcd::Command::Timestamp(t) => times.push(t),
            vcd::Command::ChangeScalar(id, value) => {
                let now = *times.last().unwrap();
                changes.push((now, name_of(id).unwrap(), value == vcd::Value::V1));
            }
            _ => {}
        }
    }
    (times, changes)
}

#[test]
fn edges_read_back_as_they_were_written() {
    const START_NS: u64 = 1_000_000_000;
    let initial = Levels {
        dir: vec![false, true],
        enable: true,
        ..Levels::default()
    };
    let mut steps = StepsVcd::new(Vec::new(), 2, START_NS, &initial).unwrap();
    let mut expected: Vec<(u64, String, bool)> = [
        ("step_0", false),
        ("step_1", false),
        ("dir_0", false),
        ("dir_1", true),
        ("index_0", false),
        ("index_1", false),
        ("enable", true),
        ("sync", false),
    ]
    .map(|(name, level)| (START_NS, name.to_owned(), level))
    .into();
    let mut change = |t, signal, name: &str, level| {
        steps.change(t, signal, level).unwrap();
        expected.push((t, name.to_owned(), level));
    };
    for k in 0..100_u64 {
        let t = START_NS + 20_000 * k;
        change(t, Signal::Step(0), "step_0", true);
        change(t, Signal::Step(1), "step_1", true);
        change(t + 7, Signal::Sync, "sync", k % 2 == 0);
        change(t + 10_000, Signal::Step(0), "step_0", false);
        change(t + 10_001, Signal::Step(1), "step_1", false);
    }
    change(START_NS + 2_000_000, Signal::Index(1), "index_1", true);
    change(START_NS + 2_000_000, Signal::Dir(1), "dir_1", false);
    change(START_NS + 2_000_000, Signal::Enable, "enable", false);
    let bytes = steps.finish(START_NS + 3_000_000).unwrap();
    let (times, changes) = read_vcd(&bytes);
    assert_eq!(changes, expected);
    assert_eq!(times.first(), Some(&START_NS));
    assert_eq!(times.last(), Some(&(START_NS + 3_000_000)));
    assert!(times.is_sorted_by(|a, b| a < b), "each time stands once");
}

#[test]
fn a_run_that_fails_midway_leaves_nothing() {
    let scratch = tempfile::tempdir().unwrap();
    let dir = scratch.path().join("results/first");
    let run = || -> Result<(), Box<dyn std::error::Error>> {
        let mut files = RunFiles::create(&dir)?;
        let mut trace = TraceCsv::new(files.file("trace.csv")?, 1)?;
        files.file("report.json")?.write_all(b"{")?;
        trace.write(&Row {
            axes: axes(1),
            ..Row::default()
        })?;
        trace.write(&Row::default())?;
        files.commit()?;
        Ok(())
    };
    assert!(run().is_err());
    assert_eq!(fs::read_dir(scratch.path()).unwrap().count(), 0);
}

#[test]
fn a_committed_run_has_its_files_and_no_others() {
    let scratch = tempfile::tempdir().unwrap();
    let dir = scratch.path().join("out");
    let mut files = RunFiles::create(&dir).unwrap();
    let trace = TraceCsv::new(files.file("trace.csv").unwrap(), 1).unwrap();
    trace.finish().unwrap().flush().unwrap();
    let file = files.file("steps.vcd").unwrap();
    let steps = StepsVcd::new(file, 1, 0, &Levels::default()).unwrap();
    steps.finish(1).unwrap();
    let written = files.commit().unwrap();
    assert_eq!(written, [dir.join("trace.csv"), dir.join("steps.vcd")]);
    let entries = fs::read_dir(&dir).unwrap();
    let mut found: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    found.sort();
    assert_eq!(found, [dir.join("steps.vcd"), dir.join("trace.csv")]);
    let text = fs::read_to_string(dir.join("trace.csv")).unwrap();
    assert!(text.starts_with("t_s,state,"));
}
