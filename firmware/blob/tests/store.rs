//! The two slots, on a flash whose power is cut at every byte.
//!
//! What must hold after any cut: the newest blob is the one before or the one being stored, whole.

mod support;

use cophase_blob::codec::VERSION;
use cophase_blob::header::{HEADER_BYTES, OUTSIDE};
use cophase_blob::store::blob_in;
use cophase_blob::{
    BlobError, Choice, Header, Newest, Slot, Store, StoreError, choose, inspect, layout,
};
use embedded_storage::nor_flash::NorFlashErrorKind;
use proptest::prelude::*;
use support::nor::{CUTS, Cut, Nor, PAGE, SECTOR};

const SLOT: usize = 2 * SECTOR;

/// The slots lie apart, and not at the flash's beginning, so that a mistaken offset is seen.
const A: usize = SECTOR;
const B: usize = A + SLOT + SECTOR;

/// A blob whose payload is `bytes` long and differs with `seed`. What it says is of no interest to a store.
fn blob(seed: usize, bytes: usize) -> Vec<u8> {
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

fn empty() -> Nor {
    Nor::new(vec![0xFF; B + SLOT])
}

fn newest(flash: &Nor) -> Newest {
    inspect(slot(flash, Slot::A), slot(flash, Slot::B))
}

fn slot(flash: &Nor, slot: Slot) -> &[u8] {
    match slot {
        Slot::A => &flash.bytes[A..A + SLOT],
        Slot::B => &flash.bytes[B..B + SLOT],
    }
}

/// The payload of the newest blob.
#[track_caller]
fn payload(flash: &Nor) -> Option<&[u8]> {
    match newest(flash) {
        Newest::None => None,
        Newest::Blob { slot: at, .. } => Some(&blob_in(slot(flash, at)).unwrap()[HEADER_BYTES..]),
        Newest::Corrupt { slot, error } => panic!("slot {slot:?} is corrupt: {error}"),
    }
}

/// Stores a blob, with the power cut after so many bytes; the power is back afterwards.
fn save(flash: &mut Nor, blob: &[u8], power: Option<usize>) -> Result<(Slot, Header), StoreError> {
    flash.power = power;
    let mut store = Store::new(flash.clone(), A as u32, B as u32, SLOT as u32).unwrap();
    let done = store.save(blob, 5);
    *flash = store.into_flash();
    flash.power = None;
    done
}

/// Bytes that are erased and programmed when a blob is stored in this flash.
fn cost(flash: &Nor, blob: &[u8]) -> usize {
    let mut copy = flash.clone();
    copy.done = 0;
    save(&mut copy, blob, None).unwrap();
    copy.done
}

/// That the newest blob is one of two, the second if storing it was said to be done; gives which.
#[track_caller]
fn one_of<'a>(flash: &Nor, old: &'a [u8], new: &'a [u8], done: bool) -> &'a [u8] {
    let found = payload(flash).expect("there was one, and now there is none");
    if found == &new[HEADER_BYTES..] {
        return new;
    }
    assert!(!done, "stored, but not the newest");
    assert!(found == &old[HEADER_BYTES..], "neither the old nor the new");
    old
}

#[test]
fn blobs_take_turns_and_the_last_is_newest() {
    let mut flash = empty();
    assert_eq!(newest(&flash), Newest::None);
    let slots = [Slot::A, Slot::B, Slot::A, Slot::B];
    for (i, expected) in (1..).zip(slots) {
        let blob = blob(i, 100 * i);
        let (slot, header) = save(&mut flash, &blob, None).unwrap();
        assert_eq!(slot, expected);
        assert_eq!((header.sequence, header.origin), (i as u32, 5));
        assert_eq!(newest(&flash), Newest::Blob { slot, header });
        assert_eq!(payload(&flash), Some(&blob[HEADER_BYTES..]));
    }
}

/// Were it wrong, a power cut at the wrong moment would leave a machine without settings, or with half of them.
#[test]
fn a_power_cut_at_any_byte_leaves_the_old_or_the_new() {
    // Longer than a sector, so that it matters in which order sectors are erased.
    let (oldest, old, new, next) = (blob(1, 3900), blob(2, 300), blob(3, 3900), blob(4, 10));
    let mut before = empty();
    save(&mut before, &oldest, None).unwrap();
    save(&mut before, &old, None).unwrap();
    let cost = cost(&before, &new);
    assert_eq!(cost, 2 * SECTOR + (16 + 1) * PAGE);
    for cut in CUTS {
        let mut seen_new = 0;
        for power in 0..=cost {
            let mut flash = before.clone();
            flash.cut = cut;
            flash.seed(power);
            let done = save(&mut flash, &new, Some(power)).is_ok();
            assert!(!done || power == cost);
            seen_new += usize::from(one_of(&flash, &old, &new, done) == new);
            // And nothing is in the way of the next.
            save(&mut flash, &next, None).unwrap();
            assert_eq!(payload(&flash), Some(&next[HEADER_BYTES..]));
        }
        assert!(seen_new <= 2 || cut == Cut::Mixture, "{cut:?}: {seen_new}");
    }
}

/// The first blob of all: none or it, never half of it.
#[test]
fn a_power_cut_at_any_byte_of_the_first_leaves_none_or_it() {
    let new = blob(3, 600);
    for cut in CUTS {
        for power in 0..cost(&empty(), &new) {
            // Whatever the slots held when the board was new.
            let mut flash = empty();
            flash.bytes.fill_with({
                let mut i = power as u32;
                move || {
                    i = i.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (i >> 24) as u8
                }
            });
            flash.cut = cut;
            assert_eq!(newest(&flash), Newest::None);
            let _cut = save(&mut flash, &new, Some(power));
            assert!(payload(&flash).is_none_or(|found| found == &new[HEADER_BYTES..]));
        }
    }
}

/// Every first cut, each with nine second ones; over all of them, every second cut too.
#[test]
fn two_power_cuts_in_a_row_leave_the_old_or_the_new() {
    const STRIDE: usize = 521;
    let (old, new, newer) = (blob(2, 300), blob(3, 600), blob(4, 200));
    let mut before = empty();
    save(&mut before, &old, None).unwrap();
    let (first, second) = (cost(&before, &new), cost(&before, &newer));
    for cut in [Cut::FirstToLast, Cut::Mixture] {
        for power in 0..first {
            let mut once = before.clone();
            once.cut = cut;
            once.seed(power);
            let done = save(&mut once, &new, Some(power)).is_ok();
            let between = one_of(&once, &old, &new, done);
            for power in (power % STRIDE..second).step_by(STRIDE) {
                let mut twice = once.clone();
                twice.seed(power);
                let done = save(&mut twice, &newer, Some(power)).is_ok();
                one_of(&twice, between, &newer, done);
            }
        }
    }
}

proptest! {
    /// Any number of savings and cuts.
    #[test]
    fn the_newest_is_always_one_that_was_meant(
        steps in prop::collection::vec(
            (1_usize..1500, prop::option::of(any::<prop::sample::Index>()), 0_usize..3), 1..12,
        ),
        seed in any::<u16>(),
    ) {
        let mut flash = empty();
        flash.seed(usize::from(seed));
        let mut last: Option<Vec<u8>> = None;
        for (i, (bytes, cut, kind)) in steps.into_iter().enumerate() {
            let new = blob(i, bytes);
            flash.cut = CUTS[kind];
            let power = cut.map(|at| at.index(cost(&flash, &new)));
            let done = save(&mut flash, &new, power).is_ok();
            prop_assert!(!done || power.is_none());
            match payload(&flash) {
                Some(found) if found == &new[HEADER_BYTES..] => last = Some(new),
                found => {
                    prop_assert!(!done);
                    prop_assert_eq!(found, last.as_ref().map(|last| &last[HEADER_BYTES..]));
                }
            }
        }
    }
}

/// Sequence numbers come round after 2³² savings; the newest must stay the newest.
#[test]
fn the_sequence_wraps() {
    let mut flash = empty();
    let stored = |sequence| {
        let blob = blob(1, 50);
        let header = Header {
            sequence,
            ..Header::read(&blob).unwrap()
        };
        [&header.page()[..], &blob[HEADER_BYTES..]].concat()
    };
    let last = stored(u32::MAX);
    flash.bytes[A..A + last.len()].copy_from_slice(&last);
    for (i, sequence) in [(2, 0), (3, 1)] {
        let (_, header) = save(&mut flash, &blob(i, 60), None).unwrap();
        assert_eq!(header.sequence, sequence);
        assert_eq!(payload(&flash), Some(&blob(i, 60)[HEADER_BYTES..]));
    }
}

/// Were it wrong, a machine would go on with settings that were replaced long ago, and nobody would know.
#[test]
fn damage_to_the_newest_payload_is_corruption_and_nothing_else_is() {
    let mut whole = empty();
    save(&mut whole, &blob(1, 300), None).unwrap();
    let (at, _) = save(&mut whole, &blob(2, 300), None).unwrap();
    assert_eq!(at, Slot::B);
    for byte in 0..300 {
        let mut flash = whole.clone();
        flash.bytes[B + HEADER_BYTES + byte] ^= 0x40;
        let Newest::Corrupt { slot, error } = newest(&flash) else {
            panic!("byte {byte} does not matter");
        };
        assert_eq!(slot, Slot::B);
        assert!(matches!(error, BlobError::PayloadCrc { .. }), "{error}");
        // Storing another mends it.
        save(&mut flash, &blob(3, 40), None).unwrap();
        assert_eq!(payload(&flash), Some(&blob(3, 40)[HEADER_BYTES..]));
    }
    let mut older = whole.clone();
    older.bytes[A + HEADER_BYTES] ^= 1;
    assert_eq!(newest(&older), newest(&whole), "the older one is not asked");
    let mut longer = whole.clone();
    let header = Header {
        length: SLOT as u32,
        ..Header::read(slot(&whole, Slot::B)).unwrap()
    };
    longer.bytes[B..B + HEADER_BYTES].copy_from_slice(&header.page());
    assert!(matches!(
        newest(&longer),
        Newest::Corrupt {
            error: BlobError::Cut { .. },
            ..
        }
    ));
}

/// A blob of another version is whole; whether it is run is not the store's to say.
#[test]
fn another_version_is_not_corruption() {
    let mut flash = empty();
    let blob = blob(1, 300);
    let header = Header {
        version: VERSION + 1,
        ..Header::read(&blob).unwrap()
    };
    let other = [&header.page()[..], &blob[HEADER_BYTES..]].concat();
    flash.bytes[A..A + other.len()].copy_from_slice(&other);
    assert_eq!(
        newest(&flash),
        Newest::Blob {
            slot: Slot::A,
            header
        }
    );
    let refused = save(&mut flash, &other, None).unwrap_err();
    assert_eq!(
        refused,
        StoreError::Blob(BlobError::Version { found: VERSION + 1 })
    );
}

/// What an image runs: every case of the rule.
#[test]
fn choice() {
    let built_in = Header::read(&blob(1, 300)).unwrap();
    let other = Header::read(&blob(2, 300)).unwrap();
    let stored = |header, origin| Newest::Blob {
        slot: Slot::B,
        header: Header { origin, ..header },
    };
    let error = BlobError::Unreadable;
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
            "another image's",
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

/// A board's first two starts, the second with another image, and a third with the first image again.
#[test]
fn an_image_stores_what_it_brings_once() {
    let mut flash = empty();
    for image in [blob(1, 300), blob(2, 200), blob(1, 300)] {
        let built_in = Header::read(&image).unwrap();
        assert_eq!(choose(&built_in, &newest(&flash)), Choice::BuiltIn);
        let mut store = Store::new(flash.clone(), A as u32, B as u32, SLOT as u32).unwrap();
        let (slot, _) = store.save(&image, built_in.mark()).unwrap();
        flash = store.into_flash();
        assert_eq!(choose(&built_in, &newest(&flash)), Choice::Stored(slot));
    }
}

#[test]
fn a_worn_page_is_found_and_the_old_blob_stays() {
    for worn in [B, B + 255, B + HEADER_BYTES + 3] {
        let mut flash = empty();
        save(&mut flash, &blob(1, 300), None).unwrap();
        flash.worn = Some(worn);
        // Bit 4 is to become 0 there.
        let new = (2..99).map(|i| blob(i, 300)).find(|blob| {
            let mut copy = flash.clone();
            copy.worn = None;
            save(&mut copy, blob, None).unwrap();
            copy.bytes[worn] & 0x10 == 0
        });
        let refused = save(&mut flash, &new.unwrap(), None).unwrap_err();
        let offset = (worn & !0xFF) as u32;
        assert_eq!(refused, StoreError::ReadBack { offset });
        assert_eq!(payload(&flash), Some(&blob(1, 300)[HEADER_BYTES..]));
    }
}

#[test]
fn what_cannot_be_stored_is_refused_before_anything_is_erased() {
    let mut flash = empty();
    save(&mut flash, &blob(1, 300), None).unwrap();
    let before = flash.bytes.clone();
    let mut broken = blob(2, 300);
    *broken.last_mut().unwrap() ^= 1;
    assert!(matches!(
        save(&mut flash, &broken, None),
        Err(StoreError::Blob(BlobError::PayloadCrc { .. }))
    ));
    let mut small = Store::new(flash.clone(), 0, SECTOR as u32, SECTOR as u32).unwrap();
    assert_eq!(
        small.save(&blob(2, SECTOR - HEADER_BYTES + 1), 5),
        Err(StoreError::SlotTooSmall {
            bytes: SECTOR as u32 + 1,
            slot_bytes: SECTOR as u32
        })
    );
    assert_eq!(flash.bytes, before);
    assert_eq!(
        save(&mut flash, &blob(2, 300), Some(0)),
        Err(StoreError::Flash(NorFlashErrorKind::Other))
    );
}

#[test]
fn slots_that_cannot_be_are_refused() {
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
        ("past the end", 0.0, 7.0, 2.0),
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
