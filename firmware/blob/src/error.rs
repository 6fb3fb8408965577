//! Why bytes are not a blob.

use crate::codec::{MAX_BLOB_BYTES, MAX_PAYLOAD_BYTES, VERSION};
use crate::header::HEADER_BYTES;

/// What is wrong with a blob, and what would be right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[allow(
    missing_docs,
    reason = "each variant's message says what it and its numbers mean"
)]
pub enum BlobError {
    #[error(
        "{bytes} bytes are fewer than the {} of a blob's header; give all that `cophase image` wrote",
        HEADER_BYTES
    )]
    TooShort { bytes: u32 },
    #[error(
        "this is no blob: it does not begin with COPHASE and a zero; give what `cophase image` wrote"
    )]
    NotABlob,
    #[error(
        "the header has CRC-32 {found:#010x}, and should have {said:#010x}; write the blob again"
    )]
    HeaderCrc { said: u32, found: u32 },
    #[error(
        "the blob has format version {found}, and version {} is read here; make it again with the `cophase` of the same version as the image",
        VERSION
    )]
    Version { found: u16 },
    #[error(
        "a payload of {said} bytes is longer than any of this version, {} bytes; make the blob again",
        MAX_PAYLOAD_BYTES
    )]
    TooLong { said: u32 },
    #[error("the payload ends after {here} of {said} bytes; write the whole blob")]
    Cut { said: u32, here: u32 },
    #[error(
        "the payload has CRC-32 {found:#010x}, and should have {said:#010x}; write the blob again"
    )]
    PayloadCrc { said: u32, found: u32 },
    #[error(
        "the payload is whole, but not settings of format version {}; make the blob again",
        VERSION
    )]
    Unreadable,
    #[error("{bytes} bytes too many follow the settings; give only what `cophase image` wrote")]
    Trailing { bytes: u32 },
    #[error(
        "a buffer of {bytes} bytes is too small for this blob; {} bytes hold any",
        MAX_BLOB_BYTES
    )]
    NoRoom { bytes: u32 },
}
