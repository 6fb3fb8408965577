//! What a Cophase image is told, as bytes: a *blob*.
//!
//! A blob is a [`Settings`] behind a header. `cophase image` makes one of a scene; an image has one built in, and
//! keeps one in its flash.
//!
//! - *Header*: one page that says what follows and how to find out whether it is whole ([`header`]). Its layout
//!   is for ever, so that any image can tell a blob of any version from rubbish.
//! - *Payload*: the settings, in [postcard](https://postcard.jamesmunns.com/)'s wire format ([`codec`]). This is what
//!   has a version.
//! - *Slot*: one of two places in flash that hold a blob each ([`store`], at [`layout`]'s offsets).
//! - *Origin*: who is responsible for a stored blob: somebody outside, or the image with a certain built-in one.
//!
//! That a blob is whole says nothing about its numbers. They are checked like a scene's, when the controller is
//! made ([`Settings::controller`]).
//!
//! What the board is able to run is in [`board`].
//!
//! `docs/settings-file.md` has the format as a table.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod board;
pub mod codec;
mod error;
pub mod header;
pub mod layout;
pub mod store;

pub use codec::{MAX_BLOB_BYTES, decode, decode_into, encode, verify};
pub use cophase_core::settings::Settings;
pub use error::BlobError;
pub use header::Header;
pub use store::{Choice, Newest, Slot, Store, StoreError, choose, inspect};

/// CRC-32 as zip and Ethernet have it. Without a table: a blob is read once, and the table would be 1 KiB.
const CRC: crc::Crc<u32, crc::NoTable> = crc::Crc::<u32, crc::NoTable>::new(&crc::CRC_32_ISO_HDLC);
