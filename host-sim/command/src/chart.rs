//! `cophase chart`: a chart's data and picture.

use std::io::Write;
use std::path::PathBuf;

use cophase_files::trace::RunFiles;
use cophase_lab::chart::{self, CHARTS, Size};
use cophase_scene::load;
use indicatif::{ProgressBar, ProgressStyle};

use super::refusal::visible;
use super::{CommandError, Status};

#[derive(Debug, clap::Args)]
pub(super) struct ChartArgs {
    /// Name of the chart; `list` lists them all
    name: String,
    /// Folder for NAME.csv and NAME.svg, or NAME-PART.svg for each picture of several
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Extent of the measurements; the charts of the manual are full
    #[arg(long, value_enum, default_value_t)]
    size: Size,
}

pub(super) fn chart(args: &ChartArgs, out: &mut impl Write) -> Result<Status, CommandError> {
    if args.name == "list" {
        let width = CHARTS.iter().map(|chart| chart.name.len()).max();
        let width = width.unwrap_or(0);
        for chart in CHARTS {
            writeln!(out, "{:width$}  {}", chart.name, chart.shows)?;
        }
        return Ok(Status::Done);
    }
    let Some(chart) = chart::find(&args.name) else {
        return Err(CommandError::Input(unknown(&args.name)));
    };
    let place = |error: &dyn std::fmt::Display| {
        CommandError::Input(format!("--out: {error}; give a folder that can be written"))
    };
    // A folder that cannot be created is found before minutes of measurements.
    let mut files = RunFiles::create(&args.out).map_err(|error| place(&error))?;
    let bar = progress_bar();
    let drawn = (chart.draw)(args.size, &mut |done, of| {
        bar.set_length(of);
        bar.set_position(done);
    })
    .map_err(|error| CommandError::Input(format!("{}: {error}", chart.name)))?;
    bar.finish_and_clear();
    let written = drawn.files(chart.name);
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
