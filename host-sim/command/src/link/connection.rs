//! Requests and their replies over a line, and the messages in between.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use cophase_core::settings::TICK_HZ;
use cophase_core::units::MAX_AXES;
use cophase_link::Condition;
use cophase_link::MAX_FILE_BYTES;
use cophase_link::client::Client;
use cophase_link::frame::{FrameCounts, MAX_FRAME_BYTES};
use cophase_link::message::{
    ControlRequest, Counters, EventRecord, File, Identity, Inputs, Message, Refusal, ReplyBody,
    Request, Status, StopKind, VERSION,
};
use cophase_link::program::MAX_PROGRAM_BYTES;
use cophase_link::sample::{Sample, unpack};
use cophase_link::server::EVENTS;
use cophase_scene::file::FaultAt;

use super::error::LinkError;
use super::stops::Stops;
use super::transport::Transport;

/// Longest wait for a reply. A flash erase takes up to 0.4 s.
const REPLY_WAIT: Duration = Duration::from_millis(1500);

/// Longest time without a frame while the host waits for messages: half of the shortest host timeout that settings may have.
const ALIVE_EVERY: Duration = Duration::from_millis(50);

/// Time after which a stop without a reply is sent again.
const STOP_AGAIN: Duration = Duration::from_millis(250);

/// Number of times that a stop is sent.
const STOP_TIMES: usize = 6;

/// Largest number of samples, and of other messages, that wait to be taken. Both exceed those that arrive while a reply is awaited.
const MAX_WAITING_SAMPLES: usize = 1 << 16;
const MAX_WAITING_MESSAGES: usize = 1 << 13;

/// Number of times that a request without an effect is sent again.
const RETRIES: u32 = 2;

/// Time between two attempts to reach a controller that restarts.
const RESTART_EVERY: Duration = Duration::from_millis(100);

/// Time within which a controller that restarts answers again.
const RESTART_WAIT: Duration = Duration::from_secs(10);

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
    /// Number of samples in `incoming`.
    waiting_samples: usize,
    stops: Arc<Stops>,
    sent_stop: Option<SentStop>,
    /// Time of the last frame that was sent.
    sent: Instant,
    /// Number of the request whose reply is awaited. Other requests only show that this host is connected.
    awaited: Option<u16>,
    /// Reply to the awaited request, once it has arrived.
    reply: Option<Result<Reply, Refusal>>,
}

/// Stop whose reply is awaited, beside that to another request.
struct SentStop {
    /// Number of the last stop that it carries out.
    number: u64,
    kind: StopKind,
    /// Numbers of its frames. A reply to any of them is the reply.
    frames: Vec<u16>,
    sent: Instant,
}

impl Connection {
    pub(crate) fn new(transport: Box<dyn Transport>) -> Self {
        Self {
            transport,
            client: Client::new(),
            axes: 0,
            incoming: VecDeque::new(),
            waiting_samples: 0,
            stops: Arc::default(),
            sent_stop: None,
            sent: Instant::now(),
            awaited: None,
            reply: None,
        }
    }

    /// Returns the stops, which any thread may request.
    pub(crate) fn stops(&self) -> Arc<Stops> {
        self.stops.clone()
    }

    pub(crate) fn is_simulated(&self) -> bool {
        self.transport.is_simulated()
    }

    /// Creates the error of a request without a reply.
    pub(super) fn no_reply(&self, name: &'static str, request: &Request<'_>) -> LinkError {
        LinkError::no_reply(name, request, &self.transport.check())
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
                let identity = checked(identity)?;
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
        const REQUEST: &str = "log";
        let mut all: Vec<EventRecord> = Vec::new();
        let mut from = first;
        // Events that happen meanwhile come as messages. A controller that always has one more does not keep the host here.
        while all.len() < EVENTS {
            let Reply::Events(events) =
                self.request(REQUEST, &Request::Events { from }, RETRIES)?
            else {
                return Err(LinkError::Unexpected(REQUEST));
            };
            if events.is_empty() {
                break;
            }
            for event in events {
                if event.number < from {
                    return Err(LinkError::Wrong {
                        request: REQUEST,
                        problem: format!(
                            "event {} came where event {from} or a later one was requested",
                            event.number
                        ),
                    });
                }
                from = event.number.saturating_add(1);
                all.push(event);
            }
        }
        Ok(all)
    }

    pub(crate) fn read_file(&mut self, file: File) -> Result<Vec<u8>, LinkError> {
        const REQUEST: &str = "read";
        let max = match file {
            File::Settings => MAX_FILE_BYTES,
            File::Program => MAX_PROGRAM_BYTES,
        };
        let mut all = Vec::new();
        loop {
            let offset = all.len() as u32;
            let Reply::Chunk { length, bytes } =
                self.request(REQUEST, &Request::Read { file, offset }, RETRIES)?
            else {
                return Err(LinkError::Unexpected(REQUEST));
            };
            all.extend(&bytes);
            let wrong = |problem: String| {
                let request = REQUEST;
                Err(LinkError::Wrong { request, problem })
            };
            let whole = length as usize;
            if whole > max {
                return wrong(format!("a file of {length} bytes; the longest has {max}"));
            }
            if all.len() > whole || bytes.is_empty() && all.len() < whole {
                return wrong(format!("{} bytes of a file of {length} bytes", all.len()));
            }
            if all.len() == whole {
                return Ok(all);
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
            let next = Instant::now() + RESTART_EVERY;
            if self.wait(RESTART_EVERY).is_err() {
                // A line that is lost does not wait.
                std::thread::sleep(next.saturating_duration_since(Instant::now()));
            }
            let identity = if self.reopen() {
                self.identify()
            } else {
                Err(self.no_reply("restart", request))
            };
            // The controller may answer once more before it restarts. Its line may be lost then.
            let is_over = identity
                .as_ref()
                .is_ok_and(|identity| identity.restarts != before.restarts);
            if is_over {
                return identity;
            }
            if Instant::now() > end {
                return Err(self.no_reply("restart", request));
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
        self.waiting_samples = 0;
        if let Some(stop) = self.sent_stop.take() {
            self.stops.put_back(stop.kind);
        }
        self.transport.reopen()
    }

    /// Returns the next message that is not a reply, within a time.
    pub(crate) fn next(&mut self, within: Duration) -> Result<Option<Incoming>, LinkError> {
        let end = Instant::now() + within;
        loop {
            self.attend()?;
            if let Some(incoming) = self.incoming.pop_front() {
                if let Incoming::Samples(samples) = &incoming {
                    self.waiting_samples -= samples.len();
                }
                return Ok(Some(incoming));
            }
            if Instant::now() >= end {
                return Ok(None);
            }
            self.read()?;
        }
    }

    /// Waits for a time, and keeps the messages that arrive.
    pub(super) fn wait(&mut self, time: Duration) -> Result<(), LinkError> {
        let end = Instant::now() + time;
        while Instant::now() < end {
            self.attend()?;
            self.read()?;
        }
        Ok(())
    }

    /// Sends what does not wait for the reply to a request: a stop; and a frame if there was none for a while, as settings may require
    /// that the host that started the machine stays connected.
    fn attend(&mut self) -> Result<(), LinkError> {
        let sent_kind = self.sent_stop.as_ref().map(|stop| stop.kind);
        if let Some((number, kind)) = self.stops.take(sent_kind) {
            let sent = Instant::now();
            let frames = vec![self.send("stop", &Request::Stop(kind))?];
            self.sent_stop = Some(SentStop {
                number,
                kind,
                frames,
                sent,
            });
        } else if let Some(mut stop) = self
            .sent_stop
            .take_if(|stop| stop.sent.elapsed() >= STOP_AGAIN)
        {
            let request = Request::Stop(stop.kind);
            if stop.frames.len() < STOP_TIMES {
                stop.frames.push(self.send("stop", &request)?);
                stop.sent = Instant::now();
                self.sent_stop = Some(stop);
            } else {
                let error = self.no_reply("stop", &request);
                self.stops.end(stop.number, Err(error.to_string()));
            }
        }
        if self.sent.elapsed() >= ALIVE_EVERY {
            self.send("alive", &Request::Counters)?;
        }
        Ok(())
    }

    /// Ends the stop under way if this is its reply, and not that to a frame that only shows that this host is connected.
    fn end_stop(&mut self, to: u16, refusal: Option<&Refusal>) {
        let ended = self.sent_stop.take_if(|stop| stop.frames.contains(&to));
        let Some(stop) = ended else {
            return;
        };
        let outcome = refusal.map_or(Ok(()), |refusal| {
            let refused = LinkError::Refused {
                request: "stop",
                refusal: Box::new(refusal.clone()),
            };
            let condition = Request::Stop(stop.kind).condition();
            Err(refused.with_remedy(condition).to_string())
        });
        self.stops.end(stop.number, outcome);
    }

    /// Keeps a message until it is taken. A message for which there is no room is lost: samples and events have numbers, so that
    /// the gap is seen.
    fn keep(&mut self, incoming: Incoming) {
        let samples = match &incoming {
            Incoming::Samples(samples) => samples.len(),
            _ => 0,
        };
        let has_room = self.incoming.len() < MAX_WAITING_MESSAGES
            && self.waiting_samples + samples <= MAX_WAITING_SAMPLES;
        if has_room {
            self.waiting_samples += samples;
            self.incoming.push_back(incoming);
        }
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
            let reply = self.exchange(name, request).map_err(|error| match error {
                LinkError::Line(error) => {
                    LinkError::lost_reply(name, request, &self.transport.check(), error)
                }
                other => other,
            })?;
            if let Some(reply) = reply {
                return reply.map_err(|refusal| LinkError::Refused {
                    request: name,
                    refusal: Box::new(refusal),
                });
            }
        }
        Err(self.no_reply(name, request))
    }

    /// Sends a request, and waits for its reply. There may be none.
    fn exchange(
        &mut self,
        name: &'static str,
        request: &Request<'_>,
    ) -> Result<Option<Result<Reply, Refusal>>, LinkError> {
        self.awaited = Some(self.send(name, request)?);
        let end = Instant::now() + REPLY_WAIT;
        while self.reply.is_none() && Instant::now() < end {
            self.attend()?;
            self.read()?;
        }
        Ok(self.reply.take())
    }

    /// Reads the bytes that have arrived, and handles their messages.
    fn read(&mut self) -> Result<(), LinkError> {
        let mut buffer = [0; 4096];
        let count = self.transport.receive(&mut buffer)?;
        for &byte in &buffer[..count] {
            let Some(message) = self.client.push(byte) else {
                continue;
            };
            match Received::new(message, self.axes) {
                Received::Reply { to, body } if self.awaited == Some(to) => {
                    self.awaited = None;
                    self.reply = Some(body);
                }
                Received::Reply { to, body } => self.end_stop(to, body.err().as_ref()),
                Received::Incoming(incoming) => self.keep(incoming),
            }
        }
        Ok(())
    }
}

/// Message that owns its bytes.
enum Received {
    Reply {
        to: u16,
        body: Result<Reply, Refusal>,
    },
    Incoming(Incoming),
}

impl Received {
    fn new(message: Message<'_>, axes: usize) -> Self {
        Self::Incoming(match message {
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
                return Self::Reply { to, body };
            }
            Message::Status(status) => Incoming::Status(status),
            Message::Event(event) => Incoming::Event(event),
            Message::Samples {
                tick,
                every,
                channels,
                packet,
                ..
            } => Incoming::Samples(unpack(tick, every, channels, axes, packet).collect()),
        })
    }
}

/// Checks the numbers of an identity that others depend on.
fn checked(identity: Identity) -> Result<Identity, LinkError> {
    let Identity {
        version,
        axes,
        tick_hz,
        can_run,
        only_axis,
        ..
    } = identity;
    // A controller that refused its settings still takes other ones, and may have no axes.
    let min_axes = usize::from(can_run);
    let problem = if version != VERSION {
        format!("protocol version {version}, not {VERSION}")
    } else if !(min_axes..=MAX_AXES).contains(&usize::from(axes)) {
        format!("{axes} axes, outside {min_axes} to {MAX_AXES}")
    } else if can_run && !TICK_HZ.contains(&tick_hz) {
        let (min, max) = (TICK_HZ.start(), TICK_HZ.end());
        format!("a tick rate of {tick_hz} Hz, outside {min} to {max}")
    } else if only_axis.is_some_and(|axis| usize::from(axis) >= MAX_AXES) {
        format!("{} as its only axis", only_axis.unwrap_or_default())
    } else {
        return Ok(identity);
    };
    let request = "identify";
    Err(LinkError::Wrong { request, problem })
}
