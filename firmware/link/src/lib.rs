//! Data that a Cophase controller stores, or exchanges with a host.
//!
//! **The host link**, without any input or output of its own: [`frame`], [`message`] and [`sample`] define the bytes that are sent.
//! [`server`] is the controller's side, and [`client`] the host's. Both know by [`Condition`] in which states a request is possible.
//! [`program`] is the file of a program, and [`watch`] makes events of changes in the loop. `docs/link.md` describes the protocol.
//!
//! **The settings file:** settings as bytes.
//!
//! A settings file is a [`Settings`] behind a header. `cophase settings` makes one from a scene. The firmware has one built
//! in, and keeps one in its flash.
//!
//! - *Header*: one page that describes the payload and lets a reader check that it is intact ([`header`]). Its layout
//!   never changes, so that any firmware can distinguish a settings file of any version from other bytes.
//! - *Payload*: the settings, in [postcard](https://postcard.jamesmunns.com/)'s wire format ([`codec`]). Its format has
//!   a version ([`file_format`]).
//! - *Slot*: one of two places in flash that hold a settings file each ([`store`], at the offsets of [`layout`]).
//! - *Origin*: source of a stored settings file: placed from outside, or stored by firmware with certain built-in settings.
//!
//! An intact settings file may still hold invalid numbers. They are checked like those of a scene, when the controller
//! is made ([`Settings::controller`]).
//!
//! [`board`] checks whether a board can run the settings. [`uf2`] is the file that places bytes in a board's flash by drag and
//! drop.
//!
//! `docs/settings-file.md` has the format as a table.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod board;
pub mod client;
pub mod codec;
mod condition;
mod error;
pub mod file_format;
pub mod frame;
pub mod header;
pub mod layout;
pub mod line;
pub mod message;
pub mod program;
pub mod sample;
pub mod server;
pub mod store;
pub mod uf2;
pub mod watch;

pub use codec::{decode, decode_into, encode, verify};
pub use condition::Condition;
pub use cophase_core::settings::Settings;
pub use error::SettingsFileError;
pub use file_format::MAX_FILE_BYTES;
pub use header::Header;
pub use store::{Choice, Newest, Slot, Store, StoreError, choose, inspect};

/// CRC-32 of a file, as requests and identities state it.
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// CRC-32 of frames: the same one with a table, as a stream has up to 100,000 bytes a second.
const FRAME_CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// CRC-32 of zip and Ethernet. It has no table: a settings file is read once, and the table would take 1 KiB.
const CRC: crc::Crc<u32, crc::NoTable> = crc::Crc::<u32, crc::NoTable>::new(&crc::CRC_32_ISO_HDLC);
