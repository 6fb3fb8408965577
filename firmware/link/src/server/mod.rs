//! The controller's side of the link, without any input or output of its own.
//!
//! A [`Hub`] serves a fixed number of *sessions*, one for each line (USB, UART, a TCP connection). Bytes that arrive go
//! into [`Hub::receive`], and bytes to send come out of [`Hub::transmit`]. [`Hub::move_one`] moves samples and events from
//! the loop to the sessions, and [`Hub::check_times`] does what is due. The [`Device`] is the controller as the hub needs it: firmware and
//! simulator each have one.
//!
//! One session has *control* at a time. Requests that change anything need it; a stop needs nothing. Motion needs two
//! steps: a request that arms, and within [`ARMED_S`] a start, home or jog. The loop itself checks every command again,
//! and keeps its limits. So nothing that arrives here can move an axis beyond a limit.

#![expect(
    clippy::result_large_err,
    reason = "a refusal holds its text, as there is no heap"
)]

mod access;
mod bring_up;
mod device;
mod host_loss;
mod requests;
mod session;
mod upload;

pub use access::{ARMED_S, UNLOCKED_S};
pub use bring_up::OUTPUT_MS;
pub use device::{Device, SettingsRefusal};

use cophase_core::supervisor::State;
use heapless::HistoryBuf;

use crate::message::{Event, EventRecord, FaultRecord, Message};
use crate::sample::{Sample, flags};
use access::Access;
use bring_up::HeldOutput;
use host_loss::HostWatch;
use session::Session;
use upload::Upload;

/// Events that the log keeps.
pub const EVENTS: usize = 64;

/// Samples a second for statuses while no stream needs more.
const STATUS_HZ: u32 = 100;

/// Server of all sessions of a controller.
#[derive(Debug)]
pub struct Hub<D, const SESSIONS: usize> {
    device: D,
    sessions: [Session; SESSIONS],
    access: Access,
    upload: Upload,
    host: HostWatch,
    held: HeldOutput,
    latest: Sample,
    events: HistoryBuf<EventRecord, EVENTS>,
    event_count: u32,
    /// Fault that latched, under its best name.
    fault: Option<FaultRecord>,
    missed_deadlines: u32,
    late_deadlines: u32,
}

impl<D: Device, const SESSIONS: usize> Hub<D, SESSIONS> {
    /// Server of a device, with all lines open and no host.
    #[inline(always)] // A server has kilobytes. Inlining lets the compiler write them in place.
    pub fn new(mut device: D) -> Self
    where
        [Session; SESSIONS]: Default,
    {
        device.set_sampling(status_ticks(device.tick_hz()));
        Self {
            device,
            // Constants would be copied, over the stack.
            sessions: <[Session; SESSIONS]>::default(),
            access: Access::new(),
            upload: Upload::new(),
            host: HostWatch::new(),
            held: HeldOutput::new(),
            latest: Sample::ZERO,
            events: HistoryBuf::new(),
            event_count: 0,
            fault: None,
            missed_deadlines: 0,
            late_deadlines: 0,
        }
    }

    /// The device.
    pub const fn device(&mut self) -> &mut D {
        &mut self.device
    }

    /// Takes bytes that arrived on a session's line, and answers the requests that they end.
    pub fn receive(&mut self, session: usize, bytes: &[u8]) {
        for &byte in bytes {
            let Some(line) = self.sessions.get_mut(session) else {
                return;
            };
            if let Some((number, received)) = line.receiver.push(byte) {
                // The payload is copied out of the receiver, as a request changes the session.
                let mut payload = [0; crate::frame::MAX_PAYLOAD_BYTES];
                let length = received.len();
                payload[..length].copy_from_slice(received);
                if self.access.has_control(session) {
                    self.host.is_there(self.device.now_ms());
                }
                self.answer(session, number, &payload[..length]);
            }
        }
    }

    /// True if there is room for the reply to another request. A line that can make its host wait does so until then.
    pub fn can_answer(&self, session: usize) -> bool {
        self.sessions.get(session).is_some_and(Session::has_room)
    }

    /// Takes the bytes to be sent on a session's line, at most as many as `bytes` holds; returns their number.
    pub fn transmit(&mut self, session: usize, bytes: &mut [u8]) -> usize {
        self.sessions
            .get_mut(session)
            .map_or(0, |line| line.transmit(bytes))
    }

    /// A host opened a session's line: streams and control of an earlier host end.
    pub fn connect(&mut self, session: usize) {
        if let Some(line) = self.sessions.get_mut(session) {
            line.restart();
        }
        self.access.release(session);
        self.choose_sampling();
    }

    /// A session's line was closed: bytes that wait are dropped. The machine continues unchanged.
    pub fn disconnect(&mut self, session: usize) {
        self.connect(session);
        if let Some(line) = self.sessions.get_mut(session) {
            line.drop_output();
        }
    }

    /// Moves samples and events from the loop to the sessions until none waits, then [checks the times](Self::check_times). For a host on
    /// which the loop does not run meanwhile.
    pub fn poll(&mut self) {
        while self.poll_one() {}
    }

    /// Moves at most one sample or event, as [`Self::move_one`]; returns false once none waits, after it has [checked the
    /// times](Self::check_times). A host in the same process fetches what is to be sent after each call, so that no session has more than its
    /// room.
    pub fn poll_one(&mut self) -> bool {
        let has_moved = self.move_one();
        if !has_moved {
            self.check_times();
        }
        has_moved
    }

    /// Moves at most one sample or event from the loop to the sessions; returns false if none waits. Samples may come as fast as they are
    /// moved, so the caller lets other work take its turn after each call.
    pub fn move_one(&mut self) -> bool {
        if let Some((tick, event)) = self.device.next_event() {
            self.log(tick, event);
            return true;
        }
        if let Some(sample) = self.device.next_sample() {
            self.take(&sample);
            return true;
        }
        false
    }

    /// Does what is due by now: limits in time end, a lost host stops the machine, and statuses are sent. To be called every few milliseconds,
    /// whatever waits.
    pub fn check_times(&mut self) {
        let now_ms = self.device.now_ms();
        self.access.expire(now_ms, &self.latest);
        self.react_to_host_loss(now_ms);
        self.release_output(now_ms);
        for session in 0..SESSIONS {
            if self.sessions[session].is_status_due(now_ms) {
                let status = self.status(session);
                self.sessions[session].send_stream(&Message::Status(status));
            }
        }
    }

    fn take(&mut self, sample: &Sample) {
        self.latest = *sample;
        if sample.flags & flags::FAULT == 0 {
            self.fault = None;
        }
        let (axes, tick_hz) = (self.device.axes(), self.device.tick_hz());
        for line in &mut self.sessions {
            line.stream(sample, axes, tick_hz);
        }
    }

    fn log(&mut self, tick: u32, event: Event) {
        match event {
            Event::Missed(all) => self.missed_deadlines = all,
            Event::Fault(fault) => self.fault = Some(fault),
            Event::State(state) => self.host.entered(state_of(state)),
            Event::Late(all) => self.late_deadlines = all,
            _ => {}
        }
        let record = EventRecord {
            number: self.event_count,
            tick,
            event,
        };
        self.event_count = self.event_count.wrapping_add(1);
        self.events.write(record);
        for line in &mut self.sessions {
            line.event(&record);
        }
    }

    /// Sets the loop's rate of samples to the rate that all sessions need.
    fn choose_sampling(&mut self) {
        let lines = self.sessions.iter().filter_map(Session::stream_every);
        let every = lines.fold(status_ticks(self.device.tick_hz()), greatest_common_divisor);
        self.device.set_sampling(every);
    }

    const fn drives_are_on(&self) -> bool {
        self.latest.flags & flags::DRIVES != 0
    }
}

/// State of a number; idle if there is none.
fn state_of(number: u8) -> State {
    State::ALL
        .get(usize::from(number))
        .copied()
        .unwrap_or_default()
}

/// Ticks between two samples for statuses.
fn status_ticks(tick_hz: u32) -> u16 {
    u16::try_from(tick_hz / STATUS_HZ)
        .unwrap_or(u16::MAX)
        .max(1)
}

const fn greatest_common_divisor(mut a: u16, mut b: u16) -> u16 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
