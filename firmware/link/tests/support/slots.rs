//! Two slots in a simulated flash, and settings files to store there.

use cophase_link::file_format::{HEADER_BYTES, VERSION};
use cophase_link::store::settings_file_in;
use cophase_link::{Header, Newest, Slot, Store, StoreError, inspect};

use super::nor::{Nor, SECTOR};

pub const SLOT: usize = 2 * SECTOR;

/// The slots lie apart, and not at the beginning of the flash, so that a wrong offset is detected.
pub const A: usize = SECTOR;
pub const B: usize = A + SLOT + SECTOR;

/// Makes a settings file whose payload is `bytes` long and depends on `seed`. A store ignores its contents.
pub fn settings_file(seed: usize, bytes: usize) -> Vec<u8> {
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

/// Payload of the newest settings file.
#[track_caller]
pub fn payload(flash: &Nor) -> Option<&[u8]> {
    match newest(flash) {
        Newest::None => None,
        Newest::Stored { slot: at, .. } => {
            Some(&settings_file_in(slot(flash, at)).unwrap()[HEADER_BYTES..])
        }
        Newest::Corrupt { slot, error } => panic!("slot {slot:?} is corrupt: {error}"),
    }
}

/// Stores a settings file, with the power cut after `power` bytes; the power is back afterwards.
pub fn save(
    flash: &mut Nor,
    settings_file: &[u8],
    power: Option<usize>,
) -> Result<(Slot, Header), StoreError> {
    flash.power = power;
    let mut store = Store::new(flash.clone(), A as u32, B as u32, SLOT as u32).unwrap();
    let done = store.save(settings_file, 5);
    *flash = store.into_flash();
    flash.power = None;
    done
}
