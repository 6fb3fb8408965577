//! One line: received bytes, bytes to be sent, and the streams of its host.

use heapless::Deque;

use super::access::has_come;
use crate::frame::{self, MAX_FRAME_BYTES, MAX_PAYLOAD_BYTES, Receiver};
use crate::message::{EventRecord, Message};
use crate::sample::{Channels, Sample, pack};

/// Bytes that wait to be sent.
const OUT_BYTES: usize = 3 * MAX_FRAME_BYTES;

/// Room that streams leave for the reply to a request.
const RESERVED_BYTES: usize = MAX_FRAME_BYTES;

/// Bytes of a message of samples besides the packet itself.
const SAMPLES_HEADER_BYTES: usize = 20;

const PACKET_BYTES: usize = MAX_PAYLOAD_BYTES - SAMPLES_HEADER_BYTES;

/// Packets a second, at least, while samples arrive.
const PACKETS_HZ: u32 = 50;

#[derive(Debug)]
pub struct Session {
    pub(super) receiver: Receiver,
    /// The host has identified itself, and gets events.
    pub(super) is_known: bool,
    pub(super) refused: u32,
    pub(super) not_sent: u32,
    pub(super) samples_lost: u32,
    number: u16,
    out: Deque<u8, OUT_BYTES>,
    stream: Option<Stream>,
    status_ms: u16,
    next_status_ms: u32,
}

/// Samples that wait to be sent, and which of them the host selected.
#[derive(Debug)]
struct Stream {
    channels: Channels,
    every: u16,
    packet: heapless::Vec<u8, PACKET_BYTES>,
    first_tick: u32,
    count: u8,
    last: Sample,
    /// Tick of the next sample of this stream, once there was one.
    next_tick: Option<u32>,
}

impl Default for Session {
    #[inline(always)] // as `Hub::new`
    fn default() -> Self {
        Self {
            receiver: Receiver::new(),
            is_known: false,
            refused: 0,
            not_sent: 0,
            samples_lost: 0,
            number: 0,
            out: Deque::new(),
            stream: None,
            status_ms: 0,
            next_status_ms: 0,
        }
    }
}

impl Session {
    /// Discards the state of the host, as its bytes and streams have no meaning for the next one.
    pub(super) fn restart(&mut self) {
        self.receiver = Receiver::new();
        self.is_known = false;
        self.refused = 0;
        self.not_sent = 0;
        self.samples_lost = 0;
        self.number = 0;
        self.stream = None;
        self.status_ms = 0;
    }

    /// Drops the bytes that wait. Part of a frame may be on the line already: a zero ends it, so that the next reply is a frame of its own.
    pub(super) fn drop_output(&mut self) {
        self.out.clear();
        let _ = self.out.push_back(0);
    }

    pub(super) fn transmit(&mut self, bytes: &mut [u8]) -> usize {
        let count = bytes.len().min(self.out.len());
        for place in &mut bytes[..count] {
            *place = self.out.pop_front().unwrap_or_default();
        }
        count
    }

    pub(super) fn has_room(&self) -> bool {
        OUT_BYTES - self.out.len() >= MAX_FRAME_BYTES
    }

    /// Sends a reply. A reply that has no room is counted. The host has then not fetched earlier replies.
    pub(super) fn send(&mut self, message: &Message<'_>) {
        self.push(message, 0);
    }

    /// Sends a message of a stream, if that leaves room for a reply. A message that is not sent is counted, and its frame
    /// number is missing.
    pub(super) fn send_stream(&mut self, message: &Message<'_>) -> bool {
        self.push(message, RESERVED_BYTES)
    }

    fn push(&mut self, message: &Message<'_>, reserved: usize) -> bool {
        let number = self.number;
        self.number = number.wrapping_add(1);
        let mut frame = [0; MAX_FRAME_BYTES];
        let length = frame::encode(number, &mut frame, |payload| {
            Some(postcard::to_slice(message, payload).ok()?.len())
        });
        let room = OUT_BYTES - self.out.len();
        let Some(length) = length.filter(|length| length + reserved <= room) else {
            self.not_sent = self.not_sent.wrapping_add(1);
            return false;
        };
        for &byte in &frame[..length] {
            // There is room for it.
            let _ = self.out.push_back(byte);
        }
        true
    }

    pub(super) fn event(&mut self, record: &EventRecord) {
        if self.is_known {
            self.send_stream(&Message::Event(*record));
        }
    }

    pub(super) const fn stream_status(&mut self, period_ms: u16, now_ms: u32) {
        self.status_ms = period_ms;
        self.next_status_ms = now_ms;
    }

    pub(super) const fn is_status_due(&mut self, now_ms: u32) -> bool {
        if self.status_ms == 0 || !has_come(self.next_status_ms, now_ms) {
            return false;
        }
        self.next_status_ms = now_ms.wrapping_add(self.status_ms as u32);
        true
    }

    pub(super) fn select(&mut self, channels: Channels, every: u16) {
        self.samples_lost = 0;
        self.stream = (channels != 0).then(|| Stream {
            channels,
            every,
            packet: heapless::Vec::new(),
            first_tick: 0,
            count: 0,
            last: Sample::ZERO,
            next_tick: None,
        });
    }

    pub(super) fn stream_every(&self) -> Option<u16> {
        self.stream.as_ref().map(|stream| stream.every)
    }

    /// Takes a sample of the loop into the stream.
    pub(super) fn stream(&mut self, sample: &Sample, axes: usize, tick_hz: u32) {
        let Some(stream) = &mut self.stream else {
            return;
        };
        let every = u32::from(stream.every);
        if !sample.tick.is_multiple_of(every) {
            return;
        }
        let expected = stream.next_tick.unwrap_or(sample.tick);
        let gap = sample.tick.wrapping_sub(expected);
        stream.next_tick = Some(sample.tick.wrapping_add(every));
        self.samples_lost = self.samples_lost.wrapping_add(gap / every);
        // Samples of a packet follow each other without a gap.
        if gap != 0 || !self.append(sample, axes) {
            self.flush();
            self.append(sample, axes);
        }
        let waited = self.stream.as_ref().map_or(0, |stream| {
            sample
                .tick
                .wrapping_sub(stream.first_tick)
                .wrapping_add(every)
        });
        if waited * PACKETS_HZ >= tick_hz {
            self.flush();
        }
    }

    fn append(&mut self, sample: &Sample, axes: usize) -> bool {
        let Some(stream) = &mut self.stream else {
            return false;
        };
        let before = if stream.count == 0 {
            &Sample::ZERO
        } else {
            &stream.last
        };
        let fits = stream.count < u8::MAX
            && pack(sample, before, stream.channels, axes, &mut stream.packet);
        if fits {
            if stream.count == 0 {
                stream.first_tick = sample.tick;
            }
            stream.count += 1;
            stream.last = *sample;
        }
        fits
    }

    /// Sends the samples that wait. Samples that do not fit on the line are lost, and counted.
    fn flush(&mut self) {
        let Some(mut stream) = self.stream.take() else {
            return;
        };
        if stream.count > 0 {
            let is_sent = self.send_stream(&Message::Samples {
                tick: stream.first_tick,
                every: stream.every,
                channels: stream.channels,
                count: stream.count,
                packet: &stream.packet,
            });
            if !is_sent {
                let lost = u32::from(stream.count);
                self.samples_lost = self.samples_lost.wrapping_add(lost);
            }
        }
        stream.packet.clear();
        stream.count = 0;
        self.stream = Some(stream);
    }
}
