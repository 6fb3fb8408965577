//! Checks of programs, on a thread of their own, one at a time. They take time, and a stop must not wait for them.

use std::sync::mpsc::{Receiver, Sender};

use cophase_core::settings::Settings;
use cophase_scene::load;
use host_sim::checked::Checked;

use super::bench::Job;
use super::request::{Pending, Request};
use crate::link::stops::Stops;
use crate::link::write;

/// Checks programs as `cophase link load` checks them, and passes those without an error to the bench.
pub(super) fn run(
    waiting: &Receiver<Pending>,
    settings: &Settings,
    stops: &Stops,
    jobs: &Sender<Job>,
) {
    for mut pending in waiting {
        if let Err(error) = pending
            .order
            .check(stops)
            .and_then(|()| check(&mut pending.request, settings))
        {
            pending.answer(Err(error));
        } else if jobs.send(Job::Request(pending)).is_err() {
            return;
        }
    }
}

fn check(request: &mut Request, settings: &Settings) -> Result<(), String> {
    const NAME: &str = "the program";
    if let Request::Load { text, program } = request {
        let checked = load::parse(text)
            .and_then(Checked::new)
            .map_err(|error| error.in_file(NAME).to_string())?;
        *program = write::program_file(NAME, &checked.settings, settings)
            .map_err(|error| error.to_string())?;
    }
    Ok(())
}
