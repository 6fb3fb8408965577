//! From the machine's FIFO to the loop: a DMA channel that writes round and round in a small piece of RAM.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_rp::pac;
use embassy_rp::pac::dma::regs::CtrlTrig;
use embassy_rp::pac::dma::vals::{DataSize, TreqSel};

use crate::board::INDEX_MACHINE;

/// Changes that the ring holds: six cranks at 200 rev/s make two each in 5 ms.
const CHANGES: usize = 64;

/// log2 of the ring's bytes, which the channel wraps at.
const RING_BITS: u32 = (CHANGES * size_of::<u32>()).trailing_zeros();

/// The channel; those before it are the axes'.
const CHANNEL: usize = crate::board::pins::AXES;

/// Words that the channel moves before it has to be set on again: many, and whole rounds of the ring, so that it goes on
/// where it began.
const WORDS: u32 = u32::MAX - (CHANGES as u32 - 1);

/// The ring's memory; it must lie at a multiple of its size. Atomic, since the channel writes there.
#[repr(C, align(256))]
struct Memory([AtomicU32; CHANGES]);

const _: () = assert!(align_of::<Memory>() == 1 << RING_BITS);

static MEMORY: Memory = Memory([const { AtomicU32::new(0) }; CHANGES]);

/// The ring, and how far it has been read.
pub struct Ring {
    /// What the channel's count of words still to be moved is at the next word to be read.
    unread_from: u32,
}

impl Ring {
    /// Sets the channel on the machine's FIFO.
    #[cold]
    pub fn new() -> Self {
        let channel = pac::DMA.ch(CHANNEL);
        channel
            .read_addr()
            .write_value(pac::PIO0.rxf(INDEX_MACHINE).as_ptr() as u32);
        channel.write_addr().write_value(&raw const MEMORY as u32);
        channel.trans_count().write_value(WORDS);
        let mut ctrl = CtrlTrig(0);
        ctrl.set_data_size(DataSize::SIZE_WORD);
        ctrl.set_incr_write(true);
        ctrl.set_ring_sel(true); // the write address is what wraps
        ctrl.set_ring_size(RING_BITS as u8);
        ctrl.set_treq_sel(TreqSel::PIO0_RX3);
        ctrl.set_chain_to(CHANNEL as u8); // to itself: to none
        ctrl.set_en(true);
        channel.ctrl_trig().write_value(ctrl);
        Self { unread_from: WORDS }
    }

    /// How many words wait to be read. If more came than the ring holds, those that are gone are passed over,
    /// and with them all that are still there: their order is not known.
    pub fn waiting(&mut self) -> u32 {
        let channel = pac::DMA.ch(CHANNEL);
        let left = channel.trans_count().read();
        let waiting = self.unread_from.wrapping_sub(left);
        if waiting as usize > CHANGES {
            self.unread_from = left;
            return 0;
        }
        if left == 0 && waiting == 0 {
            // After four billion changes, all of them read. What came since waits in the FIFO.
            channel.al1_trans_count_trig().write_value(WORDS);
            self.unread_from = WORDS;
        }
        waiting
    }

    /// The next word to be read; only if one is waiting.
    pub fn peek(&self) -> u32 {
        let place = WORDS.wrapping_sub(self.unread_from) as usize % CHANGES;
        MEMORY
            .0
            .get(place)
            .map_or(0, |word| word.load(Ordering::Relaxed))
    }

    /// Goes on to the word after.
    pub const fn advance(&mut self) {
        self.unread_from = self.unread_from.wrapping_sub(1);
    }
}
