//! `cophase design`: design methods from the command line.
//!
//! Without a machine's name, it sizes the vibration platform. Each other machine is a subcommand.

pub mod crank_rocker;
pub mod five_bar;
pub mod flywheel;
pub mod platform;
pub mod screen;

use std::io::{self, Write};

use serde::Serialize;

use crate::output::NotWritten;

use crank_rocker::CrankRockerArgs;
use five_bar::FiveBarArgs;
use flywheel::FlywheelArgs;
use platform::PlatformArgs;
use screen::ScreenArgs;

/// Size a machine; without a subcommand, a vibration platform on slider-cranks (steps A to J)
#[derive(Clone, Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct DesignArgs {
    /// Other machine than the platform
    #[command(subcommand)]
    machine: Option<Other>,
    #[command(flatten)]
    platform: Option<PlatformArgs>,
    /// Print one JSON object instead of text
    #[arg(long, global = true)]
    json: bool,
    /// Print a scene of the design for `cophase run` instead of text: of a platform, a crank-rocker or a screen
    #[arg(long, global = true)]
    scene: bool,
}

/// Form of the standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Print {
    /// A page of text.
    Page,
    /// One JSON object.
    Json,
    /// A scene.
    Scene,
}

/// Machines beside the platform.
#[derive(Clone, Debug, clap::Subcommand)]
enum Other {
    CrankRocker(CrankRockerArgs),
    FiveBar(FiveBarArgs),
    Flywheel(FlywheelArgs),
    Screen(ScreenArgs),
}

/// Reason why `cophase design` failed.
#[derive(Debug, thiserror::Error)]
pub enum DesignCommandError {
    /// Bad input (exit status 2). Nothing was written. The message has a line for each wrong number.
    #[error("{0}")]
    Input(String),
    /// The drawing could not be written (exit status 2). No part of it remains.
    #[error(transparent)]
    Drawing(#[from] NotWritten),
    /// The output could not be written.
    #[error("cannot write the design: {0}")]
    Write(#[from] io::Error),
}

/// Runs the command, and writes text, with `--json` one object, or with `--scene` a scene, to `out`.
///
/// # Errors
/// Bad input, before anything is written; or `out` cannot be written.
pub fn run(args: &DesignArgs, out: &mut impl Write) -> Result<(), DesignCommandError> {
    let print = match (args.json, args.scene) {
        (true, true) => {
            return Err(DesignCommandError::Input(
                "--json, --scene: both print to standard output; give one of them".to_owned(),
            ));
        }
        (true, false) => Print::Json,
        (false, true) => Print::Scene,
        (false, false) => Print::Page,
    };
    let no_scene = |machine: &str| {
        Err(DesignCommandError::Input(format!(
            "--scene: the design of a {machine} leaves too much open for a scene; start from `cophase scenes {machine}`"
        )))
    };
    match (&args.machine, &args.platform) {
        (Some(Other::CrankRocker(machine)), _) => crank_rocker::run(machine, print, out),
        (Some(Other::FiveBar(_)), _) if args.scene => no_scene("five-bar"),
        (Some(Other::FiveBar(machine)), _) => five_bar::run(machine, args.json, out),
        (Some(Other::Screen(machine)), _) => screen::run(machine, print, out),
        (Some(Other::Flywheel(_)), _) if args.scene => no_scene("jaw-crusher"),
        (Some(Other::Flywheel(machine)), _) => flywheel::run(machine, args.json, out),
        (None, Some(platform)) => platform::run(platform, print, out),
        // The parser requires the platform's flags if there is no subcommand.
        (None, None) => Err(DesignCommandError::Input(
            "name a machine, or give the requirement of a platform; see cophase design --help"
                .to_owned(),
        )),
    }
}

impl DesignCommandError {
    fn input(error: impl std::error::Error) -> Self {
        Self::Input(error.to_string())
    }
}

/// Writes an object, indented.
fn write_json(figures: &impl Serialize, out: &mut impl Write) -> Result<(), DesignCommandError> {
    serde_json::to_writer_pretty(&mut *out, figures).map_err(io::Error::from)?;
    Ok(writeln!(out)?)
}
