//! `cophase chart`: a chart's data and picture.

use std::io::Write;
use std::path::PathBuf;

use super::{CommandError, Status};
use crate::chart::{self, CHARTS};
use crate::scene::load;
use crate::trace::RunFiles;

#[derive(Debug, clap::Args)]
pub(super) struct ChartArgs {
    /// Which chart; `list` names them
    name: String,
    /// Where to write NAME.csv and NAME.svg
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
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
    let drawn = (chart.draw)();
    let place = |error: &dyn std::fmt::Display| {
        CommandError::Input(format!("--out: {error}; give a folder that can be written"))
    };
    let mut files = RunFiles::create(&args.out).map_err(|error| place(&error))?;
    for (name, text) in [
        (format!("{}.csv", chart.name), &drawn.csv),
        (format!("{}.svg", chart.name), &drawn.svg),
    ] {
        let mut file = files.file(&name).map_err(|error| place(&error))?;
        file.write_all(text.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|error| place(&error))?;
    }
    files.commit().map_err(|error| place(&error))?;
    writeln!(
        out,
        "{}\nWritten to {}: {name}.csv, {name}.svg.",
        drawn.says,
        args.out.display(),
        name = chart.name
    )?;
    Ok(Status::Done)
}

fn unknown(name: &str) -> String {
    let known: Vec<_> = CHARTS.iter().map(|chart| chart.name).collect();
    let meant = load::nearest(name, &known).map(|near| format!("did you mean `{near}`? "));
    format!(
        "{name}: there is no chart of that name; {}there are {}",
        meant.unwrap_or_default(),
        known.join(", ")
    )
}
