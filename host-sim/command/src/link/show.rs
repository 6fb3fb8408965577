//! Reports of a controller as text.

use std::io::Write;
use std::time::{Duration, Instant};

use cophase_core::supervisor::State;
use cophase_files::report;
use cophase_link::message::{
    Control, Event, EventRecord, FaultRecord, Identity, Request, Status as MachineStatus,
    state_name,
};
use cophase_link::sample::flags;

use super::Problem;
use super::args::MonitorArgs;
use super::connection::{Connection, Incoming};
use super::ports::{self, Device, Port};
use crate::{CommandError, Status};

/// Time between two statuses of the monitor, ms.
const STATUS_MS: u16 = 200;

pub(super) fn list(out: &mut impl Write) -> Result<Status, CommandError> {
    let ports = ports::ports().map_err(CommandError::Input)?;
    if ports.is_empty() {
        writeln!(out, "There are no serial ports.")?;
    }
    for Port { name, device } in ports {
        let what = match device {
            Device::Controller(serial) => format!("Cophase controller, serial number {serial}"),
            Device::SameId(product) | Device::Other(product) => product,
        };
        writeln!(out, "{name:<20} {what}")?;
    }
    Ok(Status::Done)
}

pub(super) fn identity(identity: &Identity, out: &mut impl Write) -> std::io::Result<()> {
    let Identity {
        version,
        board,
        serial,
        firmware,
        settings,
        settings_crc,
        program_crc,
        axes,
        tick_hz,
        can_run,
        only_axis,
        restarts: _,
    } = identity;
    writeln!(out, "board      {board}, serial number {serial:016x}")?;
    writeln!(out, "firmware   {firmware}, link protocol {version}")?;
    writeln!(out, "settings   {settings}, CRC-32 {settings_crc:08x}")?;
    writeln!(out, "program    CRC-32 {program_crc:08x}")?;
    writeln!(out, "axes       {axes}, {tick_hz} ticks a second")?;
    if let Some(axis) = only_axis {
        writeln!(
            out,
            "Only axis {axis} of the settings runs, for bring-up. `cophase link restart` ends that."
        )?;
    }
    if !can_run {
        writeln!(
            out,
            "The settings cannot run: load other ones. `cophase link log` has the reason."
        )?;
    }
    Ok(())
}

pub(super) fn counters(link: &mut Connection, out: &mut impl Write) -> Result<(), Problem> {
    let counters = link.counters()?;
    let rows = [
        ("frames received", counters.received.good),
        ("frames damaged", counters.received.bad),
        ("frames missing", counters.received.missing),
        ("requests refused", counters.refused),
        ("messages not sent", counters.not_sent),
        ("samples lost", counters.samples_lost),
        ("deadlines missed", counters.missed_deadlines),
        ("deadlines met late", counters.late_deadlines),
    ];
    for (name, count) in rows {
        writeln!(out, "{name:<20} {count}")?;
    }
    Ok(())
}

pub(super) fn log(
    link: &mut Connection,
    identity: &Identity,
    out: &mut impl Write,
) -> Result<(), Problem> {
    let events = link.events(0)?;
    if events.is_empty() {
        writeln!(out, "No event since power-up.")?;
    }
    for record in &events {
        writeln!(out, "{}", describe(record, identity.tick_hz))?;
    }
    Ok(())
}

/// Shows statuses and events until the time is over, or forever if no time is given.
pub(super) fn monitor(
    link: &mut Connection,
    identity: &Identity,
    args: &MonitorArgs,
    out: &mut impl Write,
) -> Result<Status, Problem> {
    let period_ms = STATUS_MS;
    link.repeatable("monitor", &Request::StreamStatus { period_ms })?;
    let end = args
        .for_s
        .map(|s| Instant::now() + Duration::from_secs_f64(s));
    let mut in_fault = false;
    while end.is_none_or(|end| Instant::now() < end) {
        match link.next(Duration::from_millis(100))? {
            Some(Incoming::Status(status)) => {
                in_fault = status.flags & flags::FAULT != 0;
                writeln!(out, "{}", line(&status, identity.tick_hz))?;
            }
            Some(Incoming::Event(record)) => {
                writeln!(out, "{}", describe(&record, identity.tick_hz))?;
            }
            Some(Incoming::Samples(_)) | None => {}
        }
        out.flush()?;
    }
    Ok(if in_fault {
        Status::Fault
    } else {
        Status::Done
    })
}

/// Returns one line of the monitor.
fn line(status: &MachineStatus, tick_hz: u32) -> String {
    let t_s = f64::from(status.tick) / f64::from(tick_hz);
    let worst = status
        .phase_error_deg
        .iter()
        .copied()
        .fold(0.0, |worst: f32, error| {
            if error.abs() > worst.abs() {
                error
            } else {
                worst
            }
        });
    let mut notes = Vec::new();
    if status.flags & flags::ENABLE == 0 {
        notes.push("enable open");
    }
    if status.flags & flags::STOP != 0 {
        notes.push("stop input");
    }
    if status.flags & flags::HOLDING != 0 {
        notes.push("hold");
    }
    if status.flags & flags::DRIVES != 0 && status.state == State::Fault as u8 {
        notes.push("drives hold");
    }
    if status.armed {
        notes.push("armed");
    }
    match status.control {
        Control::You => notes.push("in control"),
        Control::Other => notes.push("another host in control"),
        Control::Free => {}
    }
    format!(
        "{t_s:10.3} s  {:<7} amax {:8.2} m/s²  {:6.2} rev/s  worst phase error {worst:+.3}°  override {} %  {}",
        state_name(status.state),
        status.amax_mps2,
        status.speed_hz,
        f32::from(status.override_permille) / 10.0,
        notes.join(", "),
    )
}

/// Returns an event with its time, as one line.
pub(super) fn describe(record: &EventRecord, tick_hz: u32) -> String {
    let t_s = f64::from(record.tick) / f64::from(tick_hz);
    format!("{t_s:10.3} s  {}", what(&record.event))
}

/// Returns an event in words.
pub(crate) fn what(event: &Event) -> String {
    let fault = |record: &FaultRecord| match record.fault() {
        Some(fault) => report::fault_words(&fault),
        None => "unknown; use the `cophase` of the firmware's version".to_owned(),
    };
    match event {
        Event::State(state) => state_name(*state).to_owned(),
        Event::Fault(record) => format!("fault: {}", fault(record)),
        Event::Reported(record) => format!("reported: {}", fault(record)),
        Event::Missed(all) => format!("{all} deadlines missed so far"),
        Event::Late(all) => format!("{all} deadlines met late so far"),
        Event::Lost(count) => format!("{count} events lost before the next"),
        Event::Refused(record) => match record.command() {
            Some(refused) => format!("refused: {}", report::refused_words(&refused)),
            None => "refused: unknown; use the `cophase` of the firmware's version".to_owned(),
        },
    }
}
