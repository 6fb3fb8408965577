//! Arbitrary feedback, for the requested number of ticks. `COPHASE_FUZZ_INPUTS` gives the number of ticks in all;
//! without it there are few:
//!
//!     COPHASE_FUZZ_INPUTS=1000000000 cargo test -p cophase-fuzz --test fuzz -- --nocapture
//!
//! Overflow checks must be on, so do not use release mode. A billion ticks take some minutes. Every run plays other cases.
//! A case that fails is reduced, and reported with the seed that reproduces it (`BOLERO_RANDOM_SEED`).

use std::sync::Mutex;

use cophase_core::supervisor::FaultKind;
use cophase_core::units::MAX_AXES;
use cophase_fuzz::{Reached, TICKS, play};

/// Ticks over all numbers of axes.
fn inputs() -> u32 {
    let requested = std::env::var("COPHASE_FUZZ_INPUTS").ok();
    requested.map_or(1_000_000, |requested| {
        requested.parse().expect("a number of ticks")
    })
}

fn fuzz(count: usize) {
    let all = Mutex::new(Reached::default());
    let cases = inputs().div_ceil(MAX_AXES as u32 * TICKS) as usize;
    bolero::check!()
        .with_iterations(cases)
        .with_max_len(1024)
        .for_each(|bytes: &[u8]| {
            let reached = play(count, bytes);
            let mut all = all.lock().expect("no case left it locked");
            all.ticks += reached.ticks;
            all.running += reached.running;
            all.faults += reached.faults;
            all.kinds |= reached.kinds;
        });
    let all = *all.lock().expect("no case left it locked");
    let was_found = |kind: &&FaultKind| all.kinds >> **kind as u32 & 1 == 1;
    let kinds: Vec<&str> = FaultKind::ALL
        .iter()
        .filter(was_found)
        .map(|kind| kind.name())
        .collect();
    println!(
        "{count} axes: {} ticks, {} of them in run; {} faults latched; {}",
        all.ticks,
        all.running,
        all.faults,
        kinds.join(", ")
    );
    // If these fail, the cases hardly test anything. Over many cases it is one tick in eight, and five faults a case.
    assert!(all.running > all.ticks / 200, "hardly anything runs");
    assert!(all.faults > all.ticks / TICKS, "hardly anything goes wrong");
}

#[test]
fn invariants_hold_with_one_axis() {
    fuzz(1);
}

#[test]
fn invariants_hold_with_two_axes() {
    fuzz(2);
}

#[test]
fn invariants_hold_with_three_axes() {
    fuzz(3);
}

#[test]
fn invariants_hold_with_four_axes() {
    fuzz(4);
}

#[test]
fn invariants_hold_with_five_axes() {
    fuzz(5);
}

#[test]
fn invariants_hold_with_six_axes() {
    fuzz(6);
}
