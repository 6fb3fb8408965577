//! The firmware's log: from the bytes of the RTT channel to lines, by defmt's own decoder and the format
//! strings in the ELF file.
//!
//! Words: a *frame* is the bytes of one log statement. With the encoding `rzcobs` frames end at a zero
//! byte, so the next frame after a broken one is found again. With `raw` nothing after a broken frame can
//! be read.

mod line;
mod stamps;

pub use stamps::Stamps;

use std::io::Write;
use std::path::Path;

use defmt_decoder::{DecodeError, Encoding, Frame, Locations, Table};

use crate::error::{self, Error};
use line::Line;

/// Result of decoding a stream of bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Frames that were decoded.
    pub frames: usize,
    /// Frames that do not match the formats in the ELF.
    pub malformed: usize,
    /// Bytes at the end that are not a whole frame, or that follow a broken frame of `raw`.
    pub left_over: usize,
}

/// Decodes `bytes`, passes each frame to `take` with the offset just after its last byte, and returns a
/// summary.
///
/// # Errors
/// Every error of `take`.
pub fn decode<E>(
    table: &Table,
    bytes: &[u8],
    mut take: impl FnMut(&Frame<'_>, usize) -> Result<(), E>,
) -> Result<Found, E> {
    let mut found = Found::default();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &bytes[at..];
        let length = match table.encoding() {
            Encoding::Rzcobs => rest.iter().position(|&byte| byte == 0).map(|zero| zero + 1),
            _ => match table.decode(rest) {
                Ok((_, consumed)) => Some(consumed),
                Err(DecodeError::UnexpectedEof) => None,
                Err(DecodeError::Malformed) => {
                    found.malformed += 1;
                    None
                }
            },
        };
        let Some(length) = length else {
            found.left_over = rest.len();
            break;
        };
        at += length;
        if rest[..length] == [0] {
            continue; // zero bytes between frames have no content
        }
        let mut decoder = table.new_stream_decoder();
        decoder.received(&rest[..length]);
        match decoder.decode() {
            Ok(frame) => {
                found.frames += 1;
                take(&frame, at)?;
            }
            Err(_) => found.malformed += 1,
        }
    }
    Ok(found)
}

/// The command: prints the log of `elf` that is in `bytes`, a line a frame.
///
/// False if there were bytes and none of them could be decoded.
///
/// # Errors
/// Files that cannot be read; an ELF file without defmt, or with another version of it.
pub fn print(
    elf_path: &Path,
    bytes_path: &Path,
    stamps_path: Option<&Path>,
    json: bool,
) -> Result<bool, Error> {
    let elf = error::read(elf_path)?;
    let table = Table::parse(&elf)
        .map_err(|error| Error::content(elf_path, error))?
        .ok_or_else(|| Error::content(elf_path, "has no .defmt section, so it logs nothing"))?;
    // Without debug information there are no locations. The lines are still useful.
    let locations = table.get_locations(&elf).unwrap_or_else(|error| {
        eprintln!("firmware-inspect: no locations: {error}");
        Locations::new()
    });
    let bytes = error::read(bytes_path)?;
    let mut stamps = stamps_path
        .map(|path| Stamps::parse(&error::read_text(path)?, path))
        .transpose()?;

    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let found = decode(&table, &bytes, |frame, end| {
        let cycle = stamps.as_mut().and_then(|stamps| stamps.of_byte(end - 1));
        let line = Line::new(frame, cycle, &locations);
        if json {
            serde_json::to_writer(&mut out, &line).map_err(std::io::Error::from)?;
            writeln!(out)
        } else {
            writeln!(out, "{line}")
        }
    })?;
    out.flush()?;
    if found.malformed > 0 {
        eprintln!(
            "firmware-inspect: {} malformed frames were skipped",
            found.malformed
        );
    }
    if found.left_over > 0 {
        eprintln!(
            "firmware-inspect: the last {} bytes are no whole frame",
            found.left_over
        );
    }
    if found.frames == 0 && !bytes.is_empty() {
        eprintln!(
            "firmware-inspect: none of {} bytes could be decoded",
            bytes.len()
        );
        return Ok(false);
    }
    Ok(true)
}
