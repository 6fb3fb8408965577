//! Bench: passes messages between the controller and all browsers.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

use cophase_core::settings::Settings;
use cophase_link::message::{Control, ControlRequest, Identity, Request as LinkRequest, Status};

use super::browsers::{Browser, Browsers};
use super::columns::{Batch, CHANNELS, Columns};
use super::report::Report;
use super::request::{Numbered, Request};
use super::{ScopeArgs, scene};
use crate::link::connection::{Connection, Incoming, LinkError};
use crate::link::write;

/// Job from a browser.
#[derive(Debug)]
pub(super) enum Job {
    Joined(Browser),
    Left(u32),
    /// A request in JSON.
    Request(u32, String),
}

impl Job {
    /// Returns true if the job stops the machine.
    fn is_stop(&self) -> bool {
        let Self::Request(_, text) = self else {
            return false;
        };
        matches!(serde_json::from_str(text), Ok(Request::Stop { .. }))
    }
}

/// Time between two statuses of the controller, ms.
const STATUS_MS: u16 = 50;

/// Longest time for which samples wait to be sent: a frame of the page.
const BATCH: Duration = Duration::from_millis(16);

/// Time between two attempts to reach a controller that was lost.
const REOPEN: Duration = Duration::from_millis(500);

pub(super) struct Bench {
    pub(super) link: Connection,
    pub(super) identity: Identity,
    settings: Settings,
    columns: Columns,
    batch: Batch,
    every: u16,
    pub(super) text: String,
    pub(super) browsers: Browsers,
    /// Number of the first event since the restart.
    pub(super) first_event: u32,
    next_tick: Option<u32>,
    lost_samples: u64,
    sent: Instant,
}

impl Bench {
    /// Begins the streams of a controller.
    pub(super) fn new(mut link: Connection, args: &ScopeArgs) -> Result<Self, LinkError> {
        let identity = link.identify()?;
        let settings = write::settings(&mut link)?;
        let text = scene::text(args, &identity).map_err(LinkError::Input)?;
        let mut bench = Self {
            columns: Columns::new(&settings),
            batch: Batch::new(args.every),
            every: args.every,
            text,
            browsers: Browsers::default(),
            first_event: 0,
            next_tick: None,
            lost_samples: 0,
            sent: Instant::now(),
            link,
            identity,
            settings,
        };
        bench.begin_streams()?;
        Ok(bench)
    }

    fn begin_streams(&mut self) -> Result<(), LinkError> {
        let period_ms = STATUS_MS;
        let statuses = LinkRequest::StreamStatus { period_ms };
        self.link.repeatable("status", &statuses)?;
        let (channels, every) = (CHANNELS, self.every);
        let samples = LinkRequest::Stream { channels, every };
        self.link.repeatable("samples", &samples)
    }

    /// Passes messages on in both directions, until there can be no more browsers.
    pub(super) fn run(&mut self, jobs: &Receiver<Job>) -> Result<(), LinkError> {
        loop {
            // A stop does not wait behind other requests.
            let mut waiting = VecDeque::new();
            loop {
                match jobs.try_recv() {
                    Ok(job) if job.is_stop() => self.carry_out(job),
                    Ok(job) => waiting.push_back(job),
                    Err(TryRecvError::Disconnected) => return Ok(()),
                    Err(TryRecvError::Empty) => match waiting.pop_front() {
                        Some(job) => self.carry_out(job),
                        None => break,
                    },
                }
            }
            match self.link.next(Duration::from_millis(2)) {
                Ok(Some(incoming)) => self.pass_on(incoming),
                Ok(None) => {}
                Err(error) => self.reach_again(&error)?,
            }
            if self.sent.elapsed() >= BATCH {
                self.send_batch();
            }
        }
    }

    /// Handles a lost line: ends control, and waits for the same controller.
    fn reach_again(&mut self, error: &LinkError) -> Result<(), LinkError> {
        self.browsers.set_owner(None);
        let error = Some(error.to_string());
        self.browsers.report(&Report::Line { error });
        while !self.link.reopen() {
            std::thread::sleep(REOPEN);
        }
        let identity = loop {
            match self.link.identify() {
                Ok(identity) => break identity,
                // The controller has a line, but does not answer yet, or the line is lost again.
                Err(LinkError::NoReply(_) | LinkError::Line(_)) => {
                    std::thread::sleep(REOPEN);
                    while !self.link.reopen() {
                        std::thread::sleep(REOPEN);
                    }
                }
                Err(error) => return Err(error),
            }
        };
        if (&identity.board, identity.serial) != (&self.identity.board, self.identity.serial)
            || identity.settings_crc != self.identity.settings_crc
        {
            let problem = "another controller, or other settings, are at the line now; start `cophase scope` again";
            return Err(LinkError::Input(problem.to_owned()));
        }
        if identity.restarts != self.identity.restarts || !self.link.is_simulated() {
            self.first_event = 0;
            self.browsers.report(&Report::Restarted);
        }
        self.begin_again(identity)?;
        self.browsers.report(&Report::Line { error: None });
        Ok(())
    }

    /// Begins the streams of a controller that identified itself again.
    pub(super) fn begin_again(&mut self, identity: Identity) -> Result<(), LinkError> {
        self.identity = identity;
        self.next_tick = None;
        self.columns.restart();
        self.begin_streams()
    }

    fn pass_on(&mut self, incoming: Incoming) {
        match incoming {
            Incoming::Samples(samples) => {
                for sample in samples {
                    let every = u32::from(self.every);
                    let expected = self.next_tick.unwrap_or(sample.tick);
                    let gap = sample.tick.wrapping_sub(expected);
                    self.lost_samples += u64::from(gap / every);
                    self.next_tick = Some(sample.tick.wrapping_add(every));
                    if !self.batch.is_next(sample.tick) {
                        self.send_batch();
                    }
                    let row = self.columns.row(&sample);
                    self.batch.push(sample.tick, row);
                }
            }
            Incoming::Status(status) => self.report_status(&status),
            Incoming::Event(record) => {
                let tick_hz = self.identity.tick_hz;
                self.browsers.report(&Report::event(&record, tick_hz));
            }
        }
    }

    fn report_status(&mut self, status: &Status) {
        if status.control == Control::Other {
            self.browsers.set_owner(None);
        }
        let name = self.browsers.owner_name();
        let owner = (self.browsers.owner(), name.as_deref());
        let count = self.browsers.count();
        for browser in self.browsers.iter_mut() {
            let report = Report::status(
                status,
                self.identity.tick_hz,
                owner,
                browser,
                self.lost_samples,
                count,
            );
            browser.report(&report);
        }
    }

    pub(super) fn send_batch(&mut self) {
        self.sent = Instant::now();
        if let Some((bytes, count)) = self.batch.take() {
            self.browsers.samples(&bytes, count);
        }
    }

    fn carry_out(&mut self, job: Job) {
        match job {
            Job::Joined(browser) => self.welcome(browser),
            Job::Left(id) => {
                if self.browsers.leave(id) {
                    // If the line is lost, control ends by itself.
                    let _ = self.control(ControlRequest::Release);
                }
            }
            Job::Request(id, text) => {
                // The reply to an invalid request has its number, too.
                let number = serde_json::from_str(&text).map_or(0, |Numbered { id }| id);
                let done = match serde_json::from_str(&text) {
                    Ok(request) => self.request(id, &request),
                    Err(error) => Err(format!("the request is not understood: {error}")),
                };
                if let Some(browser) = self.browsers.find(id) {
                    browser.report(&Report::Reply {
                        id: number,
                        error: done.err(),
                    });
                }
            }
        }
    }

    /// Sends a new browser all constant data, and the events so far.
    fn welcome(&mut self, mut browser: Browser) {
        // The waiting batch began before the browser joined.
        self.send_batch();
        browser.report(&Report::hello(
            browser.name(),
            &self.identity,
            &self.settings,
            &self.columns,
            self.every,
            self.link.is_simulated(),
            &self.text,
        ));
        // If they cannot be read, the page shows later events only.
        for record in self.link.events(self.first_event).unwrap_or_default() {
            browser.report(&Report::event(&record, self.identity.tick_hz));
        }
        self.browsers.join(browser);
    }
}
