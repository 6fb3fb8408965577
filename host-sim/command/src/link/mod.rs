//! `cophase link`: operates a controller over a serial port or TCP, or a simulated one.

mod args;
mod bring_up;
pub(crate) mod connection;
pub(crate) mod error;
mod measure;
mod operate;
mod ports;
mod record;
mod session;
pub(crate) mod show;
pub(crate) mod stops;
mod tcp;
pub(crate) mod transport;
pub(crate) mod write;

pub(super) use args::LinkArgs;

use std::io::Write;

use args::Action;
use connection::Connection;
use transport::Faults;

use super::{CommandError, Status};

/// Carries out one action on a controller.
pub(super) fn link(
    args: &LinkArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, CommandError> {
    if let Action::List = args.action {
        return show::list(out);
    }
    let transport = transport::open(args.to.as_deref(), args.baud, Faults::OfScene)
        .map_err(CommandError::Input)?;
    let mut link = Connection::new(transport);
    match run(args, &mut link, out, err) {
        Ok(status) => Ok(status),
        Err(Problem::Link(error)) => Err(CommandError::Input(error.to_string())),
        Err(Problem::Command(error)) => Err(error),
    }
}

/// Reason why an action failed.
enum Problem {
    Link(error::LinkError),
    Command(CommandError),
}

impl From<error::LinkError> for Problem {
    fn from(error: error::LinkError) -> Self {
        Self::Link(error)
    }
}

impl From<CommandError> for Problem {
    fn from(error: CommandError) -> Self {
        Self::Command(error)
    }
}

impl From<std::io::Error> for Problem {
    fn from(error: std::io::Error) -> Self {
        Self::Command(error.into())
    }
}

fn run(
    args: &LinkArgs,
    link: &mut Connection,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Status, Problem> {
    let identity = link.identify()?;
    match &args.action {
        Action::List => {}
        Action::Identify => show::identity(&identity, out)?,
        Action::Counters => show::counters(link, out)?,
        Action::Log => show::log(link, &identity, out)?,
        Action::Monitor(monitor) => return show::monitor(link, &identity, monitor, out),
        Action::BringUp(action) => {
            return bring_up::bring_up(action, args, link, &identity, out, err);
        }
        Action::Record(record) => {
            return record::record(record, args, link, &identity, out, err);
        }
        Action::Load(load) => write::load(link, &identity, load, out)?,
        Action::Restart => {
            link.take_control(args.take_over)?;
            write::restart(link, &identity, out)?;
        }
        action => return operate::operate(action, args, link, &identity, out, err),
    }
    Ok(Status::Done)
}
