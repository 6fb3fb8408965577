//! `cophase scope`, and browsers that open its page.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// Longest time that a test waits for a report.
const PATIENCE: Duration = Duration::from_secs(60);

pub const SCENE: &str = "name = \"scope\"\n\
     fidelity = \"kinematic\"\n\
     [machine]\ncrank_radius_mm = 12\nlambda = 0.3\nload_kg = 5\n\
     [control]\nsettle_s = 0.01\n\
     [limits]\nspeed_hz = 20\nacceleration_hz_per_s = 100\njerk_hz_per_s2 = 4000\nhoming_speed_hz = 5\n\
     [axes]\ncount = 3\ndrive = \"stepper\"\nsteps_per_turn = 3200\n\
     [[program]]\namax_g = 2\nramp_s = 0.2\nhold_s = 1000\n";

/// A server on a simulated controller.
pub struct Served {
    child: Child,
    pub port: u16,
    pub token: String,
    _folder: Option<tempfile::TempDir>,
}

impl Served {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml");
        std::fs::write(&scene, SCENE).unwrap();
        let mut served = Self::of(&format!("sim:{}", scene.display()));
        served._folder = Some(folder);
        served
    }

    /// A server on the controller at a place.
    pub fn of(to: &str) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_cophase"))
            .args(["scope", "--to", to])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut url = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut url)
            .unwrap();
        let rest = url.trim().strip_prefix("http://127.0.0.1:").unwrap();
        let (port, token) = rest.trim_end_matches('/').split_once('/').unwrap();
        Self {
            child,
            port: port.parse().unwrap(),
            token: token.to_owned(),
            _folder: None,
        }
    }

    /// Number of the server's process.
    pub fn process(&self) -> u32 {
        self.child.id()
    }

    pub fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// Returns the answer to a request of these lines.
    pub fn answer(&self, lines: &[&str]) -> String {
        let mut stream = TcpStream::connect(self.host()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        write!(stream, "{}\r\n\r\n", lines.join("\r\n")).unwrap();
        let mut answer = Vec::new();
        // An accepted socket stays open, so the head of the answer is enough.
        let mut part = [0; 4096];
        while !answer.windows(4).any(|end| end == b"\r\n\r\n") {
            match stream.read(&mut part) {
                Ok(0) | Err(_) => break,
                Ok(count) => answer.extend(&part[..count]),
            }
        }
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Returns the status of the answer to `GET` of a path, with more lines.
    pub fn get(&self, path: &str, more: &[&str]) -> u16 {
        let first = format!("GET {path} HTTP/1.1");
        let mut lines = vec![first.as_str()];
        lines.extend(more);
        let answer = self.answer(&lines);
        let status = answer.split(' ').nth(1).map(str::to_owned);
        status.and_then(|status| status.parse().ok()).unwrap_or(0)
    }

    pub fn browser(&self) -> Browser {
        self.try_browser().expect("the server has room for a page")
    }

    /// Opens the page; none if the server has no room for it.
    pub fn try_browser(&self) -> Option<Browser> {
        let url = format!("ws://{}/{}/socket", self.host(), self.token);
        let mut request = url.into_client_request().unwrap();
        let origin = format!("http://{}", self.host()).parse().unwrap();
        request.headers_mut().insert("origin", origin);
        let stream = TcpStream::connect(self.host()).ok()?;
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = tungstenite::client(request, stream).ok()?;
        Some(Browser { socket, next: 1 })
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub struct Browser {
    pub socket: WebSocket<TcpStream>,
    next: u64,
}

impl Browser {
    /// Returns the next report that meets the condition.
    pub fn wait(&mut self, is_it: impl Fn(&Value) -> bool) -> Value {
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            if let Message::Text(text) = self.socket.read().unwrap() {
                let report: Value = serde_json::from_str(&text).unwrap();
                if is_it(&report) {
                    return report;
                }
            }
        }
        panic!("not within {PATIENCE:?}");
    }

    /// Makes a request, and returns the reason if it is refused.
    pub fn request(&mut self, mut request: Value) -> Result<(), String> {
        let id = self.next;
        self.next += 1;
        request["id"] = id.into();
        self.socket
            .send(Message::text(request.to_string()))
            .unwrap();
        let reply = self.wait(|report| report["type"] == "reply" && report["id"] == id);
        match reply["error"].as_str() {
            Some(error) => Err(error.to_owned()),
            None => Ok(()),
        }
    }

    pub fn command(&mut self, name: &str) -> Result<(), String> {
        self.request(json!({ "request": name }))
    }

    pub fn wait_for_state(&mut self, states: &[&str]) -> Value {
        self.wait(|report| {
            report["type"] == "status" && states.iter().any(|state| report["state"] == *state)
        })
    }
}
