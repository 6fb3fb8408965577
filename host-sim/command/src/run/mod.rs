//! `cophase run`: runs a scene, writes its files, and prints a page of text.

mod live;
mod progress;
mod values;

use std::io::Write;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Instant;

use live::Live;
use progress::progress_bar;
pub(crate) use values::window;
use values::{formats, receiver, speed};

use super::{CommandError, Status, expected, scenes};
use cophase_files::report::draw_operating_range;
use cophase_files::report::{self, Report};
use cophase_files::trace::TraceInfo;
use cophase_files::trace::{
    Every, Format, Recorder, RunFiles, ScopeData, ScopeFrame, SentRows, Window, gtkwave_layout,
};
use cophase_lab::numbers::whole;
use cophase_scene::SceneError;
use cophase_scene::library;
use host_sim::checked::Checked;
use host_sim::fidelity::{self, Answers};
use host_sim::operating_range::OperatingRange;
use host_sim::sim::{self, Outcome, expected_ticks, simulate};

/// Default files of a trace.
const TRACE: [Format; 2] = [Format::Csv, Format::Vcd];

#[derive(Debug, clap::Args)]
pub(super) struct RunArgs {
    /// A scene file, or the name of a built-in scene
    #[arg(value_name = "SCENE", default_value = library::FIRST)]
    scene: String,
    /// Folder for report.json, scope.svg, torque.svg and the files of the trace
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// The files of the trace, separated by commas: csv (trace.csv), vcd (steps.vcd), fst (steps.fst, with
    /// steps.gtkw, its layout for GTKWave), mcap (trace.mcap)
    #[arg(long, value_name = "LIST", default_values = TRACE.map(Format::name), value_delimiter = ',', value_parser = formats())]
    trace: Vec<Format>,
    /// Write a row every N control ticks [default: chosen to give at most 20,000 rows]
    #[arg(long, value_name = "N", value_parser = whole::<u64>(1..=u64::MAX), allow_negative_numbers = true)]
    every: Option<u64>,
    /// Time that steps.vcd and steps.fst show, in seconds, or `all`; --trace must have one of them [default: the scene's window; else 200 ms around the first injected
    /// fault, around the first slip or latched fault, or from the start of motion]
    #[arg(long, value_name = "FROM..TO", value_parser = window, allow_hyphen_values = true)]
    window: Option<Window>,
    /// Send each row as a JSON datagram to a live plot, such as PlotJuggler's at 127.0.0.1:9870; lost rows are counted
    #[arg(long, value_name = "HOST:PORT", value_parser = receiver)]
    udp: Option<SocketAddr>,
    /// Run in step with the clock, FACTOR times as fast, so that a live plot moves [default without =FACTOR: 1]
    #[arg(long, value_name = "FACTOR", value_parser = speed, num_args = 0..=1, require_equals = true, default_missing_value = "1")]
    real_time: Option<f64>,
    /// Accepted for scripts of earlier versions: every run and every board processes all index pulses of a tick in that tick
    #[arg(long, hide = true)]
    detect_at_once: bool,
    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

impl RunArgs {
    /// Creates the arguments of a run with a scene file and an output folder.
    pub(super) fn new(scene: &Path, out: &Path, quiet: bool) -> Self {
        Self {
            scene: scene.display().to_string(),
            out: out.to_path_buf(),
            trace: TRACE.into(),
            every: None,
            window: None,
            udp: None,
            real_time: None,
            detect_at_once: false,
            quiet,
        }
    }

    /// Refuses options that would have no effect.
    fn check(&self) -> Result<(), String> {
        let list = self.files().map(Format::name).collect::<Vec<_>>().join(",");
        let edges = Format::ALL.into_iter().filter(|format| format.has_edges());
        let edges = edges.map(Format::name).collect::<Vec<_>>().join(" or ");
        if self.window.is_some() && !self.files().any(Format::has_edges) {
            return Err(format!(
                "--window: --trace {list} writes no edges, and only edges have a window; add {edges} to --trace, or leave \
                 --window out"
            ));
        }
        if self.every.is_some() && self.udp.is_none() && self.files().all(Format::has_edges) {
            return Err(format!(
                "--every: --trace {list} writes no rows; add csv or mcap to --trace, or leave --every out"
            ));
        }
        Ok(())
    }

    /// Returns the formats of the trace, each once.
    fn files(&self) -> impl Iterator<Item = Format> {
        let all = Format::ALL.into_iter();
        all.filter(|format| self.trace.contains(format))
    }

    /// Returns the name of the layout of steps.fst, if that is one of the files.
    fn layout(&self) -> Option<&'static str> {
        self.trace.contains(&Format::Fst).then_some(LAYOUT)
    }
}

/// Runs a scene. Prints the results to `out`, and the expected duration to `err` if it is long.
pub(super) fn run(
    args: &RunArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, CommandError> {
    let began = Instant::now();
    args.check().map_err(CommandError::Input)?;
    let checked = scenes::read(&args.scene).map_err(CommandError::Input)?;
    let refused = |error: SceneError| CommandError::Input(error.in_file(&args.scene).to_string());
    sim::check_times(&checked).map_err(refused)?;
    if !args.quiet {
        expected::before_choice(&checked, err).map_err(refused)?;
    }
    let checked = fidelity::check(checked).map_err(refused)?;
    // A run in step with the wall clock takes the time that was requested.
    if !args.quiet && args.real_time.is_none() {
        expected::before_run(&checked, err).map_err(refused)?;
    }
    check_window(args, &checked).map_err(CommandError::Input)?;
    let mut live = Live::new(args, &checked).map_err(CommandError::Input)?;
    let range = OperatingRange::for_scene(&checked).map_err(refused)?;
    let range = range.map(|range| draw_operating_range(&range));
    let (checked, outcome, written, removed) =
        record(args, checked, began, &mut live, range.as_deref()).map_err(CommandError::Input)?;
    if !args.quiet {
        let wall_s = began.elapsed().as_secs_f64();
        out.write_all(report::summary(&checked, &outcome, Some(written), wall_s).as_bytes())?;
        let files: Vec<String> = args
            .files()
            .map(|format| described(format, written))
            .collect();
        writeln!(
            out,
            "Written to {}: report.json, {}, {PAGE}{}{}.",
            args.out.display(),
            files.join(", "),
            args.layout()
                .map_or_else(String::new, |name| format!(", {name}")),
            range.map_or_else(String::new, |_| format!(", {RANGE}")),
        )?;
        out.write_all(removed_line(&removed).as_bytes())?;
        if let Some((receiver, SentRows { rows, lost })) = live.finish() {
            writeln!(out, "Sent to {receiver}: {rows} rows, {lost} of them lost.")?;
        }
    }
    Ok(if outcome.went_wrong() {
        Status::Fault
    } else {
        Status::Done
    })
}

/// Returns the name of a file of the trace, with its content in brackets.
fn described(format: Format, written: TraceInfo) -> String {
    let window_s = written.window_from_s.zip(written.window_to_s);
    let shows = match (window_s.filter(|_| format.has_edges()), written.every) {
        (Some((from_s, to_s)), _) => format!("{from_s:.3} to {to_s:.3} s; --window shows others"),
        (None, 1) => "a row every tick".to_owned(),
        (None, every) => format!("a row every {every} ticks"),
    };
    format!("{} ({shows})", format.file_name())
}

/// Name of the report.
pub(super) const REPORT: &str = "report.json";
/// Name of the page.
pub(super) const PAGE: &str = "scope.svg";
/// Name of the picture of the machine's operating range.
const RANGE: &str = "torque.svg";
/// Name of the layout with which GTKWave shows steps.fst.
const LAYOUT: &str = "steps.gtkw";

/// Names of the files that a run writes, depending on its scene and options.
pub(super) fn optional_files() -> impl Iterator<Item = &'static str> {
    let traces = Format::ALL.into_iter().map(Format::file_name);
    traces.chain([LAYOUT, RANGE])
}

/// Returns a line that names the files of an earlier run that were removed; empty if there were none.
pub(super) fn removed_line(names: &[&str]) -> String {
    if names.is_empty() {
        return String::new();
    }
    let names = names.join(", ");
    format!("Removed from there, as it was of an earlier run: {names}.\n")
}

/// Runs a scene and writes all of its files, or none. Returns the scene with the answers to its questions, and the names of the files
/// of an earlier run that this run does not have and has removed.
fn record(
    args: &RunArgs,
    checked: Checked,
    began: Instant,
    live: &mut Live,
    range: Option<&str>,
) -> Result<(Checked, Outcome, TraceInfo, Vec<&'static str>), String> {
    let place = |error: &dyn std::fmt::Display| error.to_string();
    let names = args.files().map(Format::file_name);
    let names = names.chain([REPORT, PAGE]);
    let names = names.chain(range.map(|_| RANGE)).chain(args.layout());
    let names: Vec<_> = names.collect();
    refuse_folders(&args.out, names.iter().copied())?;
    let is_requested = args.window.is_some() || checked.scene.scope.is_some();
    let window = args
        .window
        .unwrap_or_else(|| Window::for_scene(&checked.scene));
    let (mut files, checked, outcome, written) =
        record_window(args, checked, began, window, Some(live))?;
    // Two cases are detected only after the run: a slip or a latched fault without an injected fault, and a run that ended before its
    // first injected fault. The scene is then run again, with the window of edges at the right time.
    let never_began = !is_requested && window != Window::FirstMotion && written.is_empty();
    let by_itself = window == Window::FirstMotion && checked.scene.fault.is_empty();
    let effect_s = outcome.record.first_effect_s();
    let has_edges = args.files().any(Format::has_edges);
    let other = match effect_s.filter(|_| by_itself || never_began) {
        Some(at_s) => Some(Window::around(at_s)),
        None => never_began.then_some(Window::FirstMotion),
    };
    let other = other.filter(|_| has_edges);
    let (checked, outcome, written) = match other {
        Some(window) => {
            drop(files);
            // The first run has already sent the live rows.
            let again = record_window(args, checked, began, window, None)?;
            files = again.0;
            (again.1, again.2, again.3)
        }
        None => (checked, outcome, written),
    };
    if is_requested && written.is_empty() {
        return Err(outside(args, &checked, &outcome));
    }
    let range = range.map(|range| (RANGE, range.to_owned()));
    let layout = args.layout();
    let layout = layout.map(|name| (name, gtkwave_layout(checked.scene.axes.count)));
    for (name, text) in range.into_iter().chain(layout) {
        let mut file = files.file(name).map_err(|e| place(&e))?;
        file.write_all(text.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|e| place(&e))?;
    }
    let mut removed: Vec<_> = optional_files().collect();
    removed.retain(|name| !names.contains(name) && files.leave_out(name));
    files.commit().map_err(|e| place(&e))?;
    Ok((checked, outcome, written, removed))
}

/// Refuses an output folder in which a folder has the name of a file. This is checked before the run. Later, some of the files would
/// already be in place.
pub(super) fn refuse_folders<'a>(
    out: &Path,
    mut names: impl Iterator<Item = &'a str>,
) -> Result<(), String> {
    let folder = names.find_map(|name| Some(out.join(name)).filter(|path| path.is_dir()));
    match folder {
        None => Ok(()),
        Some(path) => Err(format!(
            "--out: {} is a directory, where a file is to be written; take it away, or give another --out",
            path.display()
        )),
    }
}

/// Returns a time without the digits that are rounding errors, s.
fn shortest(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}

/// Refuses a window whose file would become too large. Without this check, that is known only when much of the run has been written.
fn check_window(args: &RunArgs, checked: &Checked) -> Result<(), String> {
    if !args.files().any(Format::has_edges) {
        return Ok(());
    }
    let window = args
        .window
        .unwrap_or_else(|| Window::for_scene(&checked.scene));
    let ticks = expected_ticks(checked).map_err(|error| error.in_file(&args.scene).to_string())?;
    let run_s = ticks as f64 / f64::from(checked.settings.tick_hz);
    (window.check_length(checked, run_s)).map_err(|error| match args.window {
        Some(_) => format!("--window: {error}"),
        None => {
            let wrong = SceneError::for_key("scope.to_s", error.to_string());
            wrong.in_file(&args.scene).to_string()
        }
    })
}

/// Returns the error that a requested window contains no part of the run.
fn outside(args: &RunArgs, checked: &Checked, outcome: &Outcome) -> String {
    let lasted_s = outcome.simulated_s();
    let wrong = |from_s: f64, to_s: f64| {
        format!(
            "{} to {} s is outside the run, which lasted {lasted_s:.2} s; give a window inside it",
            shortest(from_s),
            shortest(to_s)
        )
    };
    match (args.window, checked.scene.scope) {
        (Some(Window::Between(from_ns, to_ns)), _) => {
            let seconds = |ns: u64| ns as f64 * 1e-9;
            format!("--window: {}", wrong(seconds(from_ns), seconds(to_ns)))
        }
        (_, Some(scope)) => {
            let problem = wrong(scope.from_s, scope.to_s);
            SceneError::for_key("scope.from_s", problem)
                .in_file(&args.scene)
                .to_string()
        }
        _ => format!("--window: nothing of it is inside the run, which lasted {lasted_s:.2} s"),
    }
}

/// Runs a scene, and writes its files with the edges of a window. The files are not in place yet.
fn record_window(
    args: &RunArgs,
    checked: Checked,
    began: Instant,
    window: Window,
    live: Option<&mut Live>,
) -> Result<(RunFiles, Checked, Outcome, TraceInfo), String> {
    let place = |error: &dyn std::fmt::Display| error.to_string();
    let mut files = RunFiles::create(&args.out)
        .map_err(|e| format!("--out: {e}; give a directory that is there or can be made"))?;
    let mut file = |name| files.file(name).map_err(|e| place(&e));
    let (mut report_file, mut svg) = (file(REPORT)?, file(PAGE)?);
    let traces = args
        .files()
        .map(|format| Ok((format, file(format.file_name())?)));
    let traces = traces.collect::<Result<Vec<_>, String>>()?;

    let every = match (args.every, args.udp) {
        (Some(every), _) => Every::Ticks(every),
        // Rows that are sent at once cannot be thinned afterwards.
        (None, Some(_)) => Every::for_run(expected_ticks(&checked).map_err(|e| place(&e))?),
        (None, None) => Every::Fitting,
    };
    let (udp, clock) = live.map(Live::begin).unwrap_or_default();
    let recorder = Recorder::new(
        &checked,
        traces,
        udp,
        every,
        window,
        ScopeData::new(checked.scene.axes.count, ScopeFrame::for_scene(&checked)),
    )
    .map_err(|e| place(&e))?;

    let bar = progress_bar(args.quiet);
    let has_questions = checked
        .choice
        .as_ref()
        .is_some_and(|choice| !choice.judged.is_empty());
    // The clock is first: a row is sent when its time has come.
    let mut observers = (clock, (recorder, has_questions.then(Answers::default)));
    let outcome = simulate(&checked, &mut observers, |done, about| {
        bar.set_length(about.max(done));
        bar.set_position(done);
    })
    .map_err(|e| e.in_file(&args.scene).to_string())?;
    bar.finish_and_clear();

    let (_, (recorder, answers)) = observers;
    let checked = fidelity::answered(checked, &answers.unwrap_or_default());
    let (written, mut scope) = recorder.finish().map_err(|e| place(&e))?;
    report::mark(
        &mut scope,
        &outcome.record,
        report::notable(&outcome.record.events),
    );
    svg.write_all(scope.render().as_bytes())
        .and_then(|()| svg.flush())
        .map_err(|e| place(&e))?;
    let report = Report::new(
        &checked,
        &outcome,
        Some(written),
        began.elapsed().as_secs_f64(),
    );
    serde_json::to_writer_pretty(&mut report_file, &report).map_err(|e| place(&e))?;
    report_file
        .write_all(b"\n")
        .and_then(|()| report_file.flush())
        .map_err(|e| place(&e))?;
    drop((report_file, svg));
    drop(report);
    Ok((files, checked, outcome, written))
}
