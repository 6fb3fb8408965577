//! Requests and their replies over a line, and the messages in between.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

use cophase_link::client::Client;
use cophase_link::frame::{FrameCounts, MAX_FRAME_BYTES};
use cophase_link::message::{
    ControlRequest, Counters, EventRecord, File, Identity, Inputs, Message, Refusal, ReplyBody,
    Request, Status, VERSION,
};
use cophase_link::sample::Channels;

use super::transport::Transport;

/// Time for which a reply is waited for. A flash erase takes up to 0.4 s.
const REPLY_WAIT: Duration = Duration::from_millis(1500);

/// Times that a request without an effect is sent again.
const RETRIES: u32 = 2;

/// Time between two attempts to reach a controller that restarts.
const RESTART_EVERY: Duration = Duration::from_millis(100);

/// Time within which a controller that restarts answers again.
const RESTART_WAIT: Duration = Duration::from_secs(10);

#[derive(Debug, thiserror::Error)]
pub(super) enum LinkError {
    #[error("{request}: refused: {refusal}")]
    Refused {
        request: &'static str,
        refusal: Box<Refusal>,
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

/// Message that is no reply.
#[derive(Clone, Debug)]
pub(super) enum Incoming {
    Status(Status),
    Event(EventRecord),
    Samples {
        tick: u32,
        every: u16,
        channels: Channels,
        packet: Vec<u8>,
    },
}

/// Reply whose bytes are its own.
enum Reply {
    Done,
    Identity(Identity),
    Chunk { length: u32, bytes: Vec<u8> },
    Counters(Counters),
    Events(Vec<EventRecord>),
    Inputs(Inputs),
}

pub(super) struct Connection {
    transport: Box<dyn Transport>,
    client: Client,
    replies: VecDeque<(u16, Result<Reply, Refusal>)>,
    incoming: VecDeque<Incoming>,
}

impl Connection {
    pub(super) fn new(transport: Box<dyn Transport>) -> Self {
        Self {
            transport,
            client: Client::new(),
            replies: VecDeque::new(),
            incoming: VecDeque::new(),
        }
    }

    pub(super) fn is_simulated(&self) -> bool {
        self.transport.is_simulated()
    }

    /// Frames of the controller so far.
    pub(super) const fn frames(&self) -> FrameCounts {
        self.client.counts()
    }

    pub(super) fn identify(&mut self) -> Result<Identity, LinkError> {
        // Ends what may be left of a frame on the line.
        self.transport.send(&[0])?;
        match self.request("identify", &Request::Identify { version: VERSION }, RETRIES)? {
            Reply::Identity(identity) => Ok(identity),
            _ => Err(LinkError::Unexpected("identify")),
        }
    }

    /// Makes a request that has an effect: it is sent once.
    pub(super) fn command(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
    ) -> Result<(), LinkError> {
        self.done(name, request, 0)
    }

    /// Makes a request that may be repeated.
    pub(super) fn repeatable(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
    ) -> Result<(), LinkError> {
        self.done(name, request, RETRIES)
    }

    fn done(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
        retries: u32,
    ) -> Result<(), LinkError> {
        match self.request(name, request, retries)? {
            Reply::Done => Ok(()),
            _ => Err(LinkError::Unexpected(name)),
        }
    }

    pub(super) fn take_control(&mut self, by_force: bool) -> Result<(), LinkError> {
        let request = if by_force {
            ControlRequest::TakeOver
        } else {
            ControlRequest::Take
        };
        self.repeatable("control", &Request::Control(request))
    }

    pub(super) fn counters(&mut self) -> Result<Counters, LinkError> {
        match self.request("counters", &Request::Counters, RETRIES)? {
            Reply::Counters(counters) => Ok(counters),
            _ => Err(LinkError::Unexpected("counters")),
        }
    }

    /// Events from a number on, as far as the controller still has them.
    pub(super) fn events(&mut self, first: u32) -> Result<Vec<EventRecord>, LinkError> {
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

    pub(super) fn read_file(&mut self, file: File) -> Result<Vec<u8>, LinkError> {
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

    pub(super) fn write_file(&mut self, file: File, bytes: &[u8]) -> Result<(), LinkError> {
        let length = bytes.len() as u32;
        let crc = cophase_link::checksum(bytes);
        self.repeatable("load", &Request::BeginWrite { file, length, crc })?;
        let chunks = bytes.chunks(cophase_link::message::MAX_CHUNK_BYTES);
        let mut offset = 0;
        for bytes in chunks {
            self.repeatable("load", &Request::Write { offset, bytes })?;
            offset += bytes.len() as u32;
        }
        self.command("load", &Request::FinishWrite)
    }

    pub(super) fn inputs(&mut self) -> Result<Inputs, LinkError> {
        match self.request("inputs", &Request::Inputs, RETRIES)? {
            Reply::Inputs(inputs) => Ok(inputs),
            _ => Err(LinkError::Unexpected("inputs")),
        }
    }

    /// Restarts the controller by a request, and waits until it answers again.
    pub(super) fn restart(
        &mut self,
        before: &Identity,
        request: &Request<'_>,
    ) -> Result<Identity, LinkError> {
        self.command("restart", request)?;
        let end = Instant::now() + RESTART_WAIT;
        loop {
            std::thread::sleep(RESTART_EVERY);
            self.client = Client::new();
            let identity = if self.transport.reopen() {
                self.identify()
            } else {
                Err(LinkError::NoReply("restart"))
            };
            // It answers once more before it goes, and its line may be lost then.
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

    /// Next message that is no reply, within a time.
    pub(super) fn next(&mut self, within: Duration) -> Result<Option<Incoming>, LinkError> {
        let end = Instant::now() + within;
        loop {
            if let Some(incoming) = self.incoming.pop_front() {
                return Ok(Some(incoming));
            }
            if Instant::now() >= end {
                return Ok(None);
            }
            self.read()?;
        }
    }

    fn request(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
        retries: u32,
    ) -> Result<Reply, LinkError> {
        for _ in 0..=retries {
            let mut frame = [0; MAX_FRAME_BYTES];
            let (number, length) = self
                .client
                .request(request, &mut frame)
                .ok_or(LinkError::Unexpected(name))?;
            self.transport.send(&frame[..length])?;
            let end = Instant::now() + REPLY_WAIT;
            while Instant::now() < end {
                let place = self.replies.iter().position(|(to, _)| *to == number);
                if let Some((_, reply)) = place.and_then(|place| self.replies.remove(place)) {
                    // Replies to earlier requests came too late.
                    self.replies.clear();
                    return reply.map_err(|refusal| LinkError::Refused {
                        request: name,
                        refusal: Box::new(refusal),
                    });
                }
                self.read()?;
            }
        }
        Err(LinkError::NoReply(name))
    }

    /// Reads what has arrived.
    fn read(&mut self) -> Result<(), LinkError> {
        let mut buffer = [0; 4096];
        let count = self.transport.receive(&mut buffer)?;
        for &byte in &buffer[..count] {
            let Some(message) = self.client.push(byte) else {
                continue;
            };
            match message {
                Message::Reply { to, body } => {
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
                    self.replies.push_back((to, body));
                }
                Message::Status(status) => self.incoming.push_back(Incoming::Status(status)),
                Message::Event(event) => self.incoming.push_back(Incoming::Event(event)),
                Message::Samples {
                    tick,
                    every,
                    channels,
                    packet,
                    ..
                } => self.incoming.push_back(Incoming::Samples {
                    tick,
                    every,
                    channels,
                    packet: packet.to_vec(),
                }),
            }
        }
        Ok(())
    }
}
