//! Ring in RAM that a DMA channel fills from the FIFO of the machine, and that the loop reads.

use cophase_exchange::{AtomicU32, Reader};
use embassy_rp::pac;
use embassy_rp::pac::dma::regs::CtrlTrig;
use embassy_rp::pac::dma::vals::{DataSize, TreqSel};

use crate::board::INDEX_MACHINE;

/// Number of changes of which the ring holds all but one. Six cranks at 200 rev/s make two changes each in 5 ms.
const CHANGES: usize = 64;

/// Binary logarithm of the ring's length in bytes, at which the channel wraps.
const RING_BITS: u32 = (CHANGES * size_of::<u32>()).trailing_zeros();

/// DMA channel; those before it belong to the axes.
const CHANNEL: usize = crate::board::pins::AXES;

/// Number of words that the channel moves before it must be set up again: as many whole rounds of the ring as fit, so that
/// it continues at the place where it began.
const WORDS: u32 = u32::MAX - (CHANGES as u32 - 1);

/// Memory of the ring, aligned to its size. It is atomic, as the channel writes there.
#[repr(C, align(256))]
struct Memory([AtomicU32; CHANGES]);

const _: () = assert!(align_of::<Memory>() == 1 << RING_BITS);

static MEMORY: Memory = Memory([const { AtomicU32::new(0) }; CHANGES]);

/// The ring, and the position up to which it has been read.
#[derive(Clone, Copy)]
pub struct Ring(Reader<CHANGES>);

impl Ring {
    /// Starts the channel on the FIFO of the machine.
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
        ctrl.set_ring_sel(true); // The write address wraps.
        ctrl.set_ring_size(RING_BITS as u8);
        ctrl.set_treq_sel(TreqSel::PIO0_RX3);
        ctrl.set_chain_to(CHANNEL as u8); // A channel that is chained to itself is chained to none.
        ctrl.set_en(true);
        channel.ctrl_trig().write_value(ctrl);
        Self(Reader::new())
    }

    /// Returns true if words are to be read.
    #[inline(always)]
    pub fn has_unread(&mut self) -> bool {
        let written = written();
        if self.0.has_unread(written) {
            return true;
        }
        if written == WORDS {
            // After four billion changes, all of them read, the channel has stopped. Later ones wait in the FIFO.
            pac::DMA
                .ch(CHANNEL)
                .al1_trans_count_trig()
                .write_value(WORDS);
            self.0 = Reader::new();
        }
        false
    }

    /// Next unread word.
    #[inline(always)]
    pub fn peek(&mut self) -> Option<u32> {
        self.0.peek(&MEMORY.0, written)
    }

    /// Advances to the next word.
    #[inline(always)]
    pub const fn advance(&mut self) {
        self.0.advance();
    }
}

/// Number of words that the channel has written. It lowers its count when it begins a transfer, which ends before the core can read the
/// word.
fn written() -> u32 {
    WORDS.wrapping_sub(pac::DMA.ch(CHANNEL).trans_count().read())
}
