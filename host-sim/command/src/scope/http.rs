//! Requests of browsers: files of the page, and the upgrade to a WebSocket.

use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use tungstenite::handshake::derive_accept_key;

use super::access::{Access, Credentials};
use super::bench::Job;
use super::{browser, page};

/// Greatest length of a request's head, bytes.
const HEAD_BYTES: usize = 8192;

/// Greatest number of headers of a request.
const HEADERS: usize = 64;

/// Longest wait for the request of a browser, and for the end of the answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// Greatest number of connections at the same time.
const CONNECTIONS: usize = 64;

/// Accepts connections for as long as the process lives.
pub(super) fn serve(listener: &TcpListener, access: &Arc<Access>, jobs: &Sender<Job>) {
    let open = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming().flatten() {
        // A browser that gets no answer tries again.
        if open.load(Ordering::Relaxed) >= CONNECTIONS {
            continue;
        }
        open.fetch_add(1, Ordering::Relaxed);
        let (access, jobs, open) = (access.clone(), jobs.clone(), open.clone());
        std::thread::spawn(move || {
            // The browser has left, and nothing remains to be done for it.
            let _ = answer(stream, &access, &jobs);
            open.fetch_sub(1, Ordering::Relaxed);
        });
    }
}

/// Answers one request; a socket stays until either side closes it.
fn answer(mut stream: TcpStream, access: &Access, jobs: &Sender<Job>) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let head = read_head(&mut stream)?;
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    let parsed = request.parse(&head);
    let (true, Some(path)) = (parsed.is_ok(), request.path) else {
        return refuse(&mut stream, "400 Bad Request", "no HTTP request");
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
    let file = match access.check(&credentials) {
        Ok(file) => file,
        Err(denied) => return refuse(&mut stream, "403 Forbidden", &denied.to_string()),
    };
    if request.method != Some("GET") {
        return refuse(&mut stream, "405 Method Not Allowed", "give GET");
    }
    if file == "socket" {
        let upgrade =
            header("upgrade").is_some_and(|value| value.eq_ignore_ascii_case("websocket"));
        let (true, Some(key)) = (upgrade, header("sec-websocket-key")) else {
            return refuse(&mut stream, "426 Upgrade Required", "this is a WebSocket");
        };
        if credentials.origin.is_none() {
            return refuse(
                &mut stream,
                "403 Forbidden",
                "a socket needs the page's own origin",
            );
        }
        write!(
            stream,
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {}\r\n\r\n",
            derive_accept_key(key.as_bytes())
        )?;
        return browser::serve(stream, jobs);
    }
    match page::find(file) {
        Some(file) => respond(
            &mut stream,
            "200 OK",
            file.content_type,
            &policy(access),
            file.bytes,
        ),
        None => refuse(&mut stream, "404 Not Found", "there is no such file"),
    }
}

/// Reads up to the empty line. A request for a file has no body.
fn read_head(stream: &mut TcpStream) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    let end = Instant::now() + PATIENCE;
    while !head.ends_with(b"\r\n\r\n") {
        // The head is read byte by byte, because the following bytes belong to the socket. A head is short.
        let mut byte = [0];
        if head.len() == HEAD_BYTES || Instant::now() > end || stream.read(&mut byte)? == 0 {
            return Err(io::ErrorKind::InvalidData.into());
        }
        head.push(byte[0]);
    }
    Ok(head)
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

fn refuse(stream: &mut TcpStream, status: &str, why: &str) -> io::Result<()> {
    let text = format!("{why}\n");
    respond(
        stream,
        status,
        "text/plain; charset=utf-8",
        "default-src 'none'",
        text.as_bytes(),
    )
}

fn respond(
    stream: &mut TcpStream,
    status: &str,
    content_type: &str,
    policy: &str,
    body: &[u8],
) -> io::Result<()> {
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {content_type}\r\nContent-Length: {}\r\nContent-Security-Policy: {policy}\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cache-Control: no-store\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(body)?;
    stream.flush()
}
