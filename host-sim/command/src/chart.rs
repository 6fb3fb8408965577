//! `cophase chart`: a chart's data and picture.

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};

use cophase_files::trace::RunFiles;
use cophase_lab::chart::{self, CHARTS, Size};
use cophase_scene::load;
use host_sim::sim;
use indicatif::{ProgressBar, ProgressStyle};

use super::refusal::visible;
use super::{CommandError, Status, scenes};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "A chart of your own scene, such as the error of each numerical method against its cost:\n\n    cophase chart methods my-machine.toml"
)]
pub(super) struct ChartArgs {
    /// Name of the chart; `list` lists them all, and those that take a scene
    name: String,
    /// A scene file, or the name of a built-in scene, instead of the problems of the manual
    scene: Option<String>,
    /// Folder for NAME.csv and NAME.svg, or NAME-PART.svg for each picture of several; with a scene, NAME-SCENE.csv and NAME-SCENE.svg
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Extent of the measurements; the charts of the manual are full
    #[arg(long, value_enum, default_value_t)]
    size: Size,
}

pub(super) fn chart(args: &ChartArgs, out: &mut impl Write) -> Result<Status, CommandError> {
    if args.name == "list" && args.scene.is_none() {
        let width = CHARTS.iter().map(|chart| chart.name.len()).max();
        let width = width.unwrap_or(0);
        for chart in CHARTS {
            let takes = chart.draw_scene.map_or("", |_| "; or of a SCENE");
            writeln!(out, "{:width$}  {}{takes}", chart.name, chart.shows)?;
        }
        return Ok(Status::Done);
    }
    let Some(chart) = chart::find(&args.name) else {
        return Err(CommandError::Input(match &args.scene {
            Some(scene) if args.name == "list" => takes_no_scene(&args.name, scene),
            _ => unknown(&args.name),
        }));
    };
    let of_scene = match &args.scene {
        None => None,
        Some(scene) => {
            let Some(draw) = chart.draw_scene else {
                return Err(CommandError::Input(takes_no_scene(chart.name, scene)));
            };
            let checked = scenes::read(scene).map_err(CommandError::Input)?;
            sim::check_times(&checked)
                .map_err(|error| CommandError::Input(error.in_file(scene).to_string()))?;
            Some((draw, checked, scene))
        }
    };
    let place = |error: &dyn std::fmt::Display| {
        CommandError::Input(format!("--out: {error}; give a folder that can be written"))
    };
    // A folder that cannot be created is found before minutes of measurements.
    let mut files = RunFiles::create(&args.out).map_err(|error| place(&error))?;
    let bar = progress_bar();
    let mut progress = |done, of| {
        bar.set_length(of);
        bar.set_position(done);
    };
    let drawn = match &of_scene {
        None => (chart.draw)(args.size, &mut progress)
            .map_err(|error| format!("{}: {error}", chart.name)),
        Some((draw, checked, scene)) => draw(checked, args.size, &mut progress)
            .map_err(|error| error.in_file(scene).to_string()),
    };
    let drawn = drawn.map_err(CommandError::Input)?;
    bar.finish_and_clear();
    let written = drawn.files(&match of_scene {
        None => chart.name.to_owned(),
        Some((_, _, scene)) => format!("{}-{}", chart.name, stem(scene)),
    });
    for (name, text) in &written {
        let mut file = files.file(name).map_err(|error| place(&error))?;
        file.write_all(text.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|error| place(&error))?;
    }
    files.commit().map_err(|error| place(&error))?;
    let names: Vec<&str> = written.iter().map(|(name, _)| name.as_str()).collect();
    writeln!(
        out,
        "{}\nWritten to {}: {}.",
        drawn.says,
        args.out.display(),
        names.join(", ")
    )?;
    Ok(Status::Done)
}

/// Creates a progress bar. It shows on a terminal only: indicatif draws to stderr, and only if stderr is a terminal.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {pos} of {len}  {elapsed} gone");
    ProgressBar::new(0).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Returns the name of a scene's file without its folder and ending.
fn stem(scene: &str) -> &str {
    let stem = Path::new(scene).file_stem().and_then(OsStr::to_str);
    stem.unwrap_or(scene)
}

/// Returns the error that a chart is not about scenes.
fn takes_no_scene(name: &str, scene: &str) -> String {
    let taking = CHARTS.iter().filter(|chart| chart.draw_scene.is_some());
    let taking: Vec<_> = taking.map(|chart| chart.name).collect();
    format!(
        "{}: `{name}` takes no scene; leave it out, or give it to one of {}",
        visible(scene),
        taking.join(", ")
    )
}

fn unknown(name: &str) -> String {
    let known: Vec<_> = CHARTS.iter().map(|chart| chart.name).collect();
    let meant = load::nearest(name, &known).map(|near| format!("did you mean `{near}`? "));
    format!(
        "{}: there is no chart of that name; {}there are {}",
        visible(name),
        meant.unwrap_or_default(),
        known.join(", ")
    )
}
