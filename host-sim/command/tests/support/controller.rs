//! A controller behind a TCP port whose replies a test chooses.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use cophase_link::frame::{self, MAX_FRAME_BYTES, Receiver};
use cophase_link::header::{FIRST_SEQUENCE, OUTSIDE};
use cophase_link::message::{
    Counters, Identity, Message, Name, Refusal, ReplyBody, Request, VERSION,
};
use cophase_link::{Header, MAX_FILE_BYTES, encode};
use cophase_scene::load;
use host_sim::checked::Checked;

/// Names of the requests that arrived, with their times.
pub type Log = Arc<Mutex<Vec<(String, Instant)>>>;

/// Reply to a request; none if the request gets none.
pub type Answer<'a> = Option<Result<ReplyBody<'a>, Refusal>>;

/// Stored settings of a controller.
pub struct Stored {
    pub file: Vec<u8>,
    pub identity: Identity,
}

impl Stored {
    /// Settings of a scene, on a controller that could run them.
    pub fn new(scene: &str) -> Self {
        let settings = Checked::new(load::parse(scene).unwrap()).unwrap().settings;
        let mut buffer = vec![0; MAX_FILE_BYTES];
        let file = encode(&settings, FIRST_SEQUENCE, OUTSIDE, &mut buffer).unwrap();
        let name = |text: &str| Name::try_from(text).unwrap();
        let identity = Identity {
            version: VERSION,
            board: name("test"),
            serial: 7,
            firmware: name("0"),
            settings: name(&settings.name),
            settings_crc: Header::read(file).unwrap().payload_crc,
            program_crc: 0,
            axes: settings.axes.len() as u8,
            tick_hz: settings.tick_hz,
            can_run: true,
            only_axis: None,
            restarts: 0,
        };
        Self {
            file: file.to_vec(),
            identity,
        }
    }

    /// Returns the reply of a sound controller.
    pub fn answer<'a>(&'a self, request: &Request<'_>) -> Answer<'a> {
        Some(Ok(match request {
            Request::Identify { .. } => ReplyBody::Identity(self.identity.clone()),
            Request::Read { offset, .. } => {
                let rest = &self.file[*offset as usize..];
                ReplyBody::Chunk {
                    length: self.file.len() as u32,
                    bytes: &rest[..rest.len().min(256)],
                }
            }
            Request::Counters => ReplyBody::Counters(Counters::default()),
            Request::Events { .. } => ReplyBody::Events(heapless::Vec::new()),
            _ => ReplyBody::Done,
        }))
    }
}

/// Sends a message as the frame of this number.
pub fn send(stream: &mut TcpStream, number: u16, message: &Message<'_>) -> std::io::Result<()> {
    let mut bytes = [0; MAX_FRAME_BYTES];
    let length = frame::encode(number, &mut bytes, |payload| {
        Some(postcard::to_slice(message, payload).ok()?.len())
    });
    stream.write_all(&bytes[..length.unwrap()])
}

/// Serves one host after another with these replies, and calls `idle` between two reads. Returns the place for `--to`, and the requests.
pub fn serve(
    stored: Stored,
    answer: impl for<'a> Fn(&'a Stored, &Request<'_>) -> Answer<'a> + Send + 'static,
    mut idle: impl FnMut(&mut TcpStream) -> std::io::Result<()> + Send + 'static,
) -> (String, Log) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let to = format!("tcp:{}", listener.local_addr().unwrap());
    let log = Log::default();
    let arrived = log.clone();
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            // The host has left.
            let _ = exchange(stream, &stored, &answer, &mut idle, &arrived);
        }
    });
    (to, log)
}

fn exchange(
    mut stream: TcpStream,
    stored: &Stored,
    answer: &impl for<'a> Fn(&'a Stored, &Request<'_>) -> Answer<'a>,
    idle: &mut impl FnMut(&mut TcpStream) -> std::io::Result<()>,
    log: &Log,
) -> std::io::Result<()> {
    stream.set_read_timeout(Some(Duration::from_millis(1)))?;
    stream.set_nodelay(true)?;
    let mut receiver = Receiver::new();
    let mut buffer = [0; 1024];
    loop {
        let count = match stream.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(count) => count,
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(e) => return Err(e),
        };
        for &byte in &buffer[..count] {
            let Some((number, payload)) = receiver.push(byte) else {
                continue;
            };
            let request: Request<'_> = postcard::from_bytes(payload).unwrap();
            let name = format!("{request:?}");
            log.lock().unwrap().push((name, Instant::now()));
            if let Some(body) = answer(stored, &request) {
                let to = number;
                send(&mut stream, number, &Message::Reply { to, body })?;
            }
        }
        idle(&mut stream)?;
    }
}
