//! Checks of programs, on a thread of their own, one at a time. They take time, and a stop must not wait for them.

use std::sync::mpsc::{Receiver, Sender};

use cophase_core::settings::Settings;
use host_sim::scene::{Checked, load};

use super::bench::Job;
use super::request::{Asked, Request};
use crate::link::stops::Stops;
use crate::link::write;

/// Checks programs as `cophase link load` checks them, and passes those without an error to the bench.
pub(super) fn run(
    waiting: &Receiver<Asked>,
    settings: &Settings,
    stops: &Stops,
    jobs: &Sender<Job>,
) {
    for mut asked in waiting {
        if let Err(error) = asked
            .order
            .check(stops)
            .and_then(|()| check(&mut asked.request, settings))
        {
            asked.answer(Err(error));
        } else if jobs.send(Job::Request(asked)).is_err() {
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
