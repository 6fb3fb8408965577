//! Errors of bytes that are not a settings file.

use crate::file_format::{HEADER_BYTES, MAX_FILE_BYTES, MAX_PAYLOAD_BYTES, VERSION};

/// Problem with a settings file, and how to solve it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[allow(
    missing_docs,
    reason = "each variant's message says what it and its numbers mean"
)]
pub enum SettingsFileError {
    #[error(
        "{bytes} bytes are fewer than the {} of a settings file's header; give the whole file that `cophase settings` wrote",
        HEADER_BYTES
    )]
    TooShort { bytes: u32 },
    #[error(
        "this is not a settings file: it does not begin with COPHASE and a zero; give a file that `cophase settings` wrote"
    )]
    NotASettingsFile,
    #[error(
        "the header has CRC-32 {found:#010x}, and should have {said:#010x}; write the settings file again"
    )]
    HeaderCrc { said: u32, found: u32 },
    #[error(
        "the settings file has format version {found}, and version {} is read here; make it again with the `cophase` of the same version as the firmware",
        VERSION
    )]
    Version { found: u16 },
    #[error(
        "a payload of {said} bytes is longer than the longest of this version, {} bytes; make the settings file again",
        MAX_PAYLOAD_BYTES
    )]
    TooLong { said: u32 },
    #[error("the payload ends after {here} of {said} bytes; write the whole settings file")]
    Cut { said: u32, here: u32 },
    #[error(
        "the payload has CRC-32 {found:#010x}, and should have {said:#010x}; write the settings file again"
    )]
    PayloadCrc { said: u32, found: u32 },
    #[error(
        "the payload is intact, but not settings of format version {}; make the settings file again",
        VERSION
    )]
    Unreadable,
    #[error(
        "{bytes} extra bytes follow the settings; give only the file that `cophase settings` wrote"
    )]
    Trailing { bytes: u32 },
    #[error(
        "a buffer of {bytes} bytes is too small for these settings; {} bytes are always enough",
        MAX_FILE_BYTES
    )]
    NoRoom { bytes: u32 },
}
