//! `cophase design`: design methods from the command line.

use std::io::{self, Write};

use cophase_lab::design::platform::Platform;
use cophase_lab::design::{Form, Machine, Refused, print};

use crate::output::{NotWritten, write_file};

/// Size a machine; without a subcommand, a vibration platform on slider-cranks (steps A to J)
#[derive(Clone, Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct DesignArgs {
    /// Other machine than the platform
    #[command(subcommand)]
    machine: Option<Machine>,
    #[command(flatten)]
    platform: Option<Platform>,
    /// Print one JSON object instead of text
    #[arg(long, global = true)]
    json: bool,
    /// Print a scene of the design for `cophase run` instead of text: of a platform, a crank-rocker or a screen
    #[arg(long, global = true)]
    scene: bool,
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

impl From<Refused> for DesignCommandError {
    fn from(Refused(problem): Refused) -> Self {
        Self::Input(problem)
    }
}

/// Runs the command, and writes text, with `--json` one object, or with `--scene` a scene, to `out`.
///
/// # Errors
/// Bad input, before anything is written; or `out` cannot be written.
pub fn run(args: &DesignArgs, out: &mut impl Write) -> Result<(), DesignCommandError> {
    let form = match (args.json, args.scene) {
        (true, true) => {
            return Err(DesignCommandError::Input(
                "--json, --scene: both print to standard output; give one of them".to_owned(),
            ));
        }
        (true, false) => Form::Json,
        (false, true) => Form::Scene,
        (false, false) => Form::Page,
    };
    let printed = match (&args.machine, &args.platform) {
        (Some(machine), _) => machine.print(form)?,
        (None, Some(platform)) => print(platform, form)?,
        // The parser requires the platform's options if there is no subcommand.
        (None, None) => {
            return Err(DesignCommandError::Input(
                "name a machine, or give the requirement of a platform; see cophase design --help"
                    .to_owned(),
            ));
        }
    };
    if let Some((file, svg)) = &printed.drawing {
        write_file("--svg", file, svg.as_bytes())?;
    }
    Ok(out.write_all(&printed.text)?)
}
