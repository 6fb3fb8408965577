//! Keeps the machines' FIFOs full: one DMA channel an axis, and behind each a place for the next tick.
//!
//! A channel moves a tick's words into its machine's FIFO as fast as that takes them. The words of the tick
//! after are *queued* long before: when the channel is done, with the last 8 words still to be played, an
//! interrupt sets it on those. Among the last 8 words of a tick of many edges are whole chunks of 64: at 1 M steps/s
//! over 30 µs, which is what the interrupt may be late by. A tick of fewer words is in the FIFO at once.

use core::cell::Cell;
use core::sync::atomic::{AtomicU8, Ordering};

use critical_section::{CriticalSection, Mutex};
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::pac;
use embassy_rp::pac::dma::regs::CtrlTrig;
use embassy_rp::pac::dma::vals::{DataSize, TreqSel};

use super::words::Span;
use super::{BLOCKS, block_of, machine_of};
use crate::board::pins::AXES;

/// Axes, a bit each, whose words came too late: their machine had underrun, or those before them were never begun.
static LATE: AtomicU8 = AtomicU8::new(0);

static QUEUED: Mutex<[Cell<Option<Span>>; AXES]> = Mutex::new([const { Cell::new(None) }; AXES]);

/// Sets up the channel of an axis: channel i is axis i's.
#[cold]
pub fn set_up(axis: usize) {
    let channel = pac::DMA.ch(axis);
    let machine = machine_of(axis);
    let fifo = BLOCKS[block_of(axis)].txf(machine).as_ptr();
    channel.al1_write_addr().write_value(fifo as u32);
    let mut ctrl = CtrlTrig(0);
    ctrl.set_data_size(DataSize::SIZE_WORD);
    ctrl.set_incr_read(true);
    ctrl.set_treq_sel(TreqSel::from_bits((block_of(axis) * 8 + machine) as u8));
    ctrl.set_chain_to(axis as u8); // to itself: to none
    ctrl.set_high_priority(true);
    ctrl.set_en(true);
    channel.al1_ctrl().write_value(ctrl.0);
    pac::DMA.inte(1).modify(|enabled| *enabled |= 1 << axis);
}

/// Lets the interrupt through, above all else: it is short, and what it does must not wait.
#[cold]
pub fn listen() {
    interrupt::DMA_IRQ_1.set_priority(Priority::P0);
    // SAFETY: the handler below is all that this interrupt calls, and what it shares is behind a mutex.
    unsafe { interrupt::DMA_IRQ_1.enable() };
}

/// Moves `words` into an axis's FIFO: now, or when those before them are done.
///
/// The words must be [published](publish), and stay as they are until then. [`super::Steps`] owns them, and writes to a buffer again only
/// when the one after it has been begun.
#[inline(always)]
pub fn feed(cs: CriticalSection<'_>, axis: usize, words: Span) {
    if is_busy(axis) {
        if let Some(queued) = QUEUED.borrow(cs).get(axis)
            && queued.replace(Some(words)).is_some()
        {
            flag_underrun(axis);
        }
    } else {
        begin(axis, words);
    }
}

/// Returns true if a channel still has words to move.
pub fn is_busy(axis: usize) -> bool {
    CtrlTrig(pac::DMA.ch(axis).al1_ctrl().read()).busy()
}

/// Returns true if words of an axis wait for its channel.
pub fn is_waiting(cs: CriticalSection<'_>, axis: usize) -> bool {
    let queued = QUEUED.borrow(cs).get(axis);
    queued.is_some_and(|queued| {
        let words = queued.take();
        queued.set(words);
        words.is_some()
    })
}

/// Notes that an axis is behind. To be called with interrupts shut off.
pub fn flag_underrun(axis: usize) {
    LATE.store(LATE.load(Ordering::Relaxed) | 1 << axis, Ordering::Relaxed);
}

/// An axis that is behind, returned once. To be called with interrupts shut off.
pub fn take_late() -> Option<usize> {
    let late = LATE.load(Ordering::Relaxed);
    if late == 0 {
        return None;
    }
    LATE.store(0, Ordering::Relaxed);
    (0..AXES).find(|&axis| late & 1 << axis != 0)
}

/// Completes all writes to memory: the channels read it behind the compiler's back.
#[inline(always)]
pub fn publish() {
    cortex_m::asm::dmb();
}

fn begin(axis: usize, words: Span) {
    let channel = pac::DMA.ch(axis);
    channel.al3_trans_count().write_value(words.count);
    channel.al3_read_addr_trig().write_value(words.address);
}

#[interrupt]
fn DMA_IRQ_1() {
    let done = pac::DMA.ints(1).read();
    pac::DMA.ints(1).write_value(done);
    critical_section::with(|cs| {
        for (axis, queued) in QUEUED.borrow(cs).iter().enumerate() {
            if done & 1 << axis != 0
                && let Some(words) = queued.take()
            {
                if super::has_underrun(axis) {
                    flag_underrun(axis);
                }
                begin(axis, words);
            }
        }
    });
}
