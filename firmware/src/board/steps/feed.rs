//! Keeps the machines' FIFOs full: one DMA channel an axis, and a queue of one tick for each channel.
//!
//! A channel moves a tick's words into its machine's FIFO as fast as the FIFO accepts them. The words of the next tick are *queued* long
//! before. When the channel is done, the last 8 words are still to be played, and an interrupt starts the channel on the queued words. In a
//! tick of many edges the last 8 words contain whole chunks of 64. At 1 M steps/s these last over 30 µs, which is the greatest delay that
//! the interrupt may have. A tick of fewer words is in the FIFO at once.

use core::cell::Cell;
use core::sync::atomic::{AtomicU8, Ordering};

use cophase_core::pulse::Run;
use critical_section::{CriticalSection, Mutex};
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::pac;
use embassy_rp::pac::dma::regs::CtrlTrig;
use embassy_rp::pac::dma::vals::{DataSize, TreqSel};

use super::{BLOCKS, block_of, machine_of};
use crate::board::pins::AXES;

/// Axes, a bit each, whose words were too late: their machine had underrun, or the words before them were never started.
static LATE: AtomicU8 = AtomicU8::new(0);

/// Words in memory, for a channel to move.
#[derive(Clone, Copy)]
struct Words {
    address: u32,
    /// Number of words.
    count: u32,
}

impl Words {
    const NONE: Self = Self {
        address: 0,
        count: 0,
    };
}

/// Words that wait for the channel of each axis.
static QUEUED: Mutex<[Cell<Words>; AXES]> = Mutex::new([const { Cell::new(Words::NONE) }; AXES]);

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
    ctrl.set_chain_to(axis as u8); // A channel that is chained to itself is chained to none.
    ctrl.set_high_priority(true);
    ctrl.set_en(true);
    channel.al1_ctrl().write_value(ctrl.0);
    pac::DMA.inte(1).modify(|enabled| *enabled |= 1 << axis);
}

/// Enables the interrupt at the highest priority: it is short, and its work must not wait.
#[cold]
pub fn listen() {
    interrupt::DMA_IRQ_1.set_priority(Priority::P0);
    // SAFETY: this interrupt calls only the handler below, and the data that it shares is behind a mutex.
    unsafe { interrupt::DMA_IRQ_1.enable() };
}

/// Moves the words of `runs`, at least one, into an axis's FIFO: now, or when the words before them are done.
///
/// The words must be [published](publish), and must not change until then: [`Output::runs`](cophase_core::signals::Output::runs) keeps those
/// of two ticks.
#[inline(always)]
pub fn feed(cs: CriticalSection<'_>, axis: usize, runs: &[Run]) {
    const { assert!(size_of::<Run>() == size_of::<u32>()) };
    let words = Words {
        address: runs.as_ptr() as u32,
        count: runs.len() as u32,
    };
    if is_busy(axis) {
        if let Some(queued) = QUEUED.borrow(cs).get(axis)
            && queued.replace(words).count != 0
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
    queued.is_some_and(|queued| queued.get().count != 0)
}

/// Notes that an axis is behind. To be called with interrupts disabled.
pub fn flag_underrun(axis: usize) {
    LATE.store(LATE.load(Ordering::Relaxed) | 1 << axis, Ordering::Relaxed);
}

/// Returns an axis that is behind, once. To be called with interrupts disabled.
pub fn take_late() -> Option<usize> {
    let late = LATE.load(Ordering::Relaxed);
    if late == 0 {
        return None;
    }
    LATE.store(0, Ordering::Relaxed);
    first_of(late)
}

/// Returns the first axis of a set.
#[inline(never)] // seldom
fn first_of(axes: u8) -> Option<usize> {
    (0..AXES).find(|&axis| axes & 1 << axis != 0)
}

/// Completes all writes to memory, as the compiler does not see the reads of the channels.
#[inline(always)]
pub fn publish() {
    cortex_m::asm::dmb();
}

fn begin(axis: usize, words: Words) {
    let channel = pac::DMA.ch(axis);
    channel.al3_trans_count().write_value(words.count);
    channel.al3_read_addr_trig().write_value(words.address);
}

#[interrupt]
fn DMA_IRQ_1() {
    let done = pac::DMA.ints(1).read();
    pac::DMA.ints(1).write_value(done);
    // SAFETY: only this core runs, and no interrupt has a higher priority.
    let cs = unsafe { CriticalSection::new() };
    for (axis, queued) in QUEUED.borrow(cs).iter().enumerate() {
        if done & 1 << axis == 0 {
            continue;
        }
        let words = queued.replace(Words::NONE);
        if words.count != 0 {
            if super::has_underrun(axis) {
                flag_underrun(axis);
            }
            begin(axis, words);
        }
    }
}
