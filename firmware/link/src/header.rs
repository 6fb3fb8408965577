//! Header: the first page of a settings file.
//!
//! All numbers are little-endian. The last four bytes of the page are the CRC-32 of all bytes before them. Unused bytes
//! are 0xFF, as in erased flash, and are under the CRC too.
//!
//! In flash the header is written after its payload, in one page write. That write is the commit. The CRC does not
//! match in a page that was written or erased in part.

use crate::file_format::HEADER_BYTES;
use crate::{CRC, SettingsFileError};

/// First bytes of every settings file.
pub const MAGIC: [u8; 8] = *b"COPHASE\0";

/// Value of `origin` in a settings file that was placed from outside.
pub const OUTSIDE: u32 = 0;

/// Sequence number of a settings file that has not been stored yet.
pub const FIRST_SEQUENCE: u32 = 1;

const VERSION_AT: usize = 8;
const LENGTH_AT: usize = 12;
const SEQUENCE_AT: usize = 16;
const ORIGIN_AT: usize = 20;
const PAYLOAD_CRC_AT: usize = 24;
const HEADER_CRC_AT: usize = HEADER_BYTES - 4;

/// Contents of a settings file's header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    /// Format version of the payload.
    pub version: u16,
    /// Length of the payload, bytes.
    pub length: u32,
    /// Sequence number, which shows the newer of two stored files; see [`Header::is_newer_than`].
    pub sequence: u32,
    /// [`OUTSIDE`], or the [`Header::mark`] of the settings built into the firmware that stored the file.
    pub origin: u32,
    /// CRC-32 of the payload.
    pub payload_crc: u32,
}

impl Header {
    /// Reads the header of a settings file; later bytes are ignored.
    ///
    /// # Errors
    /// The bytes are too few, do not begin a settings file, or do not match their CRC. An unknown version is no error, as
    /// the header is the same in all versions.
    pub fn read(bytes: &[u8]) -> Result<Self, SettingsFileError> {
        if !bytes.starts_with(&MAGIC[..MAGIC.len().min(bytes.len())]) {
            return Err(SettingsFileError::NotASettingsFile);
        }
        let Some(page) = bytes.first_chunk::<HEADER_BYTES>() else {
            let bytes = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
            return Err(SettingsFileError::TooShort { bytes });
        };
        let (said, found) = (number(page, HEADER_CRC_AT), crc_of(page));
        if said != found {
            return Err(SettingsFileError::HeaderCrc { said, found });
        }
        Ok(Self {
            version: u16::from_le_bytes([page[VERSION_AT], page[VERSION_AT + 1]]),
            length: number(page, LENGTH_AT),
            sequence: number(page, SEQUENCE_AT),
            origin: number(page, ORIGIN_AT),
            payload_crc: number(page, PAYLOAD_CRC_AT),
        })
    }

    /// Encodes the header as a page.
    pub fn page(&self) -> [u8; HEADER_BYTES] {
        let mut page = [0xFF; HEADER_BYTES];
        let mut put = |at: usize, bytes: &[u8]| page[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, &MAGIC);
        put(VERSION_AT, &self.version.to_le_bytes());
        put(LENGTH_AT, &self.length.to_le_bytes());
        put(SEQUENCE_AT, &self.sequence.to_le_bytes());
        put(ORIGIN_AT, &self.origin.to_le_bytes());
        put(PAYLOAD_CRC_AT, &self.payload_crc.to_le_bytes());
        let crc = crc_of(&page);
        page[HEADER_CRC_AT..].copy_from_slice(&crc.to_le_bytes());
        page
    }

    /// Length of header and payload together, bytes; saturates for an absurd length.
    pub const fn file_bytes(&self) -> u32 {
        self.length.saturating_add(HEADER_BYTES as u32)
    }

    /// Value of `origin` in files that firmware with these built-in settings stores. Never [`OUTSIDE`].
    pub const fn mark(&self) -> u32 {
        match self.payload_crc {
            OUTSIDE => 1,
            crc => crc,
        }
    }

    /// True if this file was stored after the other, provided that fewer than 2³¹ were stored between the two.
    ///
    /// Sequence numbers wrap. Of two files with numbers 2³¹ apart neither is newer.
    pub const fn is_newer_than(&self, other: &Self) -> bool {
        self.sequence.wrapping_sub(other.sequence).cast_signed() > 0
    }
}

fn number(page: &[u8; HEADER_BYTES], at: usize) -> u32 {
    u32::from_le_bytes([page[at], page[at + 1], page[at + 2], page[at + 3]])
}

fn crc_of(page: &[u8; HEADER_BYTES]) -> u32 {
    CRC.checksum(&page[..HEADER_CRC_AT])
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: Header = Header {
        version: 0x0102,
        length: 0x0304_0506,
        sequence: 0x0708_090A,
        origin: 0x0B0C_0D0E,
        payload_crc: 0x0F10_1112,
    };

    /// If this fails, firmware cannot read files of another version, or files as described in `docs/settings-file.md`.
    #[test]
    fn fields_lie_where_documented() {
        let page = HEADER.page();
        assert_eq!(page[..12], *b"COPHASE\0\x02\x01\xFF\xFF");
        assert_eq!(page[12..16], [0x06, 0x05, 0x04, 0x03]);
        assert_eq!(page[16..20], [0x0A, 0x09, 0x08, 0x07]);
        assert_eq!(page[20..24], [0x0E, 0x0D, 0x0C, 0x0B]);
        assert_eq!(page[24..28], [0x12, 0x11, 0x10, 0x0F]);
        assert!(page[28..252].iter().all(|&byte| byte == 0xFF));
        assert_eq!(Header::read(&page), Ok(HEADER));
    }

    /// Check value of this CRC in the catalogue of CRCs.
    #[test]
    fn the_crc_matches_the_catalogue_check_value() {
        assert_eq!(CRC.checksum(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn an_incomplete_header_is_refused_as_too_short() {
        let page = HEADER.page();
        for bytes in 0..HEADER_BYTES {
            let error = Header::read(&page[..bytes]).unwrap_err();
            let bytes = bytes as u32;
            assert_eq!(error, SettingsFileError::TooShort { bytes });
        }
        assert_eq!(
            Header::read(b"COPHASF"),
            Err(SettingsFileError::NotASettingsFile)
        );
        assert_eq!(
            Header::read(&[0xFF; 4096]),
            Err(SettingsFileError::NotASettingsFile),
            "erased flash"
        );
    }

    #[test]
    fn sequence_comparison_handles_the_wrap() {
        let at = |sequence| Header { sequence, ..HEADER };
        for (newer, older) in [(2, 1), (0, u32::MAX), (5, u32::MAX - 5), (1 << 31, 1)] {
            assert!(at(newer).is_newer_than(&at(older)), "{newer} {older}");
            assert!(!at(older).is_newer_than(&at(newer)), "{newer} {older}");
        }
        for other in [7, 7 + (1 << 31)] {
            assert!(!at(7).is_newer_than(&at(other)) && !at(other).is_newer_than(&at(7)));
        }
    }

    #[test]
    fn built_in_files_never_have_the_outside_mark() {
        for payload_crc in [0, 1, 0xFFFF_FFFF] {
            assert_ne!(
                Header {
                    payload_crc,
                    ..HEADER
                }
                .mark(),
                OUTSIDE
            );
        }
    }
}
