//! Contents of the two slots, storing in them, and the choice of the settings to run.

use crate::support::nor::{Nor, SECTOR};
use crate::support::slots::{A, B, SLOT, empty, newest, payload, save, settings_file, slot};
use cophase_link::file_format::{HEADER_BYTES, VERSION};
use cophase_link::header::OUTSIDE;
use cophase_link::{
    Choice, Header, Newest, SettingsFileError, Slot, Store, StoreError, choose, layout,
};
use embedded_storage::nor_flash::NorFlashErrorKind;

#[test]
fn saves_alternate_between_slots_and_the_last_is_newest() {
    let mut flash = empty();
    assert_eq!(newest(&flash), Newest::None);
    let slots = [Slot::A, Slot::B, Slot::A, Slot::B];
    for (i, expected) in (1..).zip(slots) {
        let settings_file = settings_file(i, 100 * i);
        let (slot, header) = save(&mut flash, &settings_file, None).unwrap();
        assert_eq!(slot, expected);
        assert_eq!((header.sequence, header.origin), (i as u32, 5));
        assert_eq!(newest(&flash), Newest::Stored { slot, header });
        assert_eq!(payload(&flash), Some(&settings_file[HEADER_BYTES..]));
    }
}

/// Sequence numbers wrap after 2³² files. The newest file must remain the newest.
#[test]
fn the_newest_file_stays_newest_when_the_sequence_wraps() {
    let mut flash = empty();
    let stored = |sequence| {
        let settings_file = settings_file(1, 50);
        let header = Header {
            sequence,
            ..Header::read(&settings_file).unwrap()
        };
        [&header.page()[..], &settings_file[HEADER_BYTES..]].concat()
    };
    let last = stored(u32::MAX);
    flash.bytes[A..A + last.len()].copy_from_slice(&last);
    for (i, sequence) in [(2, 0), (3, 1)] {
        let (_, header) = save(&mut flash, &settings_file(i, 60), None).unwrap();
        assert_eq!(header.sequence, sequence);
        assert_eq!(payload(&flash), Some(&settings_file(i, 60)[HEADER_BYTES..]));
    }
}

/// If this fails, a machine runs settings that were replaced long ago, and nobody notices.
#[test]
fn only_damage_to_the_newest_payload_is_corruption() {
    let mut whole = empty();
    save(&mut whole, &settings_file(1, 300), None).unwrap();
    let (at, _) = save(&mut whole, &settings_file(2, 300), None).unwrap();
    assert_eq!(at, Slot::B);
    for byte in 0..300 {
        let mut flash = whole.clone();
        flash.bytes[B + HEADER_BYTES + byte] ^= 0x40;
        let Newest::Corrupt { slot, error } = newest(&flash) else {
            panic!("byte {byte} does not matter");
        };
        assert_eq!(slot, Slot::B);
        assert!(
            matches!(error, SettingsFileError::PayloadCrc { .. }),
            "{error}"
        );
        // Storing another file repairs it.
        save(&mut flash, &settings_file(3, 40), None).unwrap();
        assert_eq!(payload(&flash), Some(&settings_file(3, 40)[HEADER_BYTES..]));
    }
    let mut older = whole.clone();
    older.bytes[A + HEADER_BYTES] ^= 1;
    assert_eq!(newest(&older), newest(&whole), "the older one is ignored");
    let mut longer = whole.clone();
    let header = Header {
        length: SLOT as u32,
        ..Header::read(slot(&whole, Slot::B)).unwrap()
    };
    longer.bytes[B..B + HEADER_BYTES].copy_from_slice(&header.page());
    assert!(matches!(
        newest(&longer),
        Newest::Corrupt {
            error: SettingsFileError::Cut { .. },
            ..
        }
    ));
}

/// A settings file of another version is intact. The store does not decide whether it is run.
#[test]
fn another_version_is_not_corruption() {
    let mut flash = empty();
    let settings_file = settings_file(1, 300);
    let header = Header {
        version: VERSION + 1,
        ..Header::read(&settings_file).unwrap()
    };
    let other = [&header.page()[..], &settings_file[HEADER_BYTES..]].concat();
    flash.bytes[A..A + other.len()].copy_from_slice(&other);
    assert_eq!(
        newest(&flash),
        Newest::Stored {
            slot: Slot::A,
            header
        }
    );
    let refused = save(&mut flash, &other, None).unwrap_err();
    assert_eq!(
        refused,
        StoreError::SettingsFile(SettingsFileError::Version { found: VERSION + 1 })
    );
}

/// Settings that the firmware runs: every case of the rule.
#[test]
fn choose_selects_stored_or_built_in_settings_or_refuses() {
    let built_in = Header::read(&settings_file(1, 300)).unwrap();
    let other = Header::read(&settings_file(2, 300)).unwrap();
    let stored = |header, origin| Newest::Stored {
        slot: Slot::B,
        header: Header { origin, ..header },
    };
    let error = SettingsFileError::Unreadable;
    let slot = Slot::A;
    for (what, newest, expected) in [
        ("a new board", Newest::None, Choice::BuiltIn),
        ("placed", stored(other, OUTSIDE), Choice::Stored(Slot::B)),
        (
            "stored",
            stored(built_in, built_in.mark()),
            Choice::Stored(Slot::B),
        ),
        (
            "changed since",
            stored(other, built_in.mark()),
            Choice::Stored(Slot::B),
        ),
        (
            "another firmware's",
            stored(other, other.mark()),
            Choice::BuiltIn,
        ),
        (
            "its own, by another",
            stored(built_in, other.mark()),
            Choice::BuiltIn,
        ),
        (
            "corrupt",
            Newest::Corrupt { slot, error },
            Choice::Refuse(slot, error),
        ),
    ] {
        assert_eq!(choose(&built_in, &newest), expected, "{what}");
    }
}

/// Three starts of a board: with one firmware, with another, and with the first again.
#[test]
fn firmware_stores_its_built_in_settings_once() {
    let mut flash = empty();
    for file in [
        settings_file(1, 300),
        settings_file(2, 200),
        settings_file(1, 300),
    ] {
        let built_in = Header::read(&file).unwrap();
        assert_eq!(choose(&built_in, &newest(&flash)), Choice::BuiltIn);
        let mut store = Store::new(flash.clone(), A as u32, B as u32, SLOT as u32).unwrap();
        let (slot, _) = store.save(&file, built_in.mark()).unwrap();
        flash = store.into_flash();
        assert_eq!(choose(&built_in, &newest(&flash)), Choice::Stored(slot));
    }
}

#[test]
fn a_worn_page_is_found_and_the_old_file_stays() {
    for worn in [B, B + 255, B + HEADER_BYTES + 3] {
        let mut flash = empty();
        save(&mut flash, &settings_file(1, 300), None).unwrap();
        flash.worn = Some(worn);
        // Bit 4 must become 0 there.
        let new = (2..99)
            .map(|i| settings_file(i, 300))
            .find(|settings_file| {
                let mut copy = flash.clone();
                copy.worn = None;
                save(&mut copy, settings_file, None).unwrap();
                copy.bytes[worn] & 0x10 == 0
            });
        let refused = save(&mut flash, &new.unwrap(), None).unwrap_err();
        let offset = (worn & !0xFF) as u32;
        assert_eq!(refused, StoreError::ReadBack { offset });
        assert_eq!(
            payload(&flash),
            Some(&settings_file(1, 300)[HEADER_BYTES..])
        );
    }
}

#[test]
fn damaged_or_oversized_files_are_refused_before_erasing() {
    let mut flash = empty();
    save(&mut flash, &settings_file(1, 300), None).unwrap();
    let before = flash.bytes.clone();
    let mut broken = settings_file(2, 300);
    *broken.last_mut().unwrap() ^= 1;
    assert!(matches!(
        save(&mut flash, &broken, None),
        Err(StoreError::SettingsFile(
            SettingsFileError::PayloadCrc { .. }
        ))
    ));
    let mut small = Store::new(flash.clone(), 0, SECTOR as u32, SECTOR as u32).unwrap();
    assert_eq!(
        small.save(&settings_file(2, SECTOR - HEADER_BYTES + 1), 5),
        Err(StoreError::SlotTooSmall {
            bytes: SECTOR as u32 + 1,
            slot_bytes: SECTOR as u32
        })
    );
    assert_eq!(flash.bytes, before);
    assert_eq!(
        save(&mut flash, &settings_file(2, 300), Some(0)),
        Err(StoreError::Flash(NorFlashErrorKind::Other))
    );
}

#[test]
fn invalid_slot_layouts_are_refused() {
    let flash = || Nor::new(vec![0xFF; 8 * SECTOR]);
    let sectors = |a: f64, b: f64, length: f64| {
        let bytes = |sectors: f64| (sectors * SECTOR as f64) as u32;
        Store::new(flash(), bytes(a), bytes(b), bytes(length)).map(drop)
    };
    assert_eq!(sectors(0.0, 2.0, 2.0), Ok(()));
    assert_eq!(sectors(6.0, 0.0, 2.0), Ok(()));
    for (what, a, b, length) in [
        ("the same", 0.0, 0.0, 2.0),
        ("overlapping", 0.0, 1.0, 2.0),
        ("beyond the end", 0.0, 7.0, 2.0),
        ("between sectors", 0.5, 4.0, 2.0),
        ("half sectors", 0.0, 4.0, 1.5),
        ("empty", 0.0, 4.0, 0.0),
    ] {
        assert_eq!(sectors(a, b, length), Err(StoreError::Layout), "{what}");
    }
    let board = Nor::new(vec![0xFF; layout::FLASH_BYTES as usize]);
    let (a, b) = (layout::SLOT_A_OFFSET, layout::SLOT_B_OFFSET);
    Store::new(board, a, b, layout::SLOT_BYTES).unwrap();
}
