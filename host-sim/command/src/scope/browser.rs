//! One browser: its stops go to the connection, its other requests one by one to the bench, and its reports and samples come from a queue.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

use cophase_link::message::StopKind;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::bench::Job;
use super::browsers::Browser;
use super::report::Report;
use super::request::{Order, Pending, Request};
use crate::link::stops::Stops;

/// Largest number of messages that wait for a browser: about four seconds of samples.
const QUEUE: usize = 256;

/// Longest wait of a read or a write, after which the other one has its turn.
const TURN: Duration = Duration::from_millis(4);

/// Longest request, bytes: a program in its scene, of which JSON escapes some characters.
pub(super) const MAX_REQUEST_BYTES: usize = 1 << 19;

/// Bytes that a browser may send at once, and a second.
const BURST_BYTES: usize = 2 * MAX_REQUEST_BYTES;
const BYTES_PER_S: usize = 1 << 16;

/// Largest number of requests of a browser that wait for their replies.
const MAX_REQUESTS: usize = 16;

/// Largest number of replies that wait for a browser. One that reads none of them is disconnected.
const MAX_REPLIES: usize = 4 * MAX_REQUESTS;

/// Longest wait for the outcome of a stop. It exceeds the time in which the connection ends a stop by itself.
const STOP_WITHIN: Duration = Duration::from_secs(2);

/// Reason for a request that is refused because of earlier ones.
const TOO_MANY: &str = "too many requests wait; wait for their replies";

/// Receivers of the requests of all browsers.
#[derive(Clone, Debug)]
pub(super) struct Senders {
    pub(super) stops: Arc<Stops>,
    pub(super) jobs: Sender<Job>,
    pub(super) checks: SyncSender<Pending>,
}

/// Serves a browser until it leaves.
pub(super) fn serve(stream: TcpStream, senders: Senders, slot: Arc<()>) -> io::Result<()> {
    stream.set_read_timeout(Some(TURN))?;
    stream.set_write_timeout(Some(TURN))?;
    let address = stream.peer_addr()?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(MAX_REQUEST_BYTES))
        .max_frame_size(Some(MAX_REQUEST_BYTES));
    let stream = Throttled::new(stream);
    let socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
    let (queue, reports) = sync_channel(QUEUE);
    let browser = Browser::new(address, queue, slot);
    let id = browser.id;
    if senders.jobs.send(Job::Joined(browser)).is_ok() {
        let mut exchange = Exchange {
            socket,
            id,
            senders,
            waiting: VecDeque::new(),
            current: None,
            stops: VecDeque::new(),
            replies: VecDeque::new(),
            reports,
            is_sent: true,
        };
        // The reason does not matter: the browser has left.
        let _ = exchange.run();
        let _ = exchange.senders.jobs.send(Job::Left(id));
    }
    Ok(())
}

struct Exchange {
    socket: WebSocket<Throttled>,
    id: u32,
    senders: Senders,
    /// Requests that wait for the reply to the one under way, with their numbers.
    waiting: VecDeque<(u64, Request, Order)>,
    current: Option<(u64, Receiver<Result<(), String>>)>,
    /// Stops without an outcome: the numbers of the request and of the stop, and the end of the wait.
    stops: VecDeque<(u64, u64, Instant)>,
    replies: VecDeque<Message>,
    reports: Receiver<Message>,
    /// False if the socket has the rest of a message that could not be written yet.
    is_sent: bool,
}

impl Exchange {
    fn run(&mut self) -> Result<(), Error> {
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => self.take(&text),
                Ok(_) => {}
                Err(error) if is_turn_over(&error) => {}
                Err(error) => return Err(error),
            }
            self.follow_stops();
            self.follow_requests();
            if self.replies.len() > MAX_REPLIES {
                return Ok(());
            }
            self.send()?;
        }
    }

    /// Takes a request. A stop is requested here, whatever else waits.
    fn take(&mut self, text: &str) {
        let (number, request) = Request::parse(text);
        match request {
            Ok(Request::Stop { now }) => {
                let kind = if now {
                    StopKind::Now
                } else {
                    StopKind::AtPhase
                };
                let stop = self.senders.stops.request(kind);
                let end = Instant::now() + STOP_WITHIN;
                // The outcome of a later stop is that of all earlier ones.
                if self.stops.len() == MAX_REQUESTS
                    && let Some((number, ..)) = self.stops.pop_front()
                {
                    self.reply(number, Err(TOO_MANY.to_owned()));
                }
                self.stops.push_back((number, stop, end));
            }
            Ok(_) if self.waiting.len() >= MAX_REQUESTS => {
                self.reply(number, Err(TOO_MANY.to_owned()));
            }
            Ok(Request::Load { .. }) if self.is_loading() => {
                let problem = "another program of this page waits; wait for its reply";
                self.reply(number, Err(problem.to_owned()));
            }
            Ok(request) => {
                let order = Order::now(&self.senders.stops);
                self.waiting.push_back((number, request, order));
            }
            Err(error) => self.reply(number, Err(error)),
        }
    }

    /// Returns true if a program waits. It is large.
    fn is_loading(&self) -> bool {
        let mut waiting = self.waiting.iter();
        waiting.any(|(_, request, _)| matches!(request, Request::Load { .. }))
    }

    fn follow_stops(&mut self) {
        while let Some(&(number, stop, end)) = self.stops.front() {
            let outcome = self.senders.stops.outcome(stop).or_else(|| {
                let problem = "stop: no reply; the machine may still be running: press its STOP";
                (Instant::now() > end).then(|| Err(problem.to_owned()))
            });
            let Some(outcome) = outcome else {
                return;
            };
            self.stops.pop_front();
            self.reply(number, outcome);
        }
    }

    /// Passes the next request on once the one under way has its reply.
    fn follow_requests(&mut self) {
        if let Some((number, reply)) = &self.current {
            let number = *number;
            let outcome = match reply.try_recv() {
                Ok(outcome) => outcome,
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => Err("the server ends".to_owned()),
            };
            self.current = None;
            self.reply(number, outcome);
        }
        let Some((number, request, order)) = self.waiting.pop_front() else {
            return;
        };
        let (reply, outcome) = sync_channel(1);
        let pending = Pending {
            browser: self.id,
            request,
            order,
            reply,
        };
        let is_passed = if matches!(pending.request, Request::Load { .. }) {
            self.senders.checks.try_send(pending).is_ok()
        } else {
            self.senders.jobs.send(Job::Request(pending)).is_ok()
        };
        if is_passed {
            self.current = Some((number, outcome));
        } else {
            let problem = "another program is being checked; load this one again after it";
            self.reply(number, Err(problem.to_owned()));
        }
    }

    fn reply(&mut self, id: u64, outcome: Result<(), String>) {
        let error = outcome.err();
        let reply = super::browsers::message(&Report::Reply { id, error });
        self.replies.push_back(reply);
    }

    /// Sends what waits. A browser that is too slow leaves messages in its queue. Messages that find no room there are counted. Its
    /// requests are still read.
    fn send(&mut self) -> Result<(), Error> {
        loop {
            if self.is_sent {
                let next = self.replies.pop_front();
                let Some(message) = next.or_else(|| self.reports.try_recv().ok()) else {
                    return Ok(());
                };
                // A message that cannot be written yet waits in the socket.
                done(self.socket.write(message))?;
            }
            self.is_sent = done(self.socket.flush())?;
            if !self.is_sent {
                return Ok(());
            }
        }
    }
}

/// Returns true if everything was sent, and false if the rest has to wait for another turn.
fn done(sent: Result<(), Error>) -> Result<bool, Error> {
    match sent {
        Ok(()) => Ok(true),
        Err(error) if is_turn_over(&error) => Ok(false),
        Err(error) => Err(error),
    }
}

fn is_turn_over(error: &Error) -> bool {
    matches!(error, Error::Io(e) if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut))
}

/// Stream whose bytes are read at a limited rate, whatever frames they form. The rest waits in the browser.
#[derive(Debug)]
struct Throttled {
    stream: TcpStream,
    /// Bytes that may be read now.
    budget: usize,
    filled: Instant,
}

impl Throttled {
    fn new(stream: TcpStream) -> Self {
        Self {
            stream,
            budget: BURST_BYTES,
            filled: Instant::now(),
        }
    }
}

impl Read for Throttled {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let more = (self.filled.elapsed().as_secs_f64() * BYTES_PER_S as f64) as usize;
        if more > 0 {
            self.budget = (self.budget + more).min(BURST_BYTES);
            self.filled = Instant::now();
        }
        if self.budget == 0 {
            std::thread::sleep(TURN);
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let length = buffer.len().min(self.budget);
        let count = self.stream.read(&mut buffer[..length])?;
        self.budget -= count;
        Ok(count)
    }
}

impl Write for Throttled {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.stream.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
