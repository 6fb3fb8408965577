//! Timing of the index pulses: the time at which each of the six lines changed, to 7 cycles (56 ns).
//!
//! The fourth machine of the first block polls all lines at once. A DMA channel moves changes and their times into a
//! ring in RAM ([`program`], [`ring`]). The loop reads the ring once a tick. The core decides, and its tests check,
//! which of these changes are pulses (`cophase_core::monitor`).
//!
//! Times are on the clock of the machines, which is also that of the steps. The machine starts with the first steps and
//! never stops. A line is sampled through the pins' synchroniser, 2 cycles after it changed.

mod program;
mod ring;

use cophase_core::monitor::IndexFilter;
use cophase_core::monitor::IndexPulses;
use embassy_rp::pac;
use embassy_rp::pac::pio::vals::SmExecctrlStatusSel;

use super::{INDEX_MACHINE, pins, relocated, steps};
use program::{COUNT_BITS, POLL_CYCLES, SAMPLED_AFTER};
use ring::Ring;

/// Filter of all lines.
type Filter = IndexFilter<{ pins::AXES }>;

/// Index inputs, and the time up to which the loop has read them.
pub struct Index {
    ring: Ring,
    tick_cycles: i32,
    /// Polls in a tick, and the remaining cycles.
    tick_polls: u32,
    tick_rest: u32,
    /// Polls, and the remaining cycles, from the start of the machine to the start of the tick that is over. The count
    /// of polls wraps with that in the words.
    polls: u32,
    rest: u32,
}

impl Index {
    /// Sets up machine and channel, for ticks of `tick_cycles` cycles. The line of axis 0 is that of the board's axis `first`.
    #[cold]
    pub fn new(tick_cycles: u32, first: usize) -> Self {
        let program = program::index_program();
        let origin = steps::PROGRAM_LENGTH;
        for (slot, &instruction) in program.code.iter().enumerate() {
            let memory = pac::PIO0.instr_mem(origin + slot);
            memory.write(|w| w.set_instr_mem(relocated(instruction, origin)));
        }
        let sm = pac::PIO0.sm(INDEX_MACHINE);
        sm.clkdiv().write(|w| w.set_int(1));
        sm.execctrl().write(|w| {
            w.set_wrap_bottom(program.wrap.target + origin as u8);
            w.set_wrap_top(program.wrap.source + origin as u8);
            w.set_status_sel(SmExecctrlStatusSel::TXLEVEL);
        });
        sm.shiftctrl().write(|w| w.set_fjoin_rx(true)); // Both shift directions are to the left.
        sm.pinctrl()
            .write(|w| w.set_in_base(pins::INDEX + first as u8));
        const JMP: u16 = 0;
        sm.instr().write(|w| w.set_instr(JMP | origin as u16));
        Self {
            ring: Ring::new(),
            tick_cycles: tick_cycles as i32,
            tick_polls: tick_cycles / POLL_CYCLES,
            tick_rest: tick_cycles % POLL_CYCLES,
            polls: 0,
            rest: 0,
        }
    }

    /// Notes that the machine was started, `cycles` before a tick begins. The tick before that one is the next to be
    /// read.
    #[inline(never)] // once a start
    pub const fn begin(&mut self, cycles: u32) {
        let since = cycles as i32 - self.tick_cycles;
        self.polls = since.div_euclid(POLL_CYCLES as i32) as u32;
        self.rest = since.rem_euclid(POLL_CYCLES as i32) as u32;
    }

    /// Reads the changes of the tick that is over, in order, into the filter of the lines.
    #[inline(always)]
    pub fn read(&mut self, filter: &mut Filter) {
        if self.ring.has_unread() {
            self.read_changes(filter);
        }
    }

    #[inline(never)] // seldom
    fn read_changes(&mut self, filter: &mut Filter) {
        // A line changed in the middle of the interval since the poll before: within ±3.5 cycles, or ±7 if the change before
        // it is less than 14 away.
        let offset = (SAMPLED_AFTER - POLL_CYCLES / 2) as i32 - self.rest as i32;
        let mut ring = self.ring; // A copy stays in registers.
        while let Some(word) = ring.peek() {
            // The count of the n-th poll is −n. Relative to the polls before the tick it is small and may be negative.
            const UNUSED_BITS: u32 = u32::BITS - COUNT_BITS;
            let polls = ((!self.polls).wrapping_sub(word) << UNUSED_BITS) as i32 >> UNUSED_BITS;
            let cycle = polls * POLL_CYCLES as i32 + offset;
            if cycle >= self.tick_cycles {
                break; // It belongs to the next tick.
            }
            ring.advance();
            filter.change(cycle, word >> COUNT_BITS);
        }
        self.ring = ring;
    }

    /// Ends the tick for the filter, and takes the pulses that it confirmed.
    #[inline(always)]
    pub fn end_tick(&mut self, filter: &mut Filter, pulses: &mut IndexPulses) {
        // In most ticks no line changed. To skip the filter then saves half the cost of reading.
        if filter.is_pending() {
            filter.end_tick(self.tick_cycles as u32, pulses);
        }
        self.advance();
    }

    /// Advances to the next tick.
    const fn advance(&mut self) {
        self.polls = self.polls.wrapping_add(self.tick_polls);
        self.rest += self.tick_rest;
        if self.rest >= POLL_CYCLES {
            self.rest -= POLL_CYCLES;
            self.polls = self.polls.wrapping_add(1);
        }
    }
}
