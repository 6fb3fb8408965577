//! TCP connection to a controller's server.

use std::io::{self, Read};
use std::net::TcpStream;

use super::error::NoController;
use super::transport::{SHORT_WAIT, Transport, quiet, send_all};
use crate::address::Parts;

pub(super) struct Tcp {
    address: String,
    stream: TcpStream,
    /// The first bytes that arrived.
    greeting: Vec<u8>,
    /// True once the end of a frame has arrived. What else sends text has none.
    has_frame: bool,
}

/// Beginnings of what servers of other protocols send, and what they are. A web server answers bytes that are no request with a
/// bare page.
const OTHERS: [(&str, &str); 4] = [
    ("HTTP/", "a web server"),
    ("<!DOCTYPE", "a web server"),
    ("<html", "a web server"),
    ("SSH-", "an SSH server"),
];

/// Byte that ends a frame.
const FRAME_END: u8 = 0;

impl Tcp {
    pub(super) fn new(address: &str) -> Result<Self, String> {
        let parts = Parts::parse(address);
        let wrong = |problem: &str, address: &str| {
            format!("{problem}; give tcp:{address}, where the controller's server listens")
        };
        let stream = match parts.problem() {
            Some(problem) => Err(wrong(&problem, &parts.full())),
            None => open_stream(address).map_err(|e| match e.kind() {
                io::ErrorKind::ConnectionRefused => {
                    "nothing listens there; start the controller's server, or give its port"
                        .to_owned()
                }
                _ => wrong(&e.to_string(), "HOST:PORT"),
            }),
        };
        Ok(Self {
            address: address.to_owned(),
            stream: stream.map_err(|wrong| format!("--to tcp:{address}: {wrong}"))?,
            greeting: Vec::new(),
            has_frame: false,
        })
    }

    /// Refuses the server of another protocol, whose bytes would be taken for noise.
    fn check_greeting(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.has_frame |= bytes.contains(&FRAME_END);
        let max = OTHERS.iter().map(|(begin, _)| begin.len()).max();
        let missing = max.unwrap_or_default().saturating_sub(self.greeting.len());
        self.greeting.extend(bytes.iter().take(missing));
        let other = OTHERS.iter().find(|(begin, _)| {
            let first = self.greeting.get(..begin.len());
            first.is_some_and(|first| first.eq_ignore_ascii_case(begin.as_bytes()))
        });
        other.map_or(Ok(()), |(_, what)| {
            Err(self.no_controller(format!("{what} is at this address, and no controller")))
        })
    }

    fn no_controller(&self, problem: String) -> io::Error {
        let to = format!("tcp:{}", self.address);
        io::Error::other(NoController { to, problem })
    }

    /// Returns why the line is lost. What closes it before the first frame is no controller.
    fn lost(&mut self, error: io::Error) -> io::Error {
        // A server may have sent its reason before it closed the line.
        let mut rest = [0; 64];
        if let Ok(count) = self.stream.read(&mut rest)
            && let Err(other) = self.check_greeting(&rest[..count])
        {
            return other;
        }
        if self.has_frame {
            return error;
        }
        self.no_controller(
            "what listens there is no controller, as it closed the connection without a frame"
                .to_owned(),
        )
    }
}

fn open_stream(address: &str) -> io::Result<TcpStream> {
    let stream = TcpStream::connect(address)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(SHORT_WAIT))?;
    stream.set_write_timeout(Some(SHORT_WAIT))?;
    Ok(stream)
}

impl Transport for Tcp {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let sent = send_all(&mut self.stream, bytes);
        sent.map_err(|error| self.lost(error))
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = match self.stream.read(buffer) {
            Ok(0) if !buffer.is_empty() => Err(io::ErrorKind::ConnectionAborted.into()),
            read => quiet(read),
        };
        let count = read.map_err(|error| self.lost(error))?;
        self.check_greeting(&buffer[..count])?;
        Ok(count)
    }

    fn check(&self) -> String {
        format!(
            "check that a controller's server listens at {}",
            self.address
        )
    }

    fn reopen(&mut self) -> bool {
        open_stream(&self.address).is_ok_and(|stream| {
            self.stream = stream;
            self.greeting.clear();
            self.has_frame = false;
            true
        })
    }
}
