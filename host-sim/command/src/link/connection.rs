//! Requests and their replies over a line, and the messages in between.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

use cophase_core::supervisor::State;
use cophase_link::Condition;
use cophase_link::client::Client;
use cophase_link::frame::{FrameCounts, MAX_FRAME_BYTES};
use cophase_link::message::{
    ControlRequest, Counters, EventRecord, File, Identity, Inputs, Message, Refusal, ReplyBody,
    Request, Status, VERSION,
};
use cophase_link::sample::{Sample, unpack};
use host_sim::report;
use host_sim::scene::file::FaultAt;

use super::transport::Transport;

/// Longest wait for a reply. A flash erase takes up to 0.4 s.
const REPLY_WAIT: Duration = Duration::from_millis(1500);

/// Longest time without a frame while the host waits for messages: half of the shortest host timeout that settings may have.
const ALIVE_EVERY: Duration = Duration::from_millis(50);

/// Number of times that a request without an effect is sent again.
const RETRIES: u32 = 2;

/// Time between two attempts to reach a controller that restarts.
const RESTART_EVERY: Duration = Duration::from_millis(100);

/// Time within which a controller that restarts answers again.
const RESTART_WAIT: Duration = Duration::from_secs(10);

#[derive(Debug, thiserror::Error)]
pub(crate) enum LinkError {
    #[error("{request}: refused: {refusal}")]
    Refused {
        request: &'static str,
        refusal: Box<Refusal>,
    },
    #[error("{request}: refused: {refusal}; it is possible {remedy}")]
    NotNow {
        request: &'static str,
        refusal: Box<Refusal>,
        remedy: String,
    },
    #[error("{0}: no reply; check that the port is that of a controller, and the baud rate")]
    NoReply(&'static str),
    #[error(
        "{0}: the controller sent another reply than requested; use the `cophase` of the firmware's version"
    )]
    Unexpected(&'static str),
    #[error("the line is lost: {0}; connect the controller again")]
    Line(#[from] io::Error),
    #[error("{0}")]
    Input(String),
}

impl LinkError {
    /// Adds the remedy to a refusal that depends on the state of the machine.
    fn with_remedy(self, condition: Condition) -> Self {
        match self {
            Self::Refused { request, refusal } if matches!(*refusal, Refusal::State { .. }) => {
                Self::NotNow {
                    request,
                    refusal,
                    remedy: remedy(condition),
                }
            }
            other => other,
        }
    }
}

/// Returns when a request of this condition is possible, and how the machine gets there.
fn remedy(condition: Condition) -> String {
    match condition {
        Condition::Command(command) => report::remedy(command.states()),
        Condition::In(states) => report::remedy(states.iter().copied()),
        Condition::DrivesOff => {
            format!(
                "while the drives are off: {}",
                report::remedy([State::Idle])
            )
        }
    }
}

/// Message that is not a reply.
#[derive(Clone, Debug)]
pub(crate) enum Incoming {
    Status(Status),
    Event(EventRecord),
    Samples(Vec<Sample>),
}

/// Reply that owns its bytes.
enum Reply {
    Done,
    Identity(Identity),
    Chunk { length: u32, bytes: Vec<u8> },
    Counters(Counters),
    Events(Vec<EventRecord>),
    Inputs(Inputs),
}

pub(crate) struct Connection {
    transport: Box<dyn Transport>,
    client: Client,
    /// Axes of the controller, as it identified itself.
    axes: usize,
    incoming: VecDeque<Incoming>,
    /// Time of the last frame that was sent.
    sent: Instant,
    /// Number of the request whose reply is awaited. Other requests only show that this host is connected.
    awaited: Option<u16>,
    /// Reply to the awaited request, once it has arrived.
    reply: Option<Result<Reply, Refusal>>,
}

impl Connection {
    pub(crate) fn new(transport: Box<dyn Transport>) -> Self {
        Self {
            transport,
            client: Client::new(),
            axes: 0,
            incoming: VecDeque::new(),
            sent: Instant::now(),
            awaited: None,
            reply: None,
        }
    }

    pub(crate) fn is_simulated(&self) -> bool {
        self.transport.is_simulated()
    }

    /// Returns the counts of frames from the controller so far.
    pub(super) const fn frames(&self) -> FrameCounts {
        self.client.counts()
    }

    pub(crate) fn identify(&mut self) -> Result<Identity, LinkError> {
        // Ends a partial frame that may be left on the line.
        self.transport.send(&[0])?;
        match self.request("identify", &Request::Identify { version: VERSION }, RETRIES)? {
            Reply::Identity(identity) => {
                self.axes = identity.axes.into();
                Ok(identity)
            }
            _ => Err(LinkError::Unexpected("identify")),
        }
    }

    /// Injects a fault into a simulated machine.
    pub(crate) fn inject(&mut self, fault: &FaultAt) -> Result<(), LinkError> {
        self.transport.inject(fault).map_err(LinkError::Input)
    }

    /// Makes a request that has an effect: it is sent once.
    pub(crate) fn command(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
    ) -> Result<(), LinkError> {
        self.done(name, request, request.condition(), 0)
    }

    /// Makes a request that may be repeated.
    pub(crate) fn repeatable(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
    ) -> Result<(), LinkError> {
        self.done(name, request, request.condition(), RETRIES)
    }

    fn done(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
        condition: Condition,
        retries: u32,
    ) -> Result<(), LinkError> {
        match self.request(name, request, retries) {
            Ok(Reply::Done) => Ok(()),
            Ok(_) => Err(LinkError::Unexpected(name)),
            Err(error) => Err(error.with_remedy(condition)),
        }
    }

    pub(crate) fn take_control(&mut self, by_force: bool) -> Result<(), LinkError> {
        let request = if by_force {
            ControlRequest::TakeOver
        } else {
            ControlRequest::Take
        };
        self.repeatable("control", &Request::Control(request))
    }

    pub(crate) fn counters(&mut self) -> Result<Counters, LinkError> {
        match self.request("counters", &Request::Counters, RETRIES)? {
            Reply::Counters(counters) => Ok(counters),
            _ => Err(LinkError::Unexpected("counters")),
        }
    }

    /// Returns the events from a number on that the controller still has.
    pub(crate) fn events(&mut self, first: u32) -> Result<Vec<EventRecord>, LinkError> {
        let mut all: Vec<EventRecord> = Vec::new();
        loop {
            let from = all.last().map_or(first, |event| event.number + 1);
            match self.request("log", &Request::Events { from }, RETRIES)? {
                Reply::Events(events) if events.is_empty() => return Ok(all),
                Reply::Events(events) => all.extend(events),
                _ => return Err(LinkError::Unexpected("log")),
            }
        }
    }

    pub(crate) fn read_file(&mut self, file: File) -> Result<Vec<u8>, LinkError> {
        let mut all = Vec::new();
        loop {
            let offset = all.len() as u32;
            match self.request("read", &Request::Read { file, offset }, RETRIES)? {
                Reply::Chunk { length, bytes } => {
                    let is_last = bytes.is_empty() || offset + bytes.len() as u32 >= length;
                    all.extend(bytes);
                    if is_last {
                        return Ok(all);
                    }
                }
                _ => return Err(LinkError::Unexpected("read")),
            }
        }
    }

    pub(crate) fn write_file(&mut self, file: File, bytes: &[u8]) -> Result<(), LinkError> {
        let length = bytes.len() as u32;
        let crc = cophase_link::checksum(bytes);
        self.repeatable("load", &Request::BeginWrite { file, length, crc })?;
        let chunks = bytes.chunks(cophase_link::message::MAX_CHUNK_BYTES);
        let mut offset = 0;
        for bytes in chunks {
            self.repeatable("load", &Request::Write { offset, bytes })?;
            offset += bytes.len() as u32;
        }
        self.done("load", &Request::FinishWrite, file.condition(), 0)
    }

    pub(super) fn inputs(&mut self) -> Result<Inputs, LinkError> {
        match self.request("inputs", &Request::Inputs, RETRIES)? {
            Reply::Inputs(inputs) => Ok(inputs),
            _ => Err(LinkError::Unexpected("inputs")),
        }
    }

    /// Restarts the controller by a request, and waits until it answers again.
    pub(crate) fn restart(
        &mut self,
        before: &Identity,
        request: &Request<'_>,
    ) -> Result<Identity, LinkError> {
        self.command("restart", request)?;
        let end = Instant::now() + RESTART_WAIT;
        loop {
            std::thread::sleep(RESTART_EVERY);
            let identity = if self.reopen() {
                self.identify()
            } else {
                Err(LinkError::NoReply("restart"))
            };
            // The controller may answer once more before it restarts. Its line may be lost then.
            let is_over = identity
                .as_ref()
                .is_ok_and(|identity| identity.restarts != before.restarts);
            if is_over {
                return identity;
            }
            if Instant::now() > end {
                return Err(LinkError::NoReply("restart"));
            }
        }
    }

    /// Opens the line again; false if the controller is not there yet.
    pub(crate) fn reopen(&mut self) -> bool {
        self.client = Client::new();
        // Earlier messages belong to another session.
        self.awaited = None;
        self.reply = None;
        self.incoming.clear();
        self.transport.reopen()
    }

    /// Returns the next message that is not a reply, within a time.
    pub(crate) fn next(&mut self, within: Duration) -> Result<Option<Incoming>, LinkError> {
        let end = Instant::now() + within;
        loop {
            if let Some(incoming) = self.incoming.pop_front() {
                return Ok(Some(incoming));
            }
            if Instant::now() >= end {
                return Ok(None);
            }
            self.keep_alive()?;
            self.read()?;
        }
    }

    /// Waits for a time, and keeps the messages that arrive.
    pub(super) fn wait(&mut self, time: Duration) -> Result<(), LinkError> {
        let end = Instant::now() + time;
        while Instant::now() < end {
            self.keep_alive()?;
            self.read()?;
        }
        Ok(())
    }

    /// Sends a frame if there was none for a while: settings may require that the host that started the machine stays connected.
    fn keep_alive(&mut self) -> Result<(), LinkError> {
        if self.sent.elapsed() >= ALIVE_EVERY {
            self.send("alive", &Request::Counters)?;
        }
        Ok(())
    }

    /// Sends a request, and returns its number.
    fn send(&mut self, name: &'static str, request: &Request<'_>) -> Result<u16, LinkError> {
        let mut frame = [0; MAX_FRAME_BYTES];
        let (number, length) = self
            .client
            .request(request, &mut frame)
            .ok_or(LinkError::Unexpected(name))?;
        self.transport.send(&frame[..length])?;
        self.sent = Instant::now();
        Ok(number)
    }

    fn request(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
        retries: u32,
    ) -> Result<Reply, LinkError> {
        for _ in 0..=retries {
            let number = self.send(name, request)?;
            self.awaited = Some(number);
            let end = Instant::now() + REPLY_WAIT;
            while Instant::now() < end {
                if let Some(reply) = self.reply.take() {
                    return reply.map_err(|refusal| LinkError::Refused {
                        request: name,
                        refusal: Box::new(refusal),
                    });
                }
                self.keep_alive()?;
                self.read()?;
            }
        }
        Err(LinkError::NoReply(name))
    }

    /// Reads the bytes that have arrived, and handles their messages.
    fn read(&mut self) -> Result<(), LinkError> {
        let mut buffer = [0; 4096];
        let count = self.transport.receive(&mut buffer)?;
        for &byte in &buffer[..count] {
            let Some(message) = self.client.push(byte) else {
                continue;
            };
            match message {
                Message::Reply { to, .. } if self.awaited != Some(to) => {}
                Message::Reply { body, .. } => {
                    let body = body.map(|body| match body {
                        ReplyBody::Done => Reply::Done,
                        ReplyBody::Identity(identity) => Reply::Identity(identity),
                        ReplyBody::Chunk { length, bytes } => Reply::Chunk {
                            length,
                            bytes: bytes.to_vec(),
                        },
                        ReplyBody::Counters(counters) => Reply::Counters(counters),
                        ReplyBody::Events(events) => Reply::Events(events.to_vec()),
                        ReplyBody::Inputs(inputs) => Reply::Inputs(inputs),
                    });
                    self.awaited = None;
                    self.reply = Some(body);
                }
                Message::Status(status) => self.incoming.push_back(Incoming::Status(status)),
                Message::Event(event) => self.incoming.push_back(Incoming::Event(event)),
                Message::Samples {
                    tick,
                    every,
                    channels,
                    packet,
                    ..
                } => {
                    let samples = unpack(tick, every, channels, self.axes, packet).collect();
                    self.incoming.push_back(Incoming::Samples(samples));
                }
            }
        }
        Ok(())
    }
}
