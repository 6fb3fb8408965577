//! Two slots in a simulated flash, and blobs to be stored there.

use cophase_blob::codec::VERSION;
use cophase_blob::header::HEADER_BYTES;
use cophase_blob::store::blob_in;
use cophase_blob::{Header, Newest, Slot, Store, StoreError, inspect};

use super::nor::{Nor, SECTOR};

pub const SLOT: usize = 2 * SECTOR;

/// The slots lie apart, and not at the flash's beginning, so that a mistaken offset is seen.
pub const A: usize = SECTOR;
pub const B: usize = A + SLOT + SECTOR;

/// A blob whose payload is `bytes` long and differs with `seed`. What it says is of no interest to a store.
pub fn blob(seed: usize, bytes: usize) -> Vec<u8> {
    let payload: Vec<u8> = (0..bytes)
        .map(|i| (i * 31 + seed * 7 + i / 256) as u8)
        .collect();
    let header = Header {
        version: VERSION,
        length: bytes as u32,
        sequence: 99,
        origin: 98,
        payload_crc: crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&payload),
    };
    [&header.page()[..], &payload].concat()
}

pub fn empty() -> Nor {
    Nor::new(vec![0xFF; B + SLOT])
}

pub fn newest(flash: &Nor) -> Newest {
    inspect(slot(flash, Slot::A), slot(flash, Slot::B))
}

pub fn slot(flash: &Nor, slot: Slot) -> &[u8] {
    match slot {
        Slot::A => &flash.bytes[A..A + SLOT],
        Slot::B => &flash.bytes[B..B + SLOT],
    }
}

/// The payload of the newest blob.
#[track_caller]
pub fn payload(flash: &Nor) -> Option<&[u8]> {
    match newest(flash) {
        Newest::None => None,
        Newest::Blob { slot: at, .. } => Some(&blob_in(slot(flash, at)).unwrap()[HEADER_BYTES..]),
        Newest::Corrupt { slot, error } => panic!("slot {slot:?} is corrupt: {error}"),
    }
}

/// Stores a blob, with the power cut after so many bytes; the power is back afterwards.
pub fn save(
    flash: &mut Nor,
    blob: &[u8],
    power: Option<usize>,
) -> Result<(Slot, Header), StoreError> {
    flash.power = power;
    let mut store = Store::new(flash.clone(), A as u32, B as u32, SLOT as u32).unwrap();
    let done = store.save(blob, 5);
    *flash = store.into_flash();
    flash.power = None;
    done
}
