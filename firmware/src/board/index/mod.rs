//! Timing of the index pulses: the time at which each of the six lines changed, to 7 cycles (56 ns).
//!
//! The fourth machine of the first block polls all lines at once. A DMA channel moves changes and their times into a
//! ring in RAM ([`program`], [`ring`]). The loop reads the ring once a tick. The core decides, and its tests check,
//! which of these changes are pulses (`cophase_core::drift`).
//!
//! Times are on the clock of the machines, which is also that of the steps. The machine starts with the first steps and
//! never stops. A line is sampled through the pins' synchroniser, 2 cycles after it changed.

mod program;
mod ring;

use embassy_rp::pac;
use embassy_rp::pac::pio::vals::SmExecctrlStatusSel;

use super::{INDEX_MACHINE, lines, pins, relocated, steps};
use program::{COUNT_BITS, POLL_CYCLES, SAMPLED_AFTER};
use ring::Ring;

/// Bits of a word that count polls.
const COUNT: u32 = (1 << COUNT_BITS) - 1;

/// A change of the lines.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    /// All levels after the change, a bit an axis.
    pub levels: u8,
    /// Lines that differ from the change before; all lines for the first change.
    pub changed: u8,
    /// Time in cycles from the beginning of the tick that is over; within ±3.5, or ±7 if the change before it is less
    /// than 14 away.
    pub cycle: i32,
}

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
    /// Levels of the lines after the last change that was read, and the lines whose levels are unknown.
    levels: u8,
    unknown: u8,
    /// Lines that changed and have not been cleared since.
    pending: u8,
}

impl Index {
    /// Sets up pins, machine and channel, for ticks of `tick_cycles` cycles.
    #[cold]
    pub fn new(tick_cycles: u32) -> Self {
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
        sm.pinctrl().write(|w| w.set_in_base(pins::INDEX));
        const JMP: u16 = 0;
        sm.instr().write(|w| w.set_instr(JMP | origin as u16));
        for axis in 0..pins::AXES as u8 {
            // A missing sensor, or one with a broken wire, makes no pulse.
            lines::input(pins::INDEX + axis, lines::Pull::Down);
        }
        Self {
            ring: Ring::new(),
            tick_cycles: tick_cycles as i32,
            tick_polls: tick_cycles / POLL_CYCLES,
            tick_rest: tick_cycles % POLL_CYCLES,
            polls: 0,
            rest: 0,
            levels: 0,
            unknown: u8::MAX,
            pending: u8::MAX,
        }
    }

    /// Notes that the machine was started, `cycles` before a tick begins. The tick before that one is the next to be
    /// read.
    pub const fn begin(&mut self, cycles: u32) {
        let since = cycles as i32 - self.tick_cycles;
        self.polls = since.div_euclid(POLL_CYCLES as i32) as u32;
        self.rest = since.rem_euclid(POLL_CYCLES as i32) as u32;
    }

    /// Reads the changes of the tick that is over, in order.
    pub fn read(&mut self, mut change: impl FnMut(Change)) {
        let mut waiting = self.ring.waiting();
        while waiting > 0 {
            let word = self.ring.peek();
            let cycle = self.cycle(word);
            if cycle >= self.tick_cycles {
                return; // It belongs to the next tick.
            }
            let levels = (word >> COUNT_BITS) as u8;
            let changed = (levels ^ self.levels) | self.unknown;
            (self.levels, self.unknown) = (levels, 0);
            self.pending |= changed;
            change(Change {
                levels,
                changed,
                cycle,
            });
            self.ring.advance();
            waiting -= 1;
        }
    }

    /// Lines, a bit each, that have changed since they were [cleared](Self::clear_pending).
    pub const fn pending(&self) -> u8 {
        self.pending
    }

    /// Marks a line as processed until it changes again.
    pub const fn clear_pending(&mut self, axis: usize) {
        self.pending &= !(1 << axis);
    }

    /// Length of a tick in cycles.
    pub const fn tick_cycles(&self) -> u32 {
        self.tick_cycles as u32
    }

    /// Advances to the next tick.
    pub const fn end_tick(&mut self) {
        self.polls = self.polls.wrapping_add(self.tick_polls);
        self.rest += self.tick_rest;
        if self.rest >= POLL_CYCLES {
            self.rest -= POLL_CYCLES;
            self.polls = self.polls.wrapping_add(1);
        }
    }

    /// Time at which the lines changed: the middle of the interval since the poll before.
    const fn cycle(&self, word: u32) -> i32 {
        // The count of the n-th poll is −n. Relative to the polls before the tick it is small and may be negative.
        let polls = word.wrapping_neg().wrapping_sub(1).wrapping_sub(self.polls) & COUNT;
        const UNUSED_BITS: u32 = u32::BITS - COUNT_BITS;
        let polls = (polls << UNUSED_BITS) as i32 >> UNUSED_BITS;
        polls * POLL_CYCLES as i32 + (SAMPLED_AFTER - POLL_CYCLES / 2) as i32 - self.rest as i32
    }
}
