//! The two slots, on a flash whose power is cut at every byte.
//!
//! After any cut the newest settings file is the one before or the one being stored, and it is intact.

use crate::support::nor::{CUTS, Cut, Nor, PAGE, SECTOR};
use crate::support::slots::{empty, newest, payload, save, settings_file};
use cophase_link::Newest;
use cophase_link::file_format::HEADER_BYTES;
use proptest::prelude::*;

/// Bytes that are erased and programmed when a settings file is stored in this flash.
fn cost(flash: &Nor, settings_file: &[u8]) -> usize {
    let mut copy = flash.clone();
    copy.done = 0;
    save(&mut copy, settings_file, None).unwrap();
    copy.done
}

/// Checks that the newest file is one of two, and the second if its storage was reported as done; returns it.
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

/// If this fails, a power cut at the wrong moment leaves a machine without settings, or with half of them.
#[test]
fn a_power_cut_at_any_byte_keeps_old_or_new_file() {
    // The files are longer than a sector, so that the order in which sectors are erased matters.
    let (oldest, old, new, next) = (
        settings_file(1, 3900),
        settings_file(2, 300),
        settings_file(3, 3900),
        settings_file(4, 10),
    );
    let mut before = empty();
    save(&mut before, &oldest, None).unwrap();
    save(&mut before, &old, None).unwrap();
    let cost = cost(&before, &new);
    assert_eq!(cost, 2 * SECTOR + (16 + 1) * PAGE);
    for cut in CUTS {
        let mut found_new = 0;
        for power in 0..=cost {
            let mut flash = before.clone();
            flash.cut = cut;
            flash.seed(power);
            let done = save(&mut flash, &new, Some(power)).is_ok();
            assert!(!done || power == cost);
            found_new += usize::from(one_of(&flash, &old, &new, done) == new);
            // The next file can be stored.
            save(&mut flash, &next, None).unwrap();
            assert_eq!(payload(&flash), Some(&next[HEADER_BYTES..]));
        }
        assert!(
            found_new <= 2 || cut == Cut::Mixture,
            "{cut:?}: {found_new}"
        );
    }
}

/// After a cut during the very first storage there is no file or the whole file, never half of it.
#[test]
fn a_power_cut_in_the_first_save_leaves_no_partial_file() {
    let new = settings_file(3, 600);
    for cut in CUTS {
        for power in 0..cost(&empty(), &new) {
            // The slots of a new board may hold any bytes.
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

/// Every first cut, each with nine second ones. Together they cover every second cut too.
#[test]
fn two_power_cuts_in_a_row_keep_old_or_new_file() {
    const STRIDE: usize = 521;
    let (old, new, newer) = (
        settings_file(2, 300),
        settings_file(3, 600),
        settings_file(4, 200),
    );
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
    /// Any sequence of storing and cuts.
    #[test]
    fn any_saves_and_power_cuts_keep_the_last_or_the_new_file(
        steps in prop::collection::vec(
            (1_usize..1500, prop::option::of(any::<prop::sample::Index>()), 0_usize..3), 1..12,
        ),
        seed in any::<u16>(),
    ) {
        let mut flash = empty();
        flash.seed(usize::from(seed));
        let mut last: Option<Vec<u8>> = None;
        for (i, (bytes, cut, kind)) in steps.into_iter().enumerate() {
            let new = settings_file(i, bytes);
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
