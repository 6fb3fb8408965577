//! Sampler: copies the loop's telemetry for the host link, after the tick and not within it.
//!
//! A sample takes some 800 cycles to make. So the tick only lends its telemetry and requests an interrupt of a lower priority, which runs as
//! soon as the tick is over. That interrupt copies the telemetry with interrupts disabled, so a tick may begin later by the time of a copy.
//!
//! The link takes the samples when it has time. While the queue is full, no copy is made. Samples are made again once half of the queue is
//! free, so that what a slow link misses are long gaps between long runs: a run takes fewer bytes than as many single samples.

use core::cell::UnsafeCell;

use cophase_core::signals::Telemetry;
use cophase_exchange::Loan;
use cophase_link::sample::Sample;
use critical_section::CriticalSection;
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use heapless::spsc::Producer;

/// Part of a sample that is not in the telemetry.
#[derive(Clone, Copy)]
pub struct Label {
    /// Number of the tick.
    pub tick: u32,
    /// Flags of the inputs and drives.
    pub flags: u8,
    /// Number of index pulses so far.
    pub index_count: u8,
}

/// Samples for the link.
struct Samples {
    queue: Producer<'static, Sample>,
    /// The queue was full, and half of it is not free yet.
    is_held: bool,
}

struct Slot(UnsafeCell<Option<Samples>>);

// SAFETY: it is written once, before the interrupt is enabled; from then on only that interrupt accesses it.
unsafe impl Sync for Slot {}

static SAMPLES: Slot = Slot(UnsafeCell::new(None));

/// Telemetry of the last tick.
static TELEMETRY: Loan<Telemetry, Label> = Loan::none();

/// Takes the queue of samples, and enables the interrupt. To be called once.
#[cold]
pub fn set_up(queue: Producer<'static, Sample>) {
    let samples = Samples {
        queue,
        is_held: false,
    };
    // SAFETY: the interrupt is not enabled yet.
    unsafe { *SAMPLES.0.get() = Some(samples) };
    interrupt::SWI_IRQ_0.set_priority(Priority::P3);
    // SAFETY: this interrupt calls only the handler below.
    unsafe { interrupt::SWI_IRQ_0.enable() };
}

/// Ends the loan of the last tick's telemetry. Every tick calls it before it changes the telemetry.
///
/// # Safety
/// Only the loop's interrupt may call it.
#[inline(always)]
pub unsafe fn end() {
    // SAFETY: the sampler's interrupt has a lower priority, and takes the loan in a critical section.
    TELEMETRY.end(unsafe { CriticalSection::new() });
}

/// Requests a sample of the present tick.
///
/// # Safety
/// Only the loop's interrupt may call it. The telemetry must stay at its place, and must not change, until [`end`].
pub unsafe fn request(telemetry: &Telemetry, label: Label) {
    // SAFETY: as in `end`, and as the caller promises.
    unsafe { TELEMETRY.lend(CriticalSection::new(), telemetry, label) };
    interrupt::SWI_IRQ_0.pend();
}

impl Samples {
    /// Makes the requested sample, if the link has room for it and no other tick has begun.
    fn make(&mut self) {
        let limit = if self.is_held {
            self.queue.capacity() / 2
        } else {
            self.queue.capacity()
        };
        self.is_held = self.queue.len() >= limit;
        if self.is_held {
            return;
        }
        let lent = critical_section::with(|cs| {
            TELEMETRY.take(cs, |telemetry, label| (telemetry.clone(), label))
        });
        if let Some((
            telemetry,
            Label {
                tick,
                flags,
                index_count,
            },
        )) = lent
        {
            // There is room: the link only takes samples.
            let _ = self
                .queue
                .enqueue(Sample::new(tick, &telemetry, flags, index_count));
        }
    }
}

#[interrupt]
fn SWI_IRQ_0() {
    // SAFETY: only this handler accesses it, and it does not preempt itself.
    if let Some(samples) = unsafe { &mut *SAMPLES.0.get() } {
        samples.make();
    }
}
