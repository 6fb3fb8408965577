//! A file that a host writes, part by part.

use crate::message::{File, Refusal};
use crate::{CRC, MAX_FILE_BYTES};

#[derive(Debug)]
pub(super) struct Upload {
    bytes: heapless::Vec<u8, MAX_FILE_BYTES>,
    expected: Option<Expected>,
}

#[derive(Clone, Copy, Debug)]
struct Expected {
    session: usize,
    file: File,
    length: u32,
    crc: u32,
}

impl Upload {
    #[inline(always)] // as `Hub::new`
    pub(super) const fn new() -> Self {
        Self {
            bytes: heapless::Vec::new(),
            expected: None,
        }
    }

    pub(super) fn begin(
        &mut self,
        session: usize,
        file: File,
        length: u32,
        crc: u32,
    ) -> Result<(), Refusal> {
        let max = MAX_FILE_BYTES as u32;
        if length > max {
            return Err(Refusal::TooLong { length, max });
        }
        self.bytes.clear();
        self.expected = Some(Expected {
            session,
            file,
            length,
            crc,
        });
        Ok(())
    }

    pub(super) fn write(
        &mut self,
        session: usize,
        offset: u32,
        bytes: &[u8],
    ) -> Result<(), Refusal> {
        let Expected { length, .. } = self.expected(session)?;
        let expected = self.bytes.len() as u32;
        // A part that is repeated because its reply was lost is accepted.
        if offset.checked_add(bytes.len() as u32) == Some(expected) {
            return Ok(());
        }
        if offset != expected {
            return Err(Refusal::Offset { expected });
        }
        let max = length - expected;
        if bytes.len() as u32 > max || self.bytes.extend_from_slice(bytes).is_err() {
            let length = expected + bytes.len() as u32;
            return Err(Refusal::TooLong {
                length,
                max: expected + max,
            });
        }
        Ok(())
    }

    /// Returns the file if it is complete and intact. A complete file ends the upload, intact or not.
    pub(super) fn finish(&mut self, session: usize) -> Result<(File, &[u8]), Refusal> {
        let Expected {
            file, length, crc, ..
        } = self.expected(session)?;
        let expected = self.bytes.len() as u32;
        if expected != length {
            return Err(Refusal::Offset { expected });
        }
        self.expected = None;
        let found = CRC.checksum(&self.bytes);
        if found != crc {
            return Err(Refusal::FileCrc { found });
        }
        Ok((file, &self.bytes))
    }

    fn expected(&self, session: usize) -> Result<Expected, Refusal> {
        self.expected
            .filter(|expected| expected.session == session)
            .ok_or(Refusal::NotWriting)
    }
}
