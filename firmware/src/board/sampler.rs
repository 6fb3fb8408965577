//! Sampler: copies the loop's telemetry for the host link, after the tick and not within it.
//!
//! A sample takes some 800 cycles to make. So the tick only requests an interrupt of a lower priority, which runs as
//! soon as the tick is over.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::ptr;
use core::sync::atomic::{AtomicPtr, AtomicU8, AtomicU32, Ordering};

use cophase_core::signals::Telemetry;
use cophase_link::sample::Sample;
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use heapless::spsc::Producer;

struct Slot(UnsafeCell<Option<Producer<'static, Sample>>>);

// SAFETY: it is written once, before the interrupt is enabled; from then on only that interrupt accesses it.
unsafe impl Sync for Slot {}

static SAMPLES: Slot = Slot(UnsafeCell::new(None));

/// Number of the last tick.
static NOW: AtomicU32 = AtomicU32::new(0);

/// Telemetry of the loop.
static TELEMETRY: AtomicPtr<Telemetry> = AtomicPtr::new(ptr::null_mut());

/// Flags of the requested sample.
static FLAGS: AtomicU8 = AtomicU8::new(0);

/// Number of index pulses at the requested sample.
static INDEX_COUNT: AtomicU8 = AtomicU8::new(0);

/// Takes the queue of samples, and enables the interrupt. To be called once.
#[cold]
pub fn set_up(samples: Producer<'static, Sample>) {
    // SAFETY: the interrupt is not enabled yet.
    unsafe { *SAMPLES.0.get() = Some(samples) };
    interrupt::SWI_IRQ_0.set_priority(Priority::P3);
    // SAFETY: this interrupt calls only the handler below.
    unsafe { interrupt::SWI_IRQ_0.enable() };
}

/// Notes the number of a tick. Every tick calls it, so that a copy that it interrupts is dropped.
pub fn begin(tick: u32) {
    NOW.store(tick, Ordering::Release);
}

/// Requests a sample of the present tick, with the flags of its inputs and drives, and the number of index pulses so far. The telemetry
/// must be in a static.
pub fn request(telemetry: &Telemetry, flags: u8, index_count: u8) {
    INDEX_COUNT.store(index_count, Ordering::Relaxed);
    TELEMETRY.store(ptr::from_ref(telemetry).cast_mut(), Ordering::Relaxed);
    FLAGS.store(flags, Ordering::Relaxed);
    interrupt::SWI_IRQ_0.pend();
}

/// The requested sample; none if another tick has begun.
fn sample() -> Option<Sample> {
    let tick = NOW.load(Ordering::Acquire);
    let telemetry = TELEMETRY.load(Ordering::Relaxed);
    let flags = FLAGS.load(Ordering::Relaxed);
    let index_count = INDEX_COUNT.load(Ordering::Relaxed);
    if telemetry.is_null() {
        return None;
    }
    // SAFETY: it is in a static. A tick may interrupt the copy and change it, but then the copy is not used.
    let copy = unsafe { ptr::read_volatile(telemetry.cast::<MaybeUninit<Telemetry>>()) };
    if NOW.load(Ordering::Acquire) != tick {
        return None;
    }
    // SAFETY: no tick has begun since it was written, so it is whole.
    let telemetry = unsafe { copy.assume_init_ref() };
    Some(Sample::new(tick, telemetry, flags, index_count))
}

#[interrupt]
fn SWI_IRQ_0() {
    // SAFETY: only this handler accesses it, and it does not preempt itself.
    let samples = unsafe { &mut *SAMPLES.0.get() };
    if let (Some(samples), Some(sample)) = (samples, sample()) {
        // If there is no room, the tick of the next sample shows the gap.
        let _ = samples.enqueue(sample);
    }
}
