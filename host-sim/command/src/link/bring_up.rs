//! Bring-up: inputs, outputs and single axes, one after the other.

use std::io::Write;
use std::time::{Duration, Instant};

use cophase_core::supervisor::State;
use cophase_core::units::Turns;
use cophase_link::message::{Identity, Inputs, Output, Request, StopKind};
use cophase_link::sample::{Channel, Channels, Sample};
use cophase_link::server::OUTPUT_MS;

use super::Problem;
use super::args::{BringUp, LinkArgs, OutputArgs};
use super::connection::{Connection, Incoming};
use super::error::LinkError;
use super::measure::{Measurement, Reading};
use super::operate::{JOG_EVERY, begin, confirm};
use super::show;
use crate::Status;

/// Time between two readings of the inputs.
const READ_EVERY: Duration = Duration::from_millis(50);

/// Time for which an output keeps a level. It is renewed before the controller releases the output.
const LEVEL_TIME: Duration = Duration::from_millis(500);
const _: () = assert!(LEVEL_TIME.as_millis() < OUTPUT_MS as u128);

/// Samples a second while an axis is measured.
const SAMPLES_HZ: u32 = 1000;

/// Longest time to home one crank without looking for its index, or to stop it.
const REACHES_WITHIN: Duration = Duration::from_secs(60);

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
            let what = "restarts with one axis, and turns it at homing speed to measure it; detach its rod";
            unlock(args, axis.yes, what, link, err)?;
            let identity = link.restart(identity, &Request::OnlyAxis(axis.number))?;
            show::identity(&identity, out)?;
            link.take_control(args.take_over)?;
            return turn(link, axis.number, &identity, out);
        }
    }
    Ok(Status::Done)
}

/// Turns the only axis for some turns, and compares its index pulses with what is commanded.
fn turn(
    link: &mut Connection,
    axis: u8,
    identity: &Identity,
    out: &mut impl Write,
) -> Result<Status, Problem> {
    let channels = [
        Channel::State,
        Channel::Phase,
        Channel::Lead,
        Channel::Steps,
    ]
    .into_iter()
    .fold(0, |all, channel| all | channel as Channels);
    // A slow line loses some of more samples.
    let every = u16::try_from(identity.tick_hz / SAMPLES_HZ)
        .unwrap_or(u16::MAX)
        .max(1);
    link.repeatable("bring-up", &Request::Stream { channels, every })?;
    begin(link, "home", &Request::Home)?;
    if !reaches(link, State::Parked)? {
        return ends_in_fault(link, identity, out);
    }
    begin(link, "jog", &Request::Jog)?;
    let mut measurement = Measurement::default();
    let mut jog_at = Instant::now() + JOG_EVERY;
    let mut is_over = false;
    let mut has_begun = false;
    while !is_over {
        if Instant::now() >= jog_at {
            jog_at = Instant::now() + JOG_EVERY;
            link.command("jog", &Request::Jog)?;
        }
        for sample in samples(link)? {
            let jogs = sample.situation().jogs;
            has_begun |= jogs;
            if jogs {
                is_over |= measurement.take(reading(&sample));
            } else if has_begun {
                return ends_in_fault(link, identity, out);
            }
        }
    }
    link.repeatable("stop", &Request::Stop(StopKind::AtPhase))?;
    if !reaches(link, State::Parked)? {
        return ends_in_fault(link, identity, out);
    }
    let finding = measurement.finding();
    write!(out, "{}", finding.describe(axis))?;
    writeln!(
        out,
        "An index does not show the direction: the crank must have turned in the positive sense. If not, set `reversed`."
    )?;
    Ok(if finding.is_right() {
        Status::Done
    } else {
        Status::Fault
    })
}

/// Returns the samples that have arrived.
fn samples(link: &mut Connection) -> Result<Vec<Sample>, LinkError> {
    match link.next(Duration::from_millis(20))? {
        Some(Incoming::Samples(samples)) => Ok(samples),
        _ => Ok(Vec::new()),
    }
}

/// Waits until the machine is in a state; returns false if it ends in a fault, or in idle by the enable input.
fn reaches(link: &mut Connection, goal: State) -> Result<bool, LinkError> {
    let end = Instant::now() + REACHES_WITHIN;
    let mut has_left_idle = false;
    while Instant::now() < end {
        for sample in samples(link)? {
            match sample.situation().state {
                state if state == goal => return Ok(true),
                State::Fault => return Ok(false),
                State::Idle if has_left_idle => return Ok(false),
                state => has_left_idle |= state != State::Idle,
            }
        }
    }
    Err(link.no_reply("bring-up", &Request::Home))
}

/// Reports why the axis did not turn on.
fn ends_in_fault(
    link: &mut Connection,
    identity: &Identity,
    out: &mut impl Write,
) -> Result<Status, Problem> {
    show::log(link, identity, out)?;
    writeln!(
        out,
        "The axis stopped before it was measured: the events above say why."
    )?;
    Ok(Status::Fault)
}

fn reading(sample: &Sample) -> Reading {
    let turns = Turns::from_bits(sample.phase.wrapping_add(sample.lead[0]));
    Reading {
        tick: sample.tick,
        turns: turns.to_num(),
        steps: sample.steps[0],
        index_count: sample.index_count,
    }
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
