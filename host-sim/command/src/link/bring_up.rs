//! Bring-up: inputs, outputs and single axes, one after the other.

use std::io::Write;
use std::time::{Duration, Instant};

use cophase_link::message::{Identity, Inputs, Output, Request};
use cophase_link::server::OUTPUT_MS;

use super::Problem;
use super::args::{BringUp, LinkArgs, OutputArgs};
use super::connection::Connection;
use super::operate::confirm;
use super::show;
use crate::Status;

/// Time between two readings of the inputs.
const READ_EVERY: Duration = Duration::from_millis(50);

/// Time for which an output keeps a level. It is renewed before the controller releases the output.
const LEVEL_TIME: Duration = Duration::from_millis(500);
const _: () = assert!(LEVEL_TIME.as_millis() < OUTPUT_MS as u128);

pub(super) fn bring_up(
    action: &BringUp,
    args: &LinkArgs,
    link: &mut Connection,
    identity: &Identity,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, Problem> {
    match action {
        BringUp::Inputs(monitor) => watch_inputs(link, identity, monitor.for_s, out)?,
        BringUp::Output(output) => {
            unlock(args, output.yes, "switches an output", link, err)?;
            toggle(link, output, out)?;
        }
        BringUp::Axis(axis) => {
            let what = "restarts with one axis, which can then be homed and jogged; detach its rod";
            unlock(args, axis.yes, what, link, err)?;
            let identity = link.restart(identity, &Request::OnlyAxis(axis.number))?;
            show::identity(&identity, out)?;
        }
    }
    Ok(Status::Done)
}

fn unlock(
    args: &LinkArgs,
    yes: bool,
    what: &str,
    link: &mut Connection,
    err: &mut impl Write,
) -> Result<(), Problem> {
    link.take_control(args.take_over)?;
    confirm(yes, what, err)?;
    Ok(link.repeatable("unlock", &Request::Unlock)?)
}

/// Shows the inputs, and again whenever they change.
fn watch_inputs(
    link: &mut Connection,
    identity: &Identity,
    for_s: Option<f64>,
    out: &mut impl Write,
) -> Result<(), Problem> {
    let begin = Instant::now();
    let is_over = || for_s.is_some_and(|for_s| begin.elapsed() >= Duration::from_secs_f64(for_s));
    let mut last = None;
    loop {
        let inputs = link.inputs()?;
        if last != Some(inputs) {
            writeln!(out, "{}", describe(&inputs, identity))?;
            out.flush()?;
            last = Some(inputs);
        }
        if is_over() {
            return Ok(());
        }
        std::thread::sleep(READ_EVERY);
    }
}

/// One line with the meaning of all inputs.
fn describe(inputs: &Inputs, identity: &Identity) -> String {
    let axes = |set: u8| {
        let numbers = (0..8).filter(|axis| set & 1 << axis != 0);
        let numbers: Vec<String> = numbers.map(|axis: u8| axis.to_string()).collect();
        if numbers.is_empty() {
            "none".to_owned()
        } else {
            numbers.join(" ")
        }
    };
    let word = |is_active, yes: &'static str, no: &'static str| if is_active { yes } else { no };
    format!(
        "enable {}  stop {}  start {}  index {}  alarm {}{}",
        word(inputs.enable, "closed", "OPEN"),
        word(inputs.stop, "ACTIVE", "inactive"),
        word(inputs.start, "pressed", "released"),
        axes(inputs.index),
        axes(inputs.alarm),
        identity
            .only_axis
            .map_or(String::new(), |axis| format!("  (only axis {axis} runs)")),
    )
}

/// Switches an output between its levels, and leaves it released.
fn toggle(link: &mut Connection, args: &OutputArgs, out: &mut impl Write) -> Result<(), Problem> {
    let end = Instant::now() + Duration::from_secs_f64(args.for_s);
    let output = args.output;
    let mut set = |link: &mut Connection, is_active| -> Result<(), Problem> {
        link.repeatable("output", &Request::Output { output, is_active })?;
        let level = if is_active { "active" } else { "inactive" };
        writeln!(out, "{} {level}", name(output))?;
        Ok(out.flush()?)
    };
    let mut is_active = true;
    while Instant::now() < end {
        set(link, is_active)?;
        std::thread::sleep(LEVEL_TIME.min(end.saturating_duration_since(Instant::now())));
        is_active = !is_active;
    }
    // The controller releases it by itself soon.
    set(link, false)
}

/// Parses the name of an output.
pub(super) fn output(text: &str) -> Result<Output, String> {
    let axis = |number: &str| number.parse().ok();
    let parsed = match text {
        "drive-enable" => Some(Output::DriveEnable),
        "sync" => Some(Output::Sync),
        _ => match (text.strip_prefix("step"), text.strip_prefix("dir")) {
            (Some(number), _) => axis(number).map(Output::Step),
            (_, Some(number)) => axis(number).map(Output::Dir),
            _ => None,
        },
    };
    parsed.ok_or_else(|| {
        "give step0, step1, … or dir0, dir1, … with the number of an axis, drive-enable, or sync"
            .to_owned()
    })
}

fn name(output: Output) -> String {
    match output {
        Output::Step(axis) => format!("step{axis}"),
        Output::Dir(axis) => format!("dir{axis}"),
        Output::DriveEnable => "drive-enable".to_owned(),
        Output::Sync => "sync".to_owned(),
    }
}
