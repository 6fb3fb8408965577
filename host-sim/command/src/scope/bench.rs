//! Bench: passes messages between the controller and all browsers.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

use cophase_core::settings::Settings;
use cophase_link::message::{
    Control, ControlRequest, EventRecord, Identity, Request as LinkRequest, Status,
};
use cophase_link::server::EVENTS;

use super::browsers::{Browser, Browsers};
use super::columns::{Batch, CHANNELS, Columns};
use super::report::Report;
use super::request::Pending;
use super::{ScopeArgs, scene};
use crate::link::connection::{Connection, Incoming};
use crate::link::error::LinkError;
use crate::link::write;

/// Job from a browser. Few wait at the same time: a browser has one request under way, and its place is taken until it has left.
#[derive(Debug)]
pub(super) enum Job {
    Joined(Browser),
    Left(u32),
    Request(Pending),
}

/// Time between two statuses of the controller, ms.
const STATUS_MS: u16 = 50;

/// Longest time for which samples wait to be sent: a frame of the page.
const BATCH: Duration = Duration::from_millis(16);

/// Longest wait for a message of the controller, after which the browsers have their turn.
const TURN: Duration = Duration::from_millis(2);

/// Time between two attempts to reach a controller that was lost.
const REOPEN: Duration = Duration::from_millis(500);

pub(super) struct Bench {
    pub(super) link: Connection,
    pub(super) identity: Identity,
    pub(super) settings: Settings,
    columns: Columns,
    batch: Batch,
    every: u16,
    pub(super) text: String,
    pub(super) browsers: Browsers,
    /// Latest events since the restart, for browsers that join.
    events: VecDeque<EventRecord>,
    /// Number of the first event since the restart.
    first_event: u32,
    /// Line that is lost, with the reason and the time of the next attempt to open it again.
    lost: Option<(String, Instant)>,
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
            events: VecDeque::new(),
            first_event: 0,
            lost: None,
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
        self.link.repeatable("samples", &samples)?;
        for record in self.link.events(self.first_event)? {
            self.report_event(record);
        }
        Ok(())
    }

    /// Passes messages on in both directions, until there can be no more browsers. A turn takes one job and the messages of one read, so
    /// that neither side keeps the other waiting.
    pub(super) fn run(&mut self, jobs: &Receiver<Job>) -> Result<(), LinkError> {
        loop {
            match jobs.try_recv() {
                Ok(job) => self.carry_out(job),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => return Ok(()),
            }
            if self.lost.is_some() {
                self.reach_again()?;
            } else if let Err(error) = self.take_messages() {
                self.lose(&error);
            }
            if self.sent.elapsed() >= BATCH {
                self.send_batch();
            }
        }
    }

    fn take_messages(&mut self) -> Result<(), LinkError> {
        let mut wait = TURN;
        while let Some(incoming) = self.link.next(wait)? {
            self.pass_on(incoming);
            wait = Duration::ZERO;
        }
        Ok(())
    }

    /// Handles a lost line: ends control, and reports the reason.
    fn lose(&mut self, error: &LinkError) {
        self.browsers.set_owner(None);
        let error = error.to_string();
        self.browsers.report(&Report::Line {
            error: Some(error.clone()),
        });
        self.lost = Some((error, Instant::now()));
    }

    /// Waits for the same controller, with an attempt from time to time.
    fn reach_again(&mut self) -> Result<(), LinkError> {
        let Some((error, next)) = &mut self.lost else {
            return Ok(());
        };
        self.link
            .stops()
            .fail(&format!("stop: {error}; press the STOP of the machine"));
        if Instant::now() < *next {
            std::thread::sleep(TURN);
            return Ok(());
        }
        *next = Instant::now() + REOPEN;
        if !self.link.reopen() {
            return Ok(());
        }
        match self.resume() {
            Ok(()) => {
                self.lost = None;
                self.browsers.report(&Report::Line { error: None });
                Ok(())
            }
            // The controller has a line, but does not answer yet, or the line is lost again.
            Err(error) if error.is_of_line() => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Begins again with a controller whose line was lost.
    fn resume(&mut self) -> Result<(), LinkError> {
        let identity = self.link.identify()?;
        if (&identity.board, identity.serial) != (&self.identity.board, self.identity.serial)
            || identity.settings_crc != self.identity.settings_crc
        {
            let problem = "another controller, or other settings, are at the line now; start `cophase scope` again";
            return Err(LinkError::Input(problem.to_owned()));
        }
        if identity.restarts != self.identity.restarts || !self.link.is_simulated() {
            self.forget(0);
        }
        self.begin_again(identity)
    }

    /// Forgets the events before a restart, after which the first one has this number.
    pub(super) fn forget(&mut self, first_event: u32) {
        self.first_event = first_event;
        self.events.clear();
        self.browsers.report(&Report::Restarted);
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
            Incoming::Event(record) => self.report_event(record),
        }
    }

    /// Passes an event on, unless it came before, as a message or from the log.
    fn report_event(&mut self, record: EventRecord) {
        if self.events.contains(&record) {
            return;
        }
        self.browsers
            .report(&Report::event(&record, self.identity.tick_hz));
        if self.events.len() == EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(record);
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
            self.browsers.samples(bytes, count);
        }
    }

    fn carry_out(&mut self, job: Job) {
        match job {
            Job::Joined(browser) => self.welcome(browser),
            Job::Left(id) => {
                if self.browsers.leave(id) && self.lost.is_none() {
                    // If the line is lost, control ends by itself.
                    let _ = self.control(ControlRequest::Release);
                }
            }
            Job::Request(pending) => {
                let allowed = match &self.lost {
                    Some((error, _)) => Err(error.clone()),
                    None => pending.order.check(&self.link.stops()),
                };
                let done = allowed.and_then(|()| self.request(pending.browser, &pending.request));
                pending.answer(done);
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
        for record in &self.events {
            browser.report(&Report::event(record, self.identity.tick_hz));
        }
        if let Some((error, _)) = &self.lost {
            let error = Some(error.clone());
            browser.report(&Report::Line { error });
        }
        self.browsers.join(browser);
    }
}
