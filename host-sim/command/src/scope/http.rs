//! Requests of browsers: files of the page, and the upgrade to a WebSocket.
//!
//! A socket that has not shown the token yet has no thread and no memory of its own here: one thread polls all of them in turn, and the
//! oldest one makes room for a new one. Files and pages have their own limits.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use tungstenite::handshake::derive_accept_key;

use super::access::{Access, Credentials};
use super::browser::{self, Senders};
use super::page;

/// Largest length of a request's head, bytes.
const HEAD_BYTES: usize = 8192;

/// Largest number of headers of a request.
const HEADERS: usize = 64;

/// Longest wait for the head of a request.
const HEAD_WITHIN: Duration = Duration::from_secs(5);

/// Longest time for the transfer of a file.
const FILE_WITHIN: Duration = Duration::from_secs(30);

/// Longest wait of a write to a socket.
const WRITE_WITHIN: Duration = Duration::from_secs(2);

/// Largest numbers of sockets that have not shown the token, of files in transfer, and of open pages.
const UNAUTHENTICATED: usize = 128;
const FILES: usize = 32;
const PAGES: usize = 16;

/// Largest number of sockets that are accepted before those that wait have their turn.
const ACCEPTED: usize = 32;

/// Time between two polls of the sockets that have not shown the token.
const POLL_EVERY: Duration = Duration::from_millis(1);

/// Accepts connections for as long as the process lives.
pub(super) fn serve(listener: &TcpListener, access: &Access, senders: &Senders) {
    let mut waiting: VecDeque<(TcpStream, Instant)> = VecDeque::new();
    let mut admission = Admission {
        access,
        senders,
        files: Arc::new(()),
        pages: Arc::new(()),
    };
    loop {
        for _ in 0..ACCEPTED {
            // If no socket waits, the thread sleeps until one comes.
            let accepted = listener
                .set_nonblocking(!waiting.is_empty())
                .and_then(|()| listener.accept());
            match accepted {
                Ok((stream, _)) => {
                    if stream.set_nonblocking(true).is_err() {
                        continue;
                    }
                    if waiting.len() == UNAUTHENTICATED {
                        waiting.pop_front();
                    }
                    waiting.push_back((stream, Instant::now() + HEAD_WITHIN));
                }
                Err(error) => {
                    if error.kind() != io::ErrorKind::WouldBlock {
                        // The process may have no room for another socket.
                        waiting.pop_front();
                        std::thread::sleep(POLL_EVERY);
                    }
                    break;
                }
            }
        }
        for _ in 0..waiting.len() {
            let Some((mut stream, end)) = waiting.pop_front() else {
                break;
            };
            match read_head(&mut stream) {
                Ok(Some(head)) => admission.answer(stream, &head),
                Ok(None) if Instant::now() < end => waiting.push_back((stream, end)),
                Ok(None) | Err(_) => {}
            }
        }
        std::thread::sleep(POLL_EVERY);
    }
}

/// Reads up to the empty line, once it has arrived. A request for a file has no body, and the bytes that follow belong to the socket.
fn read_head(stream: &mut TcpStream) -> io::Result<Option<Vec<u8>>> {
    let mut head = [0; HEAD_BYTES];
    let count = match stream.peek(&mut head) {
        Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
        Ok(count) => count,
        Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(None),
        Err(error) => return Err(error),
    };
    const END: &[u8] = b"\r\n\r\n";
    match head[..count].windows(END.len()).position(|end| end == END) {
        Some(at) => {
            let mut head = vec![0; at + END.len()];
            stream.read_exact(&mut head)?;
            Ok(Some(head))
        }
        None if count == HEAD_BYTES => Err(io::ErrorKind::InvalidData.into()),
        None => Ok(None),
    }
}

/// Admission of sockets.
struct Admission<'a> {
    access: &'a Access,
    senders: &'a Senders,
    /// Places of files and pages. Each that is taken is one more reference.
    files: Arc<()>,
    pages: Arc<()>,
}

impl Admission<'_> {
    /// Answers one request. A file and a page get a thread.
    fn answer(&mut self, mut stream: TcpStream, head: &[u8]) {
        let refusal = match self.admit(head) {
            Ok(Admitted::File(file, place)) => {
                let policy = policy(self.access);
                return spawn(move || {
                    let _place = place;
                    let head = head_of("200 OK", file.content_type, &policy, file.bytes.len());
                    let mut write = || {
                        begin(&stream)?;
                        write_within(&mut stream, head.as_bytes())?;
                        write_within(&mut stream, file.bytes)
                    };
                    // The browser has left, and nothing remains to be done for it.
                    let _ = write();
                });
            }
            Ok(Admitted::Page(key, place)) => {
                let senders = self.senders.clone();
                return spawn(move || {
                    let upgrade = format!(
                        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {}\r\n\r\n",
                        derive_accept_key(key.as_bytes())
                    );
                    let begun = begin(&stream).and_then(|()| stream.write_all(upgrade.as_bytes()));
                    if begun.is_ok() {
                        let _ = browser::serve(stream, senders, place);
                    }
                });
            }
            Err(refusal) => refusal,
        };
        let (status, reason) = refusal;
        let text = format!("{reason}\n");
        let head = head_of(
            status,
            "text/plain; charset=utf-8",
            "default-src 'none'",
            text.len(),
        );
        // The buffer of a socket that has sent a head only has room for this.
        let _ = stream.write_all(format!("{head}{text}").as_bytes());
    }

    /// Returns what a request may have, or the status and the reason of the refusal.
    fn admit(&self, head: &[u8]) -> Result<Admitted, (&'static str, String)> {
        let mut headers = [httparse::EMPTY_HEADER; HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        let parsed = request.parse(head);
        let refuse = |status, reason: &str| Err((status, reason.to_owned()));
        let (true, Some(path)) = (parsed.is_ok(), request.path) else {
            return refuse("400 Bad Request", "no HTTP request");
        };
        let header = |name: &str| {
            let mut same = request
                .headers
                .iter()
                .filter(|header| header.name.eq_ignore_ascii_case(name));
            // A browser could read a repeated header in another way than this server.
            let (value, twice) = (same.next(), same.next());
            value
                .filter(|_| twice.is_none())
                .and_then(|header| std::str::from_utf8(header.value).ok())
        };
        let is_given = |name: &str| {
            request
                .headers
                .iter()
                .any(|header| header.name.eq_ignore_ascii_case(name))
        };
        let credentials = Credentials {
            path,
            host: header("host"),
            // An unreadable origin is not the origin of this server.
            origin: header("origin").or_else(|| is_given("origin").then_some("")),
        };
        let file = match self.access.check(&credentials) {
            Ok(file) => file,
            Err(denied) => return refuse("403 Forbidden", &denied.to_string()),
        };
        if request.method != Some("GET") {
            return refuse("405 Method Not Allowed", "give GET");
        }
        if file == "socket" {
            let upgrade =
                header("upgrade").is_some_and(|value| value.eq_ignore_ascii_case("websocket"));
            let (true, Some(key)) = (upgrade, header("sec-websocket-key")) else {
                return refuse("426 Upgrade Required", "this is a WebSocket");
            };
            if credentials.origin.is_none() {
                return refuse("403 Forbidden", "a socket needs the page's own origin");
            }
            return match place(&self.pages, PAGES) {
                Some(place) => Ok(Admitted::Page(key.to_owned(), place)),
                None => refuse(BUSY, "too many pages are open; close one of them"),
            };
        }
        let Some(file) = page::find(file) else {
            return refuse("404 Not Found", "there is no such file");
        };
        match place(&self.files, FILES) {
            Some(place) => Ok(Admitted::File(file, place)),
            None => refuse(BUSY, "too many files are being fetched; try again"),
        }
    }
}

const BUSY: &str = "503 Service Unavailable";

/// Request that is answered, with its place.
enum Admitted {
    File(&'static page::File, Arc<()>),
    /// A page, with the key of its socket.
    Page(String, Arc<()>),
}

/// Takes one of so many places, if one is free.
fn place(places: &Arc<()>, max: usize) -> Option<Arc<()>> {
    (Arc::strong_count(places) <= max).then(|| places.clone())
}

/// Runs a task on a thread of its own. Without a thread, its socket is closed.
fn spawn(task: impl FnOnce() + Send + 'static) {
    let _ = std::thread::Builder::new().spawn(task);
}

/// Prepares a socket for a thread that waits for it.
fn begin(stream: &TcpStream) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_WITHIN))
}

/// Writes bytes to a browser that takes them within a time.
fn write_within(stream: &mut TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    let end = Instant::now() + FILE_WITHIN;
    while !bytes.is_empty() {
        let count = stream.write(bytes)?;
        bytes = &bytes[count..];
        if Instant::now() > end {
            return Err(io::ErrorKind::TimedOut.into());
        }
    }
    Ok(())
}

/// Returns the Content-Security-Policy of the page: own files and the own socket only. The editor compiles the core from
/// WebAssembly.
fn policy(access: &Access) -> String {
    let sockets: Vec<String> = access.sockets().collect();
    format!(
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self'; \
         connect-src 'self' {}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        sockets.join(" ")
    )
}

/// Returns the head of an answer.
fn head_of(status: &str, content_type: &str, policy: &str, length: usize) -> String {
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {content_type}\r\nContent-Length: {length}\r\nContent-Security-Policy: {policy}\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cache-Control: no-store\r\nConnection: close\r\n\r\n"
    )
}
