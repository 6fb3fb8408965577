//! Commands that move or stop the machine.

use std::io::{BufRead, IsTerminal, Write};
use std::time::{Duration, Instant};

use cophase_core::supervisor::State;
use cophase_link::message::{Event, Identity, Request, StopKind};

use super::Problem;
use super::args::{Action, LinkArgs, StartArgs};
use super::connection::{Connection, Incoming};
use super::error::LinkError;
use super::show::describe;
use crate::{Status, signals};

/// Time between two requests of a jog: less than half the duration of one request.
pub(super) const JOG_EVERY: Duration = Duration::from_millis(200);

/// Carries out a command.
pub(super) fn operate(
    action: &Action,
    args: &LinkArgs,
    link: &mut Connection,
    identity: &Identity,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, Problem> {
    if let Action::Stop(stop) = action {
        let kind = if stop.now {
            StopKind::Now
        } else {
            StopKind::AtPhase
        };
        link.repeatable("stop", &Request::Stop(kind))?;
        return Ok(Status::Done);
    }
    link.take_control(args.take_over)?;
    match action {
        Action::Start(start) => {
            confirm(start.yes, "runs its program", err)?;
            return begin_and_wait(link, "start", &Request::Start, start, identity, out);
        }
        Action::Home(home) => {
            confirm(home.yes, "homes", err)?;
            return begin_and_wait(link, "home", &Request::Home, home, identity, out);
        }
        Action::Jog(jog) => {
            confirm(jog.yes, "turns at homing speed", err)?;
            let next = next_event(link)?;
            begin(link, "jog", &Request::Jog)?;
            let end = Instant::now() + Duration::from_secs_f64(jog.for_s);
            while Instant::now() + JOG_EVERY < end {
                // Frames in between show the controller that this host is connected.
                link.wait(JOG_EVERY)?;
                link.command("jog", &Request::Jog)?;
            }
            return wait(link, identity, next, out);
        }
        Action::Hold => link.repeatable("hold", &Request::Hold)?,
        Action::Resume => link.repeatable("resume", &Request::Resume)?,
        Action::Reset => link.command("reset", &Request::Reset)?,
        Action::Override(change) => {
            let permille = change.permille;
            link.repeatable("override", &Request::Override { permille })?;
        }
        _ => {}
    }
    Ok(Status::Done)
}

/// Asks the operator before the machine moves.
pub(super) fn confirm(yes: bool, what: &str, err: &mut impl Write) -> Result<(), Problem> {
    if yes {
        return Ok(());
    }
    let input = std::io::stdin();
    if !input.is_terminal() {
        let problem =
            format!("the machine {what}: give --yes, as there is no terminal to confirm it");
        return Err(LinkError::Input(problem).into());
    }
    write!(err, "The machine {what}. Keep clear. Continue? [y/N] ")?;
    err.flush()?;
    let mut answer = String::new();
    input.lock().read_line(&mut answer)?;
    if matches!(answer.trim(), "y" | "Y" | "yes") {
        Ok(())
    } else {
        Err(LinkError::Input("not confirmed; nothing was started".to_owned()).into())
    }
}

/// Arms the machine, and begins a motion.
pub(super) fn begin(
    link: &mut Connection,
    name: &'static str,
    request: &Request<'_>,
) -> Result<(), LinkError> {
    match link.repeatable("arm", &Request::Arm) {
        // The motion's own refusal has its name, its reason and its remedy.
        Err(LinkError::Refused { .. } | LinkError::NotNow { .. }) => link.command(name, request),
        armed => {
            armed?;
            let begun = link.command(name, request);
            if begun.is_err() {
                // A motion that is refused must not leave the machine armed for another.
                link.repeatable("disarm", &Request::Disarm)?;
            }
            begun
        }
    }
}

/// Begins a motion, and waits for its end if that is requested.
fn begin_and_wait(
    link: &mut Connection,
    name: &'static str,
    request: &Request<'_>,
    args: &StartArgs,
    identity: &Identity,
    out: &mut impl Write,
) -> Result<Status, Problem> {
    let next = next_event(link)?;
    begin(link, name, request)?;
    if args.wait || link.is_simulated() {
        return wait(link, identity, next, out);
    }
    Ok(Status::Done)
}

/// Returns the number of the next event.
fn next_event(link: &mut Connection) -> Result<u32, LinkError> {
    Ok(link.events(0)?.last().map_or(0, |event| event.number + 1))
}

/// Longest time until Ctrl-C is answered.
const ANSWER_WITHIN: Duration = Duration::from_millis(200);

/// Time between two requests for events that were lost on the line.
const EVENTS_EVERY: Duration = Duration::from_secs(1);

/// Shows events from a number on until the machine rests again, or until Ctrl-C.
fn wait(
    link: &mut Connection,
    identity: &Identity,
    mut next: u32,
    out: &mut impl Write,
) -> Result<Status, Problem> {
    let is_interrupted = signals::catch_interrupt();
    let mut requested = Instant::now();
    loop {
        if is_interrupted() {
            let what = if link.is_simulated() {
                "The simulated machine ends with this command."
            } else {
                "The machine goes on, unless its settings stop it when its host is gone. To stop it, use `cophase link stop`, or its STOP input."
            };
            writeln!(out, "{what}")?;
            return Ok(Status::Interrupted);
        }
        let records = match link.next(ANSWER_WITHIN)? {
            Some(Incoming::Event(record)) if record.number == next => vec![record],
            Some(Incoming::Status(_) | Incoming::Samples(_)) => continue,
            None if requested.elapsed() < EVENTS_EVERY => continue,
            // An event was lost on the line, or there was none.
            _ => {
                requested = Instant::now();
                link.events(next)?
            }
        };
        for record in records {
            next = record.number + 1;
            writeln!(out, "{}", describe(&record, identity.tick_hz))?;
            if let Event::State(state) = record.event {
                match State::ALL.get(usize::from(state)) {
                    Some(State::Parked) => return Ok(Status::Done),
                    Some(State::Fault | State::Idle) => return Ok(Status::Fault),
                    _ => {}
                }
            }
        }
    }
}
