//! Floods of the live page's server, during each of which another page stops the machine. `COPHASE_FLOOD_S` sets the duration of each
//! flood in seconds; by default they are short.

use std::io::Write;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use cophase_link::message::{Event, EventRecord, Message as LinkMessage, ReplyBody, Request};
use serde_json::{Value, json};

use crate::support::controller::{self, Stored};
use crate::support::served::{Browser, SCENE, Served};
use tungstenite::Message;
use tungstenite::protocol::frame::coding::{Data, OpCode};
use tungstenite::protocol::frame::{Frame, FrameHeader};

/// Longest time from the request of a stop to its reply.
const STOPS_WITHIN: Duration = Duration::from_millis(500);

/// Largest memory of the server at any time, kB.
const MAX_MEMORY_KB: u64 = 100_000;

/// Time between two stops.
const STOP_EVERY: Duration = Duration::from_millis(100);

/// One flood at a time, so that each one has the whole computer.
fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

fn duration() -> Duration {
    let seconds = std::env::var("COPHASE_FLOOD_S").ok();
    Duration::from_secs_f64(seconds.map_or(0.5, |seconds| seconds.parse().unwrap()))
}

/// Threads that flood the server until this is dropped.
struct Flood {
    is_over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Flood {
    /// Begins a flood on several threads. Each calls `step` with its state until the end, and makes a new state if there is none.
    fn new<T>(
        threads: usize,
        state: impl Fn() -> Option<T> + Clone + Send + 'static,
        step: impl Fn(&mut T) -> Option<()> + Clone + Send + 'static,
    ) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let flood = || {
            let (state, step, is_over) = (state.clone(), step.clone(), is_over.clone());
            std::thread::spawn(move || {
                while !is_over.load(Ordering::Relaxed) {
                    let Some(mut state) = state() else {
                        std::thread::sleep(Duration::from_millis(1));
                        continue;
                    };
                    while !is_over.load(Ordering::Relaxed) && step(&mut state).is_some() {}
                }
            })
        };
        let threads = std::iter::repeat_with(flood).take(threads).collect();
        Self { is_over, threads }
    }
}

impl Drop for Flood {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            thread.join().unwrap();
        }
    }
}

/// Returns the largest memory of a process so far, kB.
#[cfg(target_os = "linux")]
fn memory_kb(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM"))
        .unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[cfg(not(target_os = "linux"))]
fn memory_kb(_: u32) -> u64 {
    0
}

/// Requests a stop, and returns the time until its reply.
fn stop(page: &mut Browser) -> Duration {
    let began = Instant::now();
    page.request(json!({ "request": "stop", "now": true }))
        .unwrap();
    began.elapsed()
}

/// Stops again and again during the flood, and checks time and memory.
fn check_stops(name: &str, served: &Served, page: &mut Browser) {
    let end = Instant::now() + duration();
    let (mut slowest, mut count) = (Duration::ZERO, 0);
    while Instant::now() < end {
        slowest = slowest.max(stop(page));
        count += 1;
        std::thread::sleep(STOP_EVERY);
    }
    let memory = memory_kb(served.process());
    println!("{name}: {count} stops, the slowest after {slowest:?}; {memory} kB");
    assert!(slowest <= STOPS_WITHIN, "{name}: a stop took {slowest:?}");
    assert!(memory <= MAX_MEMORY_KB, "{name}: {memory} kB");
}

/// Starts the simulated machine, floods the server, and stops the machine from a page that takes no part in the flood.
fn stop_during(name: &str, flood: impl FnOnce(Arc<Served>) -> Flood) {
    let _turn = turn();
    let served = Arc::new(Served::new());
    let mut owner = served.browser();
    owner.command("take-control").unwrap();
    owner.command("arm").unwrap();
    owner.command("start").unwrap();
    owner.wait_for_state(&["run"]);
    let mut page = served.browser();
    page.wait_for_state(&["run"]);
    let flood = flood(served.clone());
    std::thread::sleep(duration() / 4);
    let began = Instant::now();
    let reply = stop(&mut page);
    page.wait_for_state(&["stop", "parked"]);
    let acts = began.elapsed();
    println!("{name}: the machine stops after {acts:?}, reply {reply:?}");
    assert!(
        reply.min(acts) <= STOPS_WITHIN,
        "{name}: the stop acts after {acts:?}"
    );
    check_stops(name, &served, &mut page);
    // The server serves new pages again, and the owner's page was not disconnected.
    drop(flood);
    let mut new = loop {
        match served.try_browser() {
            Some(new) => break new,
            // The pages of the flood have just left.
            None => std::thread::sleep(Duration::from_millis(10)),
        }
    };
    new.wait(|report| report["type"] == "hello");
    owner.wait_for_state(&["parked"]);
}

/// Connects a page; none if the server has no room for it.
fn page(served: &Served) -> Option<Browser> {
    let page = served.try_browser()?;
    let stream = page.socket.get_ref();
    stream
        .set_write_timeout(Some(Duration::from_millis(100)))
        .unwrap();
    Some(page)
}

/// Sends a request without a wait for its reply. Returns none if the server has disconnected the page, or takes no more from it.
fn send(page: &mut Browser, request: &Value) -> Option<()> {
    page.socket.send(Message::text(request.to_string())).ok()
}

#[test]
fn a_stop_acts_during_a_flood_of_requests() {
    stop_during("requests", |served| {
        Flood::new(
            4,
            move || page(&served),
            |page| {
                send(page, &json!({ "id": 1, "request": "take-control" }))?;
                send(page, &json!({ "id": 2, "request": "jog" }))
            },
        )
    });
}

#[test]
fn a_stop_acts_during_a_flood_of_programs_to_check() {
    // A long scene, and one whose number of axes has no bound.
    let long = format!("{SCENE}{}", "# a comment of some length\n".repeat(16_000));
    let many = cophase_scene::library::find("five-bar").unwrap().text;
    let many = many.replace("count = 2", "count = 9223372036854775807");
    assert!(many.contains("9223372036854775807"));
    stop_during("programs", |served| {
        Flood::new(
            4,
            move || page(&served),
            move |page| {
                for text in [&long, &many] {
                    send(page, &json!({ "id": 1, "request": "load", "text": text }))?;
                }
                Some(())
            },
        )
    });
}

#[test]
fn a_stop_acts_during_a_flood_of_sockets_without_the_token() {
    stop_during("sockets", |served| {
        let host = served.host();
        Flood::new(
            4,
            || Some(Vec::new()),
            move |open: &mut Vec<TcpStream>| {
                // Half of a head, and then nothing more.
                let mut stream = TcpStream::connect(&host).ok()?;
                let _ = stream.write_all(b"GET /socket HTTP/1.1\r\nHost:");
                open.push(stream);
                (open.len() < 100).then_some(())
            },
        )
    });
}

#[test]
fn a_stop_acts_during_a_flood_of_pings_and_fragments() {
    stop_during("frames", |served| {
        Flood::new(
            4,
            move || page(&served),
            |page| {
                let fragment = |opcode, payload: &'static [u8]| {
                    let header = FrameHeader {
                        is_final: false,
                        opcode: OpCode::Data(opcode),
                        mask: Some([1, 2, 3, 4]),
                        ..FrameHeader::default()
                    };
                    Message::Frame(Frame::from_payload(header, payload.into()))
                };
                for _ in 0..100 {
                    page.socket.send(Message::Ping("ping".into())).ok()?;
                }
                page.socket.send(fragment(Data::Text, b"{")).ok()?;
                for _ in 0..10_000 {
                    page.socket.send(fragment(Data::Continue, b" ")).ok()?;
                    page.socket.send(fragment(Data::Continue, b"")).ok()?;
                }
                // The message never ends, so the page begins again.
                None
            },
        )
    });
}

#[test]
fn a_stop_acts_while_pages_join_leave_and_read_nothing() {
    stop_during("pages", |served| {
        let leaves = AtomicBool::new(false);
        let leaves = Arc::new(leaves);
        Flood::new(
            10,
            move || Some((page(&served)?, leaves.fetch_not(Ordering::Relaxed))),
            |(_, leaves)| {
                // Nothing is read. Every second page leaves at once.
                std::thread::sleep(Duration::from_millis(10));
                (!*leaves).then_some(())
            },
        )
    });
}

/// The machine of this controller is no simulation: its replies are those of the test.
#[test]
fn a_stop_reaches_a_controller_that_floods_events() {
    let _turn = turn();
    let mut number = 0;
    let (to, log) = controller::serve(
        Stored::new(SCENE),
        |stored, request| match request {
            // There is always one more event.
            Request::Events { from } => {
                let event = |i| EventRecord {
                    number: from.wrapping_add(i),
                    tick: 0,
                    event: Event::Missed(i),
                };
                Some(Ok(ReplyBody::Events((0..8).map(event).collect())))
            }
            _ => stored.answer(request),
        },
        move |stream| {
            for _ in 0..200 {
                number += 1;
                let event = EventRecord {
                    number,
                    tick: number,
                    event: Event::Missed(number),
                };
                controller::send(stream, number as u16, &LinkMessage::Event(event))?;
            }
            Ok(())
        },
    );
    let served = Served::of(&to);
    let mut page = served.browser();
    check_stops("events", &served, &mut page);
    let log = log.lock().unwrap();
    assert!(log.iter().any(|(name, _)| name.starts_with("Stop")));
}

/// If this fails, a stop waits for the reply to a request of another page.
#[test]
fn a_stop_overtakes_a_request_that_gets_no_reply() {
    let _turn = turn();
    let (to, _) = controller::serve(
        Stored::new(SCENE),
        |stored, request| match request {
            Request::Start => None,
            _ => stored.answer(request),
        },
        |_| Ok(()),
    );
    let served = Served::of(&to);
    let (mut owner, mut page) = (served.browser(), served.browser());
    owner.command("take-control").unwrap();
    let start = json!({ "id": 100, "request": "start" }).to_string();
    let arm = json!({ "id": 101, "request": "arm" }).to_string();
    owner.socket.send(Message::text(start)).unwrap();
    owner.socket.send(Message::text(arm)).unwrap();
    std::thread::sleep(Duration::from_millis(100));
    let took = stop(&mut page);
    assert!(took <= STOPS_WITHIN, "the stop took {took:?}");
    let error = |reply: Value| reply["error"].as_str().unwrap().to_owned();
    let lost = error(owner.wait(|report| report["id"] == 100));
    assert!(lost.contains("the machine may be running"), "{lost}");
    // What waited when the stop came is not carried out after it.
    let discarded = error(owner.wait(|report| report["id"] == 101));
    assert!(discarded.contains("a stop came after"), "{discarded}");
}
