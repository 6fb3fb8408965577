//! `cophase compare`: reports where two runs begin to differ.

use std::io::Write;
use std::path::PathBuf;

use clap::ValueEnum;
use cophase_files::compare::{self, CompareError, Origin, Run, Tolerances};

use super::output::write_file;
use super::{CommandError, Status};
use cophase_lab::numbers::{meant, unit_of};

#[derive(Debug, clap::Args)]
pub(super) struct CompareArgs {
    /// Folder of a run, or its trace.csv
    a: PathBuf,
    /// Another run, to compare with it
    b: PathBuf,
    /// Write compare.svg into this folder: both runs over each other, and their difference
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Largest difference of a column that counts as none, in its unit; `command_turns=1e-6` is for all axes, `edges_ns=100` for
    /// edges [default: ten units of the last place; integers, states and edges must be equal]
    #[arg(long, value_name = "COLUMN=VALUE", value_parser = tolerance)]
    tolerance: Vec<(String, f64)>,
    /// Moment from which times are counted
    #[arg(long, value_enum, default_value_t = From::PowerUp)]
    from: From,
    /// Print the comparison as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum From {
    /// Power-up of each controller
    PowerUp,
    /// The moment at which each machine leaves idle
    Start,
}

fn tolerance(text: &str) -> Result<(String, f64), String> {
    let (column, value) = text
        .split_once('=')
        .ok_or("give COLUMN=VALUE, such as accel_mps2=0.5")?;
    let value = value.parse().map_err(|_| {
        let meant = meant(value, unit_of(column));
        let example = meant.map_or_else(
            || "such as accel_mps2=0.5".to_owned(),
            |value| format!("without a unit, with a point for fractions: {column}={value}"),
        );
        format!("`{value}` is no number; give COLUMN=VALUE, {example}")
    })?;
    Ok((column.to_owned(), value))
}

/// Compares two runs. The status is that of a fault if they differ.
pub(super) fn compare(args: &CompareArgs, out: &mut impl Write) -> Result<Status, CommandError> {
    let refused = |error: CompareError| CommandError::Input(error.to_string());
    let (a, b) = (
        Run::read(&args.a).map_err(refused)?,
        Run::read(&args.b).map_err(refused)?,
    );
    let origin = match args.from {
        From::PowerUp => Origin::PowerUp,
        From::Start => Origin::Start,
    };
    let tolerances = Tolerances::new(args.tolerance.iter().cloned());
    let comparison = compare::compare([&a, &b], origin, &tolerances).map_err(refused)?;
    if let Some(folder) = &args.out {
        let svg = compare::draw([&a, &b], origin, &comparison).map_err(refused)?;
        write_file("--out", &folder.join("compare.svg"), svg.as_bytes())
            .map_err(|error| CommandError::Input(error.to_string()))?;
    }
    if args.json {
        let text = serde_json::to_string_pretty(&comparison).map_err(std::io::Error::from)?;
        writeln!(out, "{text}")?;
    } else {
        out.write_all(compare::summary(&comparison).as_bytes())?;
    }
    Ok(match comparison.parts {
        None => Status::Done,
        Some(_) => Status::Fault,
    })
}
