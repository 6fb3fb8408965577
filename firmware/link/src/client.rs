//! The host's side of the link, without any input or output of its own.

use crate::frame::{self, FrameCounts, MAX_FRAME_BYTES, Receiver};
use crate::message::{Message, Request};

/// Encoder of requests and decoder of messages.
#[derive(Clone, Debug, Default)]
pub struct Client {
    receiver: Receiver,
    number: u16,
    unreadable: u32,
}

impl Client {
    /// Creates a client at the beginning of a connection.
    pub const fn new() -> Self {
        Self {
            receiver: Receiver::new(),
            number: 0,
            unreadable: 0,
        }
    }

    /// Encodes a request at the beginning of `frame`. Returns the number that its reply repeats, and the length, or
    /// none if the request does not fit in a frame.
    pub fn request(
        &mut self,
        request: &Request<'_>,
        frame: &mut [u8; MAX_FRAME_BYTES],
    ) -> Option<(u16, usize)> {
        let number = self.number;
        let length = frame::encode(number, frame, |payload| {
            Some(postcard::to_slice(request, payload).ok()?.len())
        })?;
        self.number = number.wrapping_add(1);
        Some((number, length))
    }

    /// Takes one byte from the line. Returns the message that the byte ends, if the message is intact.
    pub fn push(&mut self, byte: u8) -> Option<Message<'_>> {
        let (_, payload) = self.receiver.push(byte)?;
        match postcard::take_from_bytes(payload) {
            Ok((message, [])) => Some(message),
            _ => {
                self.unreadable = self.unreadable.wrapping_add(1);
                None
            }
        }
    }

    /// Frames so far.
    pub const fn counts(&self) -> FrameCounts {
        self.receiver.counts()
    }

    /// Intact frames that are no message of this protocol version.
    pub const fn unreadable(&self) -> u32 {
        self.unreadable
    }
}
