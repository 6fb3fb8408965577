//! All interleavings of an owner and a borrower, and of a DMA channel and a reader, under loom.
#![cfg(feature = "loom")]

use std::cell::RefCell;

use cophase_exchange::{AtomicU32, Loan, Reader};
use critical_section::RawRestoreState;
use loom::cell::UnsafeCell;
use loom::sync::atomic::Ordering;
use loom::sync::{Arc, Mutex, MutexGuard};
use loom::thread;

// ---- the loan of a tick's telemetry ----

/// Stands for the interrupts of the one core. The owner holds it while its interrupt runs, as nothing of lower priority runs then.
struct Core;

critical_section::set_impl!(Core);

loom::lazy_static! {
    static ref INTERRUPTS: Mutex<()> = Mutex::new(());
}

thread_local! {
    static HELD: RefCell<Option<MutexGuard<'static, ()>>> = const { RefCell::new(None) };
}

// SAFETY: between acquire and release, no other thread of the model is in a critical section.
unsafe impl critical_section::Impl for Core {
    unsafe fn acquire() -> RawRestoreState {
        let guard = INTERRUPTS.lock().unwrap();
        HELD.with(|held| *held.borrow_mut() = Some(guard));
        false
    }

    unsafe fn release(_: RawRestoreState) {
        drop(HELD.with(|held| held.borrow_mut().take()));
    }
}

/// A value of two words that are equal while it is whole. The model reports an access to it during a change.
struct Telemetry(UnsafeCell<[u32; 2]>);

// SAFETY: the model reports accesses that overlap.
unsafe impl Sync for Telemetry {}
unsafe impl Send for Telemetry {}

impl Telemetry {
    fn change(&self, to: u32) {
        self.0.with_mut(|value| {
            // SAFETY: the model reports any other access.
            unsafe { *value = [to, to] };
        });
    }

    fn read(&self) -> [u32; 2] {
        // SAFETY: as above.
        self.0.with(|value| unsafe { *value })
    }
}

struct Shared {
    telemetry: Telemetry,
    loan: Loan<Telemetry, u32>,
}

/// How a tick of the owner ends: its output was taken, or it was too late (or the step hardware had underrun), and nothing is lent.
#[derive(Clone, Copy)]
enum End {
    Taken,
    TooLate,
}

/// Plays ticks: each ends the loan, changes the value, and lends it unless the tick was too late.
fn own(shared: &Shared, ends: &[End]) {
    for (tick, end) in (1..).zip(ends) {
        // The whole tick is one interrupt.
        critical_section::with(|cs| {
            shared.loan.end(cs);
            shared.telemetry.change(tick);
            if matches!(end, End::Taken) {
                // SAFETY: the next tick ends the loan before it changes the value.
                unsafe { shared.loan.lend(cs, &shared.telemetry, tick) };
            }
        });
        thread::yield_now();
    }
}

fn views_are_whole(ends: &'static [End]) {
    loom::model(move || {
        let shared = Arc::new(Shared {
            telemetry: Telemetry(UnsafeCell::new([0, 0])),
            loan: Loan::none(),
        });
        let owner = thread::spawn({
            let shared = shared.clone();
            move || own(&shared, ends)
        });
        for _ in 0..2 {
            let view = critical_section::with(|cs| {
                shared
                    .loan
                    .take(cs, |telemetry, tick| (telemetry.read(), tick))
            });
            if let Some((telemetry, tick)) = view {
                assert_eq!(
                    telemetry,
                    [tick, tick],
                    "a value with the label of another tick"
                );
                assert!(matches!(ends[tick as usize - 1], End::Taken));
            }
        }
        owner.join().unwrap();
    });
}

#[test]
fn a_borrowed_value_is_whole_and_has_its_own_label() {
    views_are_whole(&[End::Taken, End::Taken]);
}

#[test]
fn a_tick_that_was_too_late_lends_nothing_and_ends_the_loan_before() {
    views_are_whole(&[End::Taken, End::TooLate, End::Taken]);
}

// ---- the ring of index changes ----

struct Stream<const N: usize> {
    ring: [AtomicU32; N],
    written: AtomicU32,
}

impl<const N: usize> Stream<N> {
    fn new() -> Self {
        Self {
            ring: core::array::from_fn(|_| AtomicU32::new(0)),
            written: AtomicU32::new(0),
        }
    }

    /// Writes words 1, 2, …: each word first, its count then.
    fn write(&self, words: u32) {
        for word in 0..words {
            self.ring[word as usize % N].store(word + 1, Ordering::Release);
            self.written.store(word + 1, Ordering::Release);
        }
    }

    /// Reads until all words are read or skipped; returns what was read.
    fn read(&self, words: u32) -> Vec<u32> {
        let mut reader = Reader::<N>::new();
        let mut read = vec![];
        while reader.has_unread(words) {
            match reader.peek(&self.ring, || self.written.load(Ordering::Acquire)) {
                Some(word) => {
                    read.push(word);
                    reader.advance();
                }
                None => thread::yield_now(),
            }
        }
        read
    }
}

fn reads<const N: usize>(words: u32, check: fn(u32, Vec<u32>)) {
    loom::model(move || {
        let stream = Arc::new(Stream::<N>::new());
        let writer = thread::spawn({
            let stream = stream.clone();
            move || stream.write(words)
        });
        check(words, stream.read(words));
        writer.join().unwrap();
    });
}

#[test]
fn words_of_a_ring_that_is_not_overrun_come_once_and_in_order() {
    reads::<4>(3, |words, read| assert_eq!(read, Vec::from_iter(1..=words)));
}

#[test]
fn words_of_a_ring_that_is_overrun_come_in_order_and_none_twice() {
    reads::<2>(4, |words, read| {
        assert!(read.is_sorted_by(|a, b| a < b), "{read:?}");
        assert!(
            read.iter().all(|word| (1..=words).contains(word)),
            "{read:?}"
        );
    });
}
