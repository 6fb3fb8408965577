//! Arguments of `cophase link`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use cophase_core::units::MAX_AXES;
use cophase_files::trace::Window;
use cophase_link::line::UART_BAUD;
use cophase_link::message::Output;

use super::bring_up;
use super::record::ChannelName;
use crate::run::window;
use cophase_lab::numbers::{in_range, whole};

#[derive(Debug, Args)]
#[command(
    about = "Operate a controller: load a program, start, stop, watch",
    after_help = "With one controller plugged in, no --to is needed. Exit status: 0 done; 1 the machine is in a fault; \
                  2 bad input, a refused request, or no controller."
)]
pub(crate) struct LinkArgs {
    /// The controller: a serial port, tcp:HOST:PORT, or sim[:SCENE] for a simulated one
    #[arg(long, value_name = "WHERE", global = true)]
    pub(super) to: Option<String>,
    /// Baud rate of a UART; a USB port ignores it
    #[arg(long, value_name = "BAUD", default_value_t = UART_BAUD, global = true, value_parser = whole::<u32>(1..=u32::MAX.into()), allow_negative_numbers = true)]
    pub(super) baud: u32,
    /// Take control even if another host has it
    #[arg(long, global = true)]
    pub(super) take_over: bool,
    #[command(subcommand)]
    pub(super) action: Action,
}

#[derive(Debug, Subcommand)]
pub(super) enum Action {
    /// List the serial ports, controllers first
    List,
    /// Show board, firmware and settings
    Identify,
    /// Load the program of a scene, which takes effect at once; or all its settings, with a restart
    Load(LoadArgs),
    /// Arm the machine, and run its program
    Start(StartArgs),
    /// Stop all axes together; this needs no control
    Stop(StopArgs),
    /// Stop the program's time; the machine keeps its speed
    Hold,
    /// Resume the program's time
    Resume,
    /// Leave the fault state
    Reset,
    /// Scale the program's amplitude
    Override(OverrideArgs),
    /// Arm the machine, and turn it at homing speed
    Jog(JogArgs),
    /// Arm the machine, home it, and park it
    Home(StartArgs),
    /// Show the machine's status until it is interrupted
    Monitor(MonitorArgs),
    /// Record what the controller streams, and write the files of a run
    Record(RecordArgs),
    /// Show the event log
    Log,
    /// Show the counters of link and loop
    Counters,
    /// Check the wiring: read inputs, switch one output, turn one axis
    #[command(subcommand)]
    BringUp(BringUp),
    /// Restart the controller, which then runs the stored settings, with all axes
    Restart,
}

#[derive(Debug, Subcommand)]
pub(super) enum BringUp {
    /// Show the inputs, and every change, until interrupted
    Inputs(MonitorArgs),
    /// Switch one output between its levels twice a second; the drives must be off
    Output(OutputArgs),
    /// Restart with one axis, turn it, and compare its index pulses with its steps; `jog` turns it again, `restart` ends it
    Axis(AxisArgs),
}

#[derive(Debug, Args)]
pub(super) struct OutputArgs {
    /// step0, step1, … or dir0, dir1, …, drive-enable, sync
    #[arg(value_name = "OUTPUT", value_parser = bring_up::output)]
    pub(super) output: Output,
    /// Time to switch it, seconds
    #[arg(long = "for", value_name = "S", default_value_t = 5.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(super) for_s: f64,
    /// Do not ask before the output is switched
    #[arg(long)]
    pub(super) yes: bool,
}

#[derive(Debug, Args)]
pub(super) struct AxisArgs {
    /// Number of the axis, counted from 0
    #[arg(value_name = "AXIS", value_parser = whole::<u8>(0..=MAX_AXES as u64 - 1), allow_negative_numbers = true)]
    pub(super) number: u8,
    /// Do not ask before the controller restarts
    #[arg(long)]
    pub(super) yes: bool,
}

#[derive(Debug, Args)]
pub(super) struct LoadArgs {
    /// A scene file, the name of a built-in scene, or a settings file
    #[arg(value_name = "SCENE")]
    pub(super) scene: PathBuf,
    /// Load all settings of a scene, and restart; without it, only its program is loaded
    #[arg(long)]
    pub(super) settings: bool,
}

#[derive(Debug, Args)]
pub(super) struct StartArgs {
    /// Do not ask before the machine moves
    #[arg(long)]
    pub(super) yes: bool,
    /// Wait until the machine is parked again; a simulated controller is always waited for
    #[arg(long)]
    pub(super) wait: bool,
}

#[derive(Debug, Args)]
pub(super) struct StopArgs {
    /// Stop as fast as the limits allow, and not at the parking phase
    #[arg(long)]
    pub(super) now: bool,
}

#[derive(Debug, Args)]
pub(super) struct OverrideArgs {
    /// Percent of the program's amplitude, 0 to 120
    #[arg(value_name = "PERCENT", value_parser = percent, allow_negative_numbers = true)]
    pub(super) permille: u16,
}

#[derive(Debug, Args)]
pub(super) struct JogArgs {
    /// Time to turn, seconds
    #[arg(long = "for", value_name = "S", default_value_t = 1.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(super) for_s: f64,
    /// Do not ask before the machine moves
    #[arg(long)]
    pub(super) yes: bool,
}

#[derive(Debug, Args)]
pub(super) struct RecordArgs {
    /// Folder for report.json, trace.csv, steps.vcd and scope.svg
    #[arg(short, long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Channels to record, besides the state [default: all]
    #[arg(long, value_name = "CHANNELS", value_enum, value_delimiter = ',')]
    pub(super) channels: Vec<ChannelName>,
    /// A sample every N control ticks, 1 to 10,000; only every tick has edges
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole::<u16>(1..=10_000), allow_negative_numbers = true)]
    pub(super) every: u16,
    /// Time to record, seconds; without it, until the program is over or Ctrl-C
    #[arg(long = "for", value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub(super) for_s: Option<f64>,
    /// Time that steps.vcd shows, in seconds since power-up, or `all` [default: the first 200 ms of motion]
    #[arg(long, value_name = "FROM..TO", value_parser = window, allow_hyphen_values = true)]
    pub(super) window: Option<Window>,
    /// Arm the machine and run its program; a simulated controller always does
    #[arg(long)]
    pub(super) start: bool,
    /// Do not ask before the machine moves
    #[arg(long, requires = "start")]
    pub(super) yes: bool,
    /// Print nothing but errors
    #[arg(long, short)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct MonitorArgs {
    /// Time to show, seconds; without it, until interrupted
    #[arg(long = "for", value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub(super) for_s: Option<f64>,
}

fn seconds(text: &str) -> Result<f64, String> {
    in_range(
        text,
        0.0..=1e6,
        "s",
        "give seconds without a unit, 0 to 1,000,000",
    )
}

fn percent(text: &str) -> Result<u16, String> {
    let percent = in_range(
        text,
        0.0..=120.0,
        "%",
        "give a number without a unit, 0 to 120",
    )?;
    Ok((percent * 10.0).round() as u16)
}
