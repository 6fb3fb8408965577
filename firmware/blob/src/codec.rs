//! From settings to a blob and back.

use cophase_core::program::CAPACITY;
use cophase_core::settings::{MAX_BANDS, NAME_BYTES, Settings};
use cophase_core::units::MAX_AXES;
use serde::Deserialize;

use crate::header::{HEADER_BYTES, Header};
use crate::{BlobError, CRC};

/// Format of the payload that is written and read here. Whatever changes the bytes of a [`Settings`] changes it.
pub const VERSION: u16 = 3;

/// Longest payload, bytes: the name as long, lists as full, and numbers of variable length as great as can be.
pub const MAX_PAYLOAD_BYTES: usize = {
    const F64: usize = 8;
    const U32: usize = 5; // seven bits a byte
    const SMALL: usize = 1; // a flag, a variant, a length below 128
    let name = SMALL + NAME_BYTES;
    let machine = 5 * F64 + 2 * SMALL;
    let limits = 6 * F64 + SMALL + MAX_BANDS * 2 * F64;
    let pulse = 3 * F64;
    let index_width = F64;
    let index = (SMALL + F64) + 2 * F64;
    let axis = SMALL + U32 + SMALL + 2 * U32 + F64 + index + SMALL + U32 + 3 * F64;
    let axes = SMALL + MAX_AXES * axis;
    let trims = SMALL + MAX_AXES * F64;
    let drift = 5 * F64;
    let correction = 3 * F64 + SMALL;
    let park_settle = 2 * F64;
    let segment = SMALL + 3 * F64 + SMALL;
    let program = 2 * SMALL + CAPACITY * segment;
    name + U32
        + machine
        + limits
        + pulse
        + index_width
        + axes
        + trims
        + drift
        + correction
        + park_settle
        + program
};

/// Longest blob, bytes.
pub const MAX_BLOB_BYTES: usize = HEADER_BYTES + MAX_PAYLOAD_BYTES;

/// Writes settings as a blob into the beginning of `buffer`, and gives that part of it.
///
/// `origin` is [`OUTSIDE`](crate::header::OUTSIDE) or a [`Header::mark`].
///
/// # Errors
/// The buffer is too small; one of [`MAX_BLOB_BYTES`] never is.
pub fn encode<'a>(
    settings: &Settings,
    sequence: u32,
    origin: u32,
    buffer: &'a mut [u8],
) -> Result<&'a [u8], BlobError> {
    let no_room = BlobError::NoRoom {
        bytes: count(buffer.len()),
    };
    let (page, rest) = buffer
        .split_first_chunk_mut::<HEADER_BYTES>()
        .ok_or(no_room)?;
    let payload = postcard::to_slice(settings, rest).map_err(|_| no_room)?;
    let header = Header {
        version: VERSION,
        length: count(payload.len()),
        sequence,
        origin,
        payload_crc: CRC.checksum(payload),
    };
    *page = header.page();
    let bytes = HEADER_BYTES + payload.len();
    Ok(&buffer[..bytes])
}

/// That `blob` is a whole blob of this version, and nothing else; its settings has not been looked at.
///
/// # Errors
/// What is wrong with it.
pub fn verify(blob: &[u8]) -> Result<Header, BlobError> {
    let header = Header::read(blob)?;
    if header.version != VERSION {
        return Err(BlobError::Version {
            found: header.version,
        });
    }
    if header.length as usize > MAX_PAYLOAD_BYTES {
        return Err(BlobError::TooLong {
            said: header.length,
        });
    }
    verify_payload(&header, blob)?;
    match count(blob.len()) - header.blob_bytes() {
        0 => Ok(header),
        bytes => Err(BlobError::Trailing { bytes }),
    }
}

/// That the payload behind a header that has been read is whole; bytes after it are not looked at.
pub(crate) fn verify_payload(header: &Header, blob: &[u8]) -> Result<(), BlobError> {
    let rest = blob.get(HEADER_BYTES..).unwrap_or_default();
    let Some(payload) = rest.get(..header.length as usize) else {
        return Err(BlobError::Cut {
            said: header.length,
            here: count(rest.len()),
        });
    };
    let found = CRC.checksum(payload);
    if found != header.payload_crc {
        return Err(BlobError::PayloadCrc {
            said: header.payload_crc,
            found,
        });
    }
    Ok(())
}

/// The settings in a blob. See [`decode_into`].
///
/// # Errors
/// Anything but exactly one whole blob of this version. Never panics, whatever the bytes.
pub fn decode(blob: &[u8]) -> Result<Settings, BlobError> {
    let mut settings = Settings::new();
    decode_into(blob, &mut settings)?;
    Ok(settings)
}

/// Reads the settings in a blob into a place for them.
///
/// The numbers are whatever was written; `Controller::configure` checks them. Settings have 5 KiB, of which the program is the
/// greatest part. So they are read field by field, and the program entry by entry: a board's stack need not hold them twice.
///
/// # Errors
/// Anything but exactly one whole blob of this version. The settings are then a mixture of old and new. Never panics, whatever the
/// bytes.
#[inline(never)]
pub fn decode_into(blob: &[u8], settings: &mut Settings) -> Result<(), BlobError> {
    verify(blob)?;
    let mut payload = Payload(&blob[HEADER_BYTES..]);
    // In the order of the fields, which is that in which `encode` writes them.
    let Settings {
        name,
        tick_hz,
        machine,
        limits,
        pulse,
        index,
        axes,
        trims_turns,
        drift,
        correction,
        park_turns,
        settle_s,
        program,
    } = settings;
    *name = payload.take()?;
    *tick_hz = payload.take()?;
    *machine = payload.take()?;
    *limits = payload.take()?;
    *pulse = payload.take()?;
    *index = payload.take()?;
    payload.take_list(axes)?;
    payload.take_list(trims_turns)?;
    *drift = payload.take()?;
    *correction = payload.take()?;
    *park_turns = payload.take()?;
    *settle_s = payload.take()?;
    payload.take_list(program)?;
    match count(payload.0.len()) {
        0 => Ok(()),
        bytes => Err(BlobError::Trailing { bytes }),
    }
}

/// The rest of a payload.
struct Payload<'a>(&'a [u8]);

impl<'a> Payload<'a> {
    fn take<T: Deserialize<'a>>(&mut self) -> Result<T, BlobError> {
        let (value, rest) = postcard::take_from_bytes(self.0).map_err(|_| BlobError::Unreadable)?;
        self.0 = rest;
        Ok(value)
    }

    /// A list: its length, and so many values.
    fn take_list<T: Deserialize<'a>, const N: usize>(
        &mut self,
        list: &mut heapless::Vec<T, N>,
    ) -> Result<(), BlobError> {
        list.clear();
        for _ in 0..self.take::<u32>()? {
            list.push(self.take()?).map_err(|_| BlobError::Unreadable)?;
        }
        Ok(())
    }
}

/// For messages: no blob, and no flash, is near 4 GiB.
fn count(bytes: usize) -> u32 {
    u32::try_from(bytes).unwrap_or(u32::MAX)
}
