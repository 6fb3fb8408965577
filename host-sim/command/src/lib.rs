//! The `cophase` command.
//!
//! Exit status:
//!
//! - 0: done;
//! - 1: the run ended in a fault, or a simulated motor slipped and the controller did not detect it, or no board takes the settings,
//!   and everything was still written;
//! - 2: bad input, and nothing was written;
//! - 130 and 143: ended by SIGINT and SIGTERM, and nothing was written.
#![forbid(unsafe_code)]

mod address;
mod campaign;
mod chart;
mod compare;
mod completions;
pub mod design;
mod expected;
mod link;
mod man;
pub mod output;
mod refusal;
mod reproduced;
mod run;
mod scenes;
mod scope;
mod settings;
mod signals;
mod status;
mod visible;

pub use signals::clean_up_on_signals;
pub use status::{CommandError, Status};

use std::io::{self, Write};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use cophase_files::version;

use design::{DesignArgs, DesignCommandError};
use visible::Visible;

const AFTER_HELP: &str = "Folders of output files and output folders are created where they do not exist, by every command.\n\nExit status: 0 done; 1 a run ended in a fault, a simulated motor slipped undetected, no board takes \
                           the settings, two runs part, or a figure or claim does not hold (everything is written); \
                           2 bad input (nothing is written); 130 and 143 ended by SIGINT and SIGTERM (nothing is written).";

/// Motion control for machines whose motors must turn in phase: simulate one, size one, operate a board.
#[derive(Debug, Parser)]
#[command(name = "cophase", version, arg_required_else_help = true, after_help = AFTER_HELP)]
pub struct Command {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Run a scene: the control loop, in virtual time, against a simulated machine
    Run(run::RunArgs),
    /// Write the settings file of a scene, for the flash of a board
    #[command(alias = "image")]
    Settings(settings::SettingsArgs),
    Link(link::LinkArgs),
    Scope(scope::ScopeArgs),
    /// List the built-in scenes, or print one to start your own from
    Scenes(scenes::ScenesArgs),
    Campaign(campaign::CampaignArgs),
    /// Draw a chart and write its data, such as the error of each numerical method against its cost
    Chart(chart::ChartArgs),
    /// Compare published figures of the machines with those that this project computes
    Reproduced(reproduced::ReproducedArgs),
    /// Compare two runs, and report where they part
    Compare(compare::CompareArgs),
    Design(DesignArgs),
    Completions(completions::CompletionsArgs),
    /// Write the manual pages of the command and its subcommands
    Man(man::ManArgs),
}

impl Command {
    /// Parses the arguments of this process. Ends the process instead if they ask for help, or are refused: with status 2 and a sentence
    /// that has the place, the problem and the fix.
    pub fn of_process() -> Self {
        Self::parsed().unwrap_or_else(|error| {
            match refusal::sentence(&error, &Self::command(), std::env::args_os()) {
                None => error.exit(),
                Some(sentence) => {
                    // If the error cannot be written, the status still reports it.
                    let _ = writeln!(Visible::new(io::stderr()), "cophase: {sentence}");
                    std::process::exit(Status::BadInput as i32)
                }
            }
        })
    }

    fn parsed() -> Result<Self, clap::Error> {
        let version = format!("{} (commit {})", version::RELEASE, version::commit());
        // clap keeps static texts only; there is one for each process.
        let command = Self::command().long_version(&*version.leak());
        Self::from_arg_matches(&command.try_get_matches()?)
    }

    /// Carries the command out. Prints to `out`, and errors to `err`.
    pub fn run(self, out: &mut impl Write, err: &mut impl Write) -> Status {
        let (out, err) = (&mut Visible::new(out), &mut Visible::new(err));
        let done = match self.action {
            Action::Run(args) => run::run(&args, out, err),
            Action::Settings(args) => settings::settings(&args, out),
            Action::Campaign(args) => campaign::campaign(&args, out, err),
            Action::Chart(args) => chart::chart(&args, out),
            Action::Reproduced(args) => reproduced::reproduced(&args, out),
            Action::Link(args) => link::link(&args, out, err),
            Action::Compare(args) => compare::compare(&args, out),
            Action::Scope(args) => scope::scope(&args, out),
            Action::Scenes(args) => scenes::scenes(&args, out),
            Action::Completions(args) => completions::completions(&args, Self::command(), out),
            Action::Man(args) => man::man(&args, Self::command(), out),
            Action::Design(args) => match design::run(&args, out) {
                Ok(()) => Ok(Status::Done),
                Err(DesignCommandError::Write(error)) => Err(error.into()),
                Err(bad_input) => Err(CommandError::Input(bad_input.to_string())),
            },
        };
        match done.and_then(|status| out.flush().map(|()| status).map_err(CommandError::from)) {
            Ok(status) => status,
            // The reader has closed the pipe (`cophase scenes default | head`).
            Err(CommandError::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => {
                Status::Done
            }
            Err(error) => {
                for line in error.to_string().lines() {
                    // If the error cannot be written, the status still reports it.
                    let _ = writeln!(err, "cophase: {line}");
                }
                Status::BadInput
            }
        }
    }
}
