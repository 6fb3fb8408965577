//! From settings to a blob and back.

use cophase_core::program::CAPACITY;
use cophase_core::settings::{MAX_BANDS, NAME_BYTES, Settings};
use cophase_core::units::MAX_AXES;

use crate::header::{HEADER_BYTES, Header};
use crate::{BlobError, CRC};

/// Format of the payload that is written and read here. Whatever changes the bytes of a [`Settings`] changes it.
pub const VERSION: u16 = 2;

/// Longest payload, bytes: the name as long, lists as full, and numbers of variable length as great as can be.
pub const MAX_PAYLOAD_BYTES: usize = {
    const F64: usize = 8;
    const U32: usize = 5; // seven bits a byte
    const SMALL: usize = 1; // a flag, a variant, a length below 128
    let name = SMALL + NAME_BYTES;
    let machine = 5 * F64 + SMALL;
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

/// The settings in a blob.
///
/// Its numbers are whatever was written; [`Settings::controller`] checks them. On a board this takes up to 36 KiB of
/// stack: settings has 5 KiB, and passes through several hands.
///
/// # Errors
/// Anything but exactly one whole blob of this version. Never panics, whatever the bytes.
pub fn decode(blob: &[u8]) -> Result<Settings, BlobError> {
    verify(blob)?;
    let (settings, rest) =
        postcard::take_from_bytes(&blob[HEADER_BYTES..]).map_err(|_| BlobError::Unreadable)?;
    match count(rest.len()) {
        0 => Ok(settings),
        bytes => Err(BlobError::Trailing { bytes }),
    }
}

/// For messages: no blob, and no flash, is near 4 GiB.
fn count(bytes: usize) -> u32 {
    u32::try_from(bytes).unwrap_or(u32::MAX)
}
