//! Frames, which separate messages and make damage detectable.
//!
//! A frame is `COBS(number | payload | CRC-32) 0`. The zero ends it, and COBS removes all other zeros, so that a receiver
//! finds the next frame after any damage. The number has two bytes and counts the frames of one direction: a gap shows
//! how many frames were lost. The CRC-32 is that of Ethernet, over number and payload, little-endian.

use crate::FRAME_CRC;

/// Greatest length of a payload, bytes.
pub const MAX_PAYLOAD_BYTES: usize = 480;

const NUMBER_BYTES: usize = 2;
const CRC_BYTES: usize = 4;
const MAX_PLAIN_BYTES: usize = NUMBER_BYTES + MAX_PAYLOAD_BYTES + CRC_BYTES;

/// Greatest length of a frame with its final zero, bytes.
pub const MAX_FRAME_BYTES: usize = cobs::max_encoding_length(MAX_PLAIN_BYTES) + 1;

/// Encodes a frame at the beginning of `buffer`, and returns its length. `fill` writes the payload and returns its
/// length, or none if it does not fit.
pub fn encode(
    number: u16,
    buffer: &mut [u8; MAX_FRAME_BYTES],
    fill: impl FnOnce(&mut [u8]) -> Option<usize>,
) -> Option<usize> {
    let mut plain = [0; MAX_PLAIN_BYTES];
    plain[..NUMBER_BYTES].copy_from_slice(&number.to_le_bytes());
    let room = &mut plain[NUMBER_BYTES..NUMBER_BYTES + MAX_PAYLOAD_BYTES];
    let end = NUMBER_BYTES + fill(room)?;
    let (body, rest) = plain.split_at_mut(end);
    let crc = FRAME_CRC.checksum(body);
    rest.get_mut(..CRC_BYTES)?
        .copy_from_slice(&crc.to_le_bytes());
    let length = cobs::try_encode(&plain[..end + CRC_BYTES], buffer).ok()?;
    *buffer.get_mut(length)? = 0;
    Some(length + 1)
}

/// Frames that a receiver counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameCounts {
    /// Intact frames.
    pub good: u32,
    /// Damaged frames: wrong CRC, wrong coding, or too long.
    pub bad: u32,
    /// Missing frames, found from gaps in the numbers of intact frames. Damaged frames are included.
    pub missing: u32,
}

/// Receiver of frames, byte by byte.
#[derive(Clone, Debug)]
pub struct Receiver {
    buffer: [u8; MAX_FRAME_BYTES],
    /// Bytes of the present frame. The number exceeds the buffer if the frame is too long.
    length: usize,
    next: Option<u16>,
    counts: FrameCounts,
}

impl Receiver {
    /// Creates a receiver at the beginning of a frame.
    pub const fn new() -> Self {
        Self {
            buffer: [0; MAX_FRAME_BYTES],
            length: 0,
            next: None,
            counts: FrameCounts {
                good: 0,
                bad: 0,
                missing: 0,
            },
        }
    }

    /// Frames so far.
    pub const fn counts(&self) -> FrameCounts {
        self.counts
    }

    /// Takes one byte. Returns the number and the payload of the frame that the byte ends, if the frame is intact.
    pub fn push(&mut self, byte: u8) -> Option<(u16, &[u8])> {
        if byte != 0 {
            if let Some(place) = self.buffer.get_mut(self.length) {
                *place = byte;
                self.length += 1;
            } else {
                self.length = MAX_FRAME_BYTES + 1;
            }
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if length == 0 {
            return None; // Several zeros between two frames are allowed.
        }
        let intact = self.buffer.get_mut(..length).and_then(check);
        let Some((number, end)) = intact else {
            self.counts.bad = self.counts.bad.wrapping_add(1);
            return None;
        };
        let expected = self.next.unwrap_or(number);
        let missing = u32::from(number.wrapping_sub(expected));
        self.next = Some(number.wrapping_add(1));
        self.counts.missing = self.counts.missing.wrapping_add(missing);
        self.counts.good = self.counts.good.wrapping_add(1);
        Some((number, self.buffer.get(NUMBER_BYTES..end)?))
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

/// Decodes a frame without its final zero in place; returns its number and the end of its payload.
fn check(frame: &mut [u8]) -> Option<(u16, usize)> {
    let length = cobs::decode_in_place(frame).ok()?;
    let (body, crc) = frame.get(..length)?.split_last_chunk::<CRC_BYTES>()?;
    let number = body.first_chunk::<NUMBER_BYTES>()?;
    // COBS adds less to some frames than to others, so that a longer one may still fit the buffer.
    let fits = body.len() <= NUMBER_BYTES + MAX_PAYLOAD_BYTES;
    let is_intact = fits && FRAME_CRC.checksum(body) == u32::from_le_bytes(*crc);
    is_intact.then_some((u16::from_le_bytes(*number), body.len()))
}
