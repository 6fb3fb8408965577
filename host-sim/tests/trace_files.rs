//! The files that a run writes, read back by readers other than their writers.
//!
//! The pages drawn here stay in `tmp/` of the target folder for inspection.

use std::f64::consts::TAU;
use std::fs;
use std::io::Write;
use std::path::Path;

use host_sim::trace::{
    AxisRow, Levels, Moved, Row, RunFiles, ScopeData, ScopeFrame, Signal, StepsVcd, TraceCsv,
    TraceError,
};

const GRAVITY_MPS2: f64 = 9.81;
/// The crank for which R ω² is 100 g at 31 Hz.
const RADIUS_M: f64 = 100.0 * GRAVITY_MPS2 / (31.0 * 31.0 * TAU * TAU);
const TICK_S: f64 = 0.0005;

/// Returns the requested level at a time, g: 0, 20, 60, 40, 100, 0, with smooth ramps of 3 s.
fn program_g(t_s: f64) -> f64 {
    const LEVELS: [(f64, f64); 5] = [
        (2.0, 20.0),
        (14.0, 60.0),
        (26.0, 40.0),
        (36.0, 100.0),
        (52.0, 0.0),
    ];
    let mut level = 0.0;
    for (from_s, to_g) in LEVELS {
        let x = ((t_s - from_s) / 3.0).clamp(0.0, 1.0);
        level += (to_g - level) * x * x * (3.0 - 2.0 * x);
    }
    level
}

/// A minute of mixing on three axes. With `slips`, axis 2 loses four full steps (7.2°) at each of those times, and the machine stops
/// after the third.
fn mixing(slips: &[f64], mut each: impl FnMut(&Row)) {
    let mut phase_turns = 0.0;
    let mut amax_commanded_mps2 = 0.0_f64;
    let fault_s = slips.get(2).map_or(f64::INFINITY, |t| t + 0.05);
    for tick in 0..120_000_u32 {
        let t_s = f64::from(tick) * TICK_S;
        let requested = program_g(t_s) * GRAVITY_MPS2;
        let target = if t_s > fault_s { 0.0 } else { requested };
        // The commanded amplitude follows with a limited rate.
        amax_commanded_mps2 += (target - amax_commanded_mps2).clamp(-0.22, 0.22);
        let omega_rad_s = (amax_commanded_mps2 / RADIUS_M).sqrt();
        phase_turns += omega_rad_s / TAU * TICK_S;
        let state = match t_s {
            t if t < 1.0 => "idle",
            t if t < 2.0 => "homing",
            t if t > fault_s && omega_rad_s > 1.0 => "stop",
            t if t > fault_s => "fault",
            t if t < 52.0 => "run",
            _ if omega_rad_s > 1.0 => "stop",
            _ => "parked",
        };
        let speed = omega_rad_s / 190.0;
        let axes: Vec<AxisRow> = (0..3_u32)
            .map(|i| {
                let slipped = slips.iter().filter(|&&at| i == 2 && t_s > at).count();
                // A lag that grows with speed and that trim corrects at intervals: a sawtooth.
                let saw = (t_s / (1.3 + 0.4 * f64::from(i))).fract() * 0.12 * speed;
                let phase_error_deg = saw + f64::from(i) * 0.02 * speed - 7.2 * slipped as f64;
                AxisRow {
                    steps: (phase_turns * 1600.0) as i64,
                    command_turns: phase_turns,
                    actual_turns: phase_turns + phase_error_deg / 360.0,
                    phase_error_deg,
                    is_overdue: false,
                }
            })
            .collect();
        let (sin, cos) = (phase_turns * TAU).sin_cos();
        let spread = (axes[2].phase_error_deg - axes[0].phase_error_deg) / 360.0 * TAU;
        let states = ["idle", "homing", "run", "stop", "parked", "fault"];
        let state_code = states.iter().position(|name| *name == state).unwrap() as u8;
        each(&Row {
            t_s,
            state,
            state_code,
            amax_requested_mps2: requested,
            amax_commanded_mps2,
            omega_rad_s,
            phase_turns,
            tilt_x_mrad: 8.0 * spread * sin,
            tilt_y_mrad: 5.0 * spread * cos + 0.01 * sin,
            warp_deg: 0.0,
            z_m: RADIUS_M * cos,
            accel_mps2: -amax_commanded_mps2 * cos,
            axes,
        });
    }
}

fn frame(title: &str, subtitle: &str) -> ScopeFrame {
    ScopeFrame {
        title: title.into(),
        subtitle: subtitle.into(),
        bands_hz: vec![(24.0, 28.0)],
        gravity_mps2: GRAVITY_MPS2,
        tilt_limit_mrad: Some(2.0),
        phase_error_limit_deg: Some(5.4),
        moved: Moved::Platform,
    }
}

fn axes(count: usize) -> Vec<AxisRow> {
    vec![AxisRow::default(); count]
}

/// Stores a page for inspection, and checks that it is an SVG page.
fn keep(name: &str, svg: &str) {
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join(name), svg).unwrap();
    assert!(svg.starts_with("<svg"), "{name}");
    assert!(svg.trim_end().ends_with("</svg>"), "{name}");
    for bad in ["NaN", "inf\"", "inf "] {
        assert!(!svg.contains(bad), "{name} has a coordinate `{bad}`");
    }
}

#[test]
fn a_mixing_run_gives_a_page() {
    let subtitle = "200 kg, 20-60-40-100 g; quasi-static; done";
    let mut scope = ScopeData::new(3, frame("Mixing, three axes", subtitle));
    mixing(&[], |row| scope.push(row));
    for t_s in [16.0, 27.0, 36.5, 53.0] {
        scope.mark(t_s, "band crossed");
    }
    let svg = scope.render();
    keep("scope-mixing.svg", &svg);
    for text in [
        "Mixing, three axes",
        subtitle,
        "amax, g",
        "speed, Hz",
        "phase error, deg",
        "tilt, mrad",
        "time since power-up, s",
        "band crossed",
        "parked",
    ] {
        assert!(svg.contains(text), "no `{text}` on the page");
    }
    let bytes = svg.len();
    assert!(bytes < 700_000, "{bytes} bytes do not open at ease");
}

#[test]
fn a_fault_is_shown_on_the_page() {
    let subtitle = "axis 2 loses 7.2° three times; fault at 41.65 s";
    let mut scope = ScopeData::new(3, frame("Lost steps", subtitle));
    let slips = [38.0, 40.2, 41.6];
    mixing(&slips, |row| scope.push(row));
    for t_s in slips {
        scope.mark(t_s, "axis 2: steps lost");
    }
    scope.mark(41.65, "fault: lost steps, axis 2");
    let svg = scope.render();
    keep("scope-fault.svg", &svg);
    for text in ["fault: lost steps, axis 2", "limit ±5.4", "peak 21.6"] {
        assert!(svg.contains(text), "no `{text}` on the page");
    }
}

/// If this fails, the axis that is drawn last hides those with the same phase error, and a correction appears to have no effect.
#[test]
fn axes_that_coincide_are_visible_and_a_correction_is_explained() {
    let page = |is_corrected: bool, apart_deg: f64| {
        let mut scope = ScopeData::new(4, frame("coincide", ""));
        for tick in 0..5000_u32 {
            let t_s = f64::from(tick) * TICK_S;
            let mut axes = axes(4);
            for (i, axis) in axes.iter_mut().enumerate() {
                let is_apart = i == 2 && t_s > 1.0;
                axis.phase_error_deg = (4.0 * t_s).sin() + if is_apart { apart_deg } else { 0.0 };
            }
            scope.push(&Row {
                t_s,
                state: "run",
                axes,
                ..Row::default()
            });
        }
        if is_corrected {
            scope.corrected();
        }
        scope.render()
    };
    let svg = page(true, 3.0);
    keep("scope-coincide.svg", &svg);
    for entry in [
        "axis 0, peak 1.0",
        "axis 1, as axis 0<",
        "axis 2, peak 4.0",
        "axis 3, as axis 0<",
    ] {
        assert!(svg.contains(entry), "{entry}");
    }
    // The widest line is at the back, and the others are within it.
    let first = |width: &str| svg.find(&format!("stroke-width=\"{width}\""));
    let [five, three] = [first("5.5").unwrap(), first("3.5").unwrap()];
    assert!(five < three, "{five}, {three}");
    // Axes that are less than a pixel apart coincide.
    assert!(page(true, 0.1).contains("axis 2, peak"));
    assert!(page(true, 0.01).contains("axis 2, as axis 0"));

    let note = "the phase error stays";
    assert!(svg.contains(note));
    assert!(!page(false, 3.0).contains(note));
}

#[test]
fn the_same_run_gives_the_same_page() {
    let page = || {
        let mut scope = ScopeData::new(6, frame("same", "bytes"));
        for tick in 0..5000_u32 {
            scope.push(&Row {
                t_s: f64::from(tick) * TICK_S,
                state: "run",
                axes: axes(6),
                ..Row::default()
            });
        }
        scope.render()
    };
    // The page is drawn twice in one process. Global counters of a library would make a difference.
    assert_eq!(page(), page());
    keep("scope-six.svg", &page());
}

/// If this fails, the page shows the commanded amplitude as the actual one, or twice the amplitude of a level that is over.
#[test]
fn three_amplitudes_are_drawn_by_their_names() {
    let page = |moved: Moved| {
        let frame = ScopeFrame {
            moved,
            ..frame("amplitudes", "")
        };
        let mut scope = ScopeData::new(1, frame);
        for tick in 0..8000_u32 {
            let t_s = f64::from(tick) * TICK_S;
            let phase_turns = 10.0 * t_s;
            // The last tick but one is a spike in an incomplete turn.
            let spike = if tick == 7998 { 90.0 } else { 1.0 };
            scope.push(&Row {
                t_s,
                state: "run",
                amax_requested_mps2: 36.0 * GRAVITY_MPS2,
                amax_commanded_mps2: 35.0 * GRAVITY_MPS2,
                accel_mps2: -32.25 * spike * GRAVITY_MPS2 * (phase_turns * TAU).cos(),
                omega_rad_s: 10.0 * TAU,
                phase_turns,
                axes: axes(1),
                ..Row::default()
            });
        }
        scope.render()
    };
    let platform = page(Moved::Platform);
    keep("scope-amplitudes.svg", &platform);
    for entry in [
        "requested, peak 36.0",
        "commanded, peak 35.0",
        "actual, peak 32.2",
    ] {
        assert!(platform.contains(entry), "{entry}");
    }
    assert!(
        !page(Moved::Pushers).contains("actual"),
        "pushers have a panel of their own"
    );
    assert!(
        page(Moved::Machine).contains("moved, mm"),
        "a machine of its own kind has no tilt"
    );
}

#[test]
fn runs_with_hardly_any_data_give_pages() {
    keep(
        "scope-none.svg",
        &ScopeData::new(2, ScopeFrame::default()).render(),
    );

    let mut one = ScopeData::new(2, frame("One row", "at rest"));
    one.push(&Row {
        state: "idle",
        axes: axes(2),
        ..Row::default()
    });
    keep("scope-one.svg", &one.render());

    let mut wild = ScopeData::new(
        2,
        ScopeFrame {
            title: "<&\u{1}>".into(),
            bands_hz: vec![(f64::NAN, 3.0), (5.0, 4.0), (0.1, 1e9)],
            gravity_mps2: f64::NAN,
            tilt_limit_mrad: Some(f64::NAN),
            phase_error_limit_deg: Some(f64::INFINITY),
            ..ScopeFrame::default()
        },
    );
    for t_s in [0.0, 0.1, f64::NAN, 0.1, 0.3] {
        wild.push(&Row {
            t_s,
            state: "run",
            amax_requested_mps2: f64::NAN,
            amax_commanded_mps2: f64::INFINITY,
            omega_rad_s: if t_s == 0.1 { f64::NAN } else { 1.0 },
            ..Row::default()
        });
    }
    wild.mark(f64::NAN, "never");
    wild.mark(1e300, "late");
    keep("scope-wild.svg", &wild.render());
}

#[test]
fn the_csv_header_has_the_specified_columns() {
    let text = TraceCsv::new(Vec::new(), 2).unwrap().finish().unwrap();
    assert_eq!(
        String::from_utf8(text).unwrap(),
        "t_s,state,state_code,amax_requested_mps2,amax_commanded_mps2,omega_rad_s,phase_turns,\
         steps_0,command_turns_0,actual_turns_0,phase_error_deg_0,\
         steps_1,command_turns_1,actual_turns_1,phase_error_deg_1,\
         tilt_x_mrad,tilt_y_mrad,warp_deg,z_m,accel_mps2\n"
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
