//! `cophase run`: a scene goes in, four files and a page of words come out.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::{CommandError, Status, expected, scenes};
use host_sim::fidelity::{self, Answers};
use host_sim::report::{self, Report, Written};
use host_sim::scene::library::SCENES;
use host_sim::scene::{Checked, SceneError};
use host_sim::sim::events::EventKind;
use host_sim::sim::{Outcome, simulate};
use host_sim::trace::{Every, Moved, Recorder, RunFiles, ScopeData, ScopeFrame, Window};

#[derive(Debug, clap::Args)]
pub(super) struct RunArgs {
    /// A scene file, or the name of a built-in scene
    #[arg(value_name = "SCENE", default_value = SCENES[0].name)]
    scene: String,
    /// Where to write report.json, trace.csv, steps.vcd and scope.svg
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// A row of trace.csv every N control ticks [default: so that there are at most 20,000]
    #[arg(long, value_name = "N", value_parser = ticks)]
    every: Option<u64>,
    /// What steps.vcd shows, in seconds, or `all` [default: the scene's window, or 200 ms: around the first fault that is put in, around
    /// the first slip or latched fault, or the first of motion]
    #[arg(long, value_name = "FROM..TO", value_parser = window)]
    window: Option<Window>,
    /// Process all index pulses of a tick in that tick, where a board processes one per tick: reactions come up to N + 3 ticks earlier
    #[arg(long)]
    detect_at_once: bool,
    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

impl RunArgs {
    /// As if a scene file had been given, and a folder to write to.
    pub(super) fn of(scene: &Path, out: &Path, quiet: bool) -> Self {
        Self {
            scene: scene.display().to_string(),
            out: out.to_path_buf(),
            every: None,
            window: None,
            detect_at_once: false,
            quiet,
        }
    }
}

fn ticks(text: &str) -> Result<u64, String> {
    text.parse()
        .ok()
        .filter(|&ticks| ticks > 0)
        .ok_or_else(|| "give a whole number of control ticks, 1 or more".to_owned())
}

fn window(text: &str) -> Result<Window, String> {
    if text == "all" {
        return Ok(Window::All);
    }
    let wrong = || "give FROM..TO in seconds, 0 or later, such as 2.5..2.6, or `all`".to_owned();
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let seconds = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|s| (0.0..=1e6).contains(s))
    };
    let (from_s, to_s) = seconds(from).zip(seconds(to)).ok_or_else(wrong)?;
    if to_s <= from_s {
        return Err(format!(
            "it ends at {to_s} s, not after its beginning at {from_s} s; swap the two"
        ));
    }
    Ok(Window::seconds(from_s, to_s))
}

/// Runs a scene: prints what it came to to `out`, and how long that will take to `err` if it is long.
pub(super) fn run(
    args: &RunArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, CommandError> {
    let began = Instant::now();
    let mut checked = scenes::read(&args.scene).map_err(CommandError::Input)?;
    checked.settings.detect_at_once = args.detect_at_once;
    let refused = |error: SceneError| CommandError::Input(error.in_file(&args.scene).to_string());
    if !args.quiet {
        expected::before_choice(&checked, err).map_err(refused)?;
    }
    let checked = fidelity::check(checked).map_err(refused)?;
    if !args.quiet {
        expected::before_run(&checked, err).map_err(refused)?;
    }
    let (checked, outcome, written) = record(args, checked, began).map_err(CommandError::Input)?;
    if !args.quiet {
        let wall_s = began.elapsed().as_secs_f64();
        out.write_all(report::summary(&checked, &outcome, Some(written), wall_s).as_bytes())?;
        let rows = match written.every {
            1 => "a row every tick".to_owned(),
            every => format!("a row every {every} ticks"),
        };
        writeln!(
            out,
            "Written to {}: report.json, trace.csv ({rows}), steps.vcd ({:.3} to {:.3} s; --window shows others), scope.svg.",
            args.out.display(),
            written.window_from_s,
            written.window_to_s,
        )?;
    }
    let went_wrong =
        outcome.fault.is_some() || outcome.slipped_undetected() || outcome.diverged.is_some();
    Ok(if went_wrong {
        Status::Fault
    } else {
        Status::Done
    })
}

const FILES: [&str; 4] = ["report.json", "trace.csv", "steps.vcd", "scope.svg"];

/// Runs a scene and writes its files: all of them, or none. Returns the scene with the values of what was requested.
fn record(
    args: &RunArgs,
    checked: Checked,
    began: Instant,
) -> Result<(Checked, Outcome, Written), String> {
    let place = |error: &dyn std::fmt::Display| error.to_string();
    // Found before the run, not after it, when the files before it would be in place already.
    for path in FILES.map(|name| args.out.join(name)) {
        if path.is_dir() {
            let path = path.display();
            return Err(format!(
                "--out: {path} is a directory, where a file is to be written; take it away, or give another --out"
            ));
        }
    }
    let is_requested = args.window.is_some() || checked.scene.scope.is_some();
    let window = args.window.unwrap_or_else(|| Window::of(&checked.scene));
    let (files, checked, outcome, written) = record_window(args, checked, began, window)?;
    // What went wrong by itself is known after a run only, as is that the run ended before its first fault. The same run again shows
    // the edges at that time.
    let never_began = !is_requested && window != Window::FirstMotion && written.is_empty();
    let by_itself = window == Window::FirstMotion && checked.scene.fault.is_empty();
    let effect_s = outcome.statistics.first_effect_s();
    let other = match effect_s.filter(|_| by_itself || never_began) {
        Some(at_s) => Some(Window::around(at_s)),
        None => never_began.then_some(Window::FirstMotion),
    };
    let (files, checked, outcome, written) = match other {
        Some(window) => {
            drop(files);
            record_window(args, checked, began, window)?
        }
        None => (files, checked, outcome, written),
    };
    if is_requested && written.is_empty() {
        return Err(outside(args, &checked, &outcome));
    }
    files.commit().map_err(|e| place(&e))?;
    Ok((checked, outcome, written))
}

/// That a window that was requested shows nothing.
fn outside(args: &RunArgs, checked: &Checked, outcome: &Outcome) -> String {
    let lasted_s = outcome.simulated_s();
    let wrong = |from_s: f64, to_s: f64| {
        format!(
            "{from_s} to {to_s} s is outside the run, which lasted {lasted_s:.2} s; give a window inside it"
        )
    };
    match (args.window, checked.scene.scope) {
        (Some(Window::Between(from_ns, to_ns)), _) => {
            let seconds = |ns: u64| ns as f64 * 1e-9;
            format!("--window: {}", wrong(seconds(from_ns), seconds(to_ns)))
        }
        (_, Some(scope)) => {
            let problem = wrong(scope.from_s, scope.to_s);
            SceneError::at("scope.from_s", problem)
                .in_file(&args.scene)
                .to_string()
        }
        _ => format!("--window: nothing of it is inside the run, which lasted {lasted_s:.2} s"),
    }
}

/// Runs a scene, and writes its files with the edges of a window; they are not in place yet.
fn record_window(
    args: &RunArgs,
    checked: Checked,
    began: Instant,
    window: Window,
) -> Result<(RunFiles, Checked, Outcome, Written), String> {
    let place = |error: &dyn std::fmt::Display| error.to_string();
    let mut files = RunFiles::create(&args.out)
        .map_err(|e| format!("--out: {e}; give a directory that is there or can be made"))?;
    let mut file = |name| files.file(name).map_err(|e| place(&e));
    let (mut report_file, csv, vcd, mut svg) = (
        file(FILES[0])?,
        file(FILES[1])?,
        file(FILES[2])?,
        file(FILES[3])?,
    );

    let every = args.every.map_or(Every::Fitting, Every::Ticks);
    let recorder = Recorder::new(
        &checked,
        csv,
        vcd,
        every,
        window,
        ScopeData::new(checked.scene.axes.count, frame(&checked)),
    )
    .map_err(|e| place(&e))?;

    let bar = progress_bar(args.quiet);
    let has_questions = checked
        .choice
        .as_ref()
        .is_some_and(|choice| !choice.judged.is_empty());
    let mut observers = (recorder, has_questions.then(Answers::default));
    let outcome = simulate(&checked, &mut observers, |done, about| {
        bar.set_length(about.max(done));
        bar.set_position(done);
    })
    .map_err(|e| e.in_file(&args.scene).to_string())?;
    bar.finish_and_clear();

    let (recorder, answers) = observers;
    let checked = fidelity::answered(checked, &answers.unwrap_or_default());
    let (written, mut scope) = recorder.finish().map_err(|e| place(&e))?;
    mark(&mut scope, &outcome);
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

pub(super) fn frame(checked: &Checked) -> ScopeFrame {
    let scene = &checked.scene;
    ScopeFrame {
        title: scene.name.clone(),
        subtitle: scene.description.clone(),
        bands_hz: scene
            .limits
            .band
            .iter()
            .map(|band| (band.from_hz, band.to_hz))
            .collect(),
        gravity_mps2: host_sim::design::STANDARD_GRAVITY_MPS2,
        tilt_limit_mrad: checked
            .has_platform()
            .then_some(scene.drift.tilt_limit_mrad),
        moved: match (&checked.plant, &checked.cam) {
            (Some(_), _) => Moved::Machine,
            (None, Some(_)) => Moved::Pushers,
            (None, None) => Moved::Platform,
        },
        phase_error_limit_deg: None, // limits are on the modes of all phase errors, not on one
    }
}

/// Events that are worth a mark on the page; the states have a ribbon of their own.
fn mark(scope: &mut ScopeData, outcome: &Outcome) {
    let mut slips = vec![0; outcome.statistics.slipped_cycles.len()];
    for event in outcome
        .statistics
        .events
        .iter()
        .filter(|event| report::is_notable(&event.what))
    {
        match &event.what {
            EventKind::BandCrossed { .. } => scope.mark(event.t_s, "band crossed"),
            EventKind::TurnedBackInBand { .. } => scope.mark(event.t_s, "turned back in band"),
            EventKind::HeldAtBand { .. } => scope.mark(event.t_s, "held at band"),
            EventKind::Missed { .. } => scope.mark(event.t_s, "deadlines missed"),
            EventKind::Slipped { axis, .. } => {
                slips[*axis] += 1;
                if slips[*axis] == 1 {
                    scope.mark(event.t_s, &format!("axis {axis} slips"));
                }
            }
            EventKind::Fault { fault, .. } => {
                scope.mark(event.t_s, &format!("fault: {}", fault.kind));
            }
            EventKind::Reported(fault) => {
                scope.mark(event.t_s, &format!("reported: {}", fault.kind));
            }
            EventKind::Commanded(_) | EventKind::Input { .. } | EventKind::Injected(_) => {
                scope.mark(event.t_s, &report::describe(&event.what));
            }
            EventKind::State(_) | EventKind::Running { .. } | EventKind::Lagged { .. } => {}
        }
    }
}

/// Seen on a terminal only, and only once a run takes its time.
fn progress_bar(quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    // indicatif draws to stderr, and only if that is a terminal.
    let style =
        ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} gone, {eta} to go");
    ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
