//! Timing of the index pulses: when each of the six lines changed, to 7 cycles (56 ns).
//!
//! The first block's fourth machine looks at all lines at once, and what changed goes with its time through
//! a DMA channel into a ring in RAM ([`program`], [`ring`]). The loop reads the ring once a tick. Which of
//! these changes are pulses is decided in the core (`cophase_core::drift`), where it is tested.
//!
//! Times are on the machines' clock, which is the steps' own: the machine is let go with the first steps
//! and never held again. A line is sampled through the pins' synchroniser, 2 cycles after it changed.

mod program;
mod ring;

use embassy_rp::pac;
use embassy_rp::pac::pio::vals::SmExecctrlStatusSel;

use super::{INDEX_MACHINE, lines, pins, relocated, steps};
use program::{COUNT_BITS, LOOK_CYCLES, SAMPLED_AFTER};
use ring::Ring;

/// The part of a word that counts looks.
const COUNT: u32 = (1 << COUNT_BITS) - 1;

/// A change of the lines.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    /// All levels after it, a bit an axis.
    pub levels: u8,
    /// Those that differ from the change before; of the first one all.
    pub changed: u8,
    /// When, in cycles from the beginning of the tick that is over; within ±3.5, or ±7 if the change before
    /// it is less than 14 away.
    pub cycle: i32,
}

/// The index inputs, and how far the loop has followed their time.
pub struct Index {
    ring: Ring,
    tick_cycles: i32,
    /// Looks, and cycles beyond, in a tick.
    tick_looks: u32,
    tick_rest: u32,
    /// Looks, and cycles beyond, from the machine's beginning to that of the tick that is over. Looks wrap
    /// with the words' count.
    looks: u32,
    rest: u32,
    /// What the lines were after the last change that was read, and which of them are not known.
    levels: u8,
    unknown: u8,
    /// Lines that changed and have not been said to be quiet again.
    stirred: u8,
}

impl Index {
    /// Sets up pins, machine and channel. `tick_cycles` is a tick's cycles.
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
        sm.shiftctrl().write(|w| w.set_fjoin_rx(true)); // both directions to the left
        sm.pinctrl().write(|w| w.set_in_base(pins::INDEX));
        const JMP: u16 = 0;
        sm.instr().write(|w| w.set_instr(JMP | origin as u16));
        for axis in 0..pins::AXES as u8 {
            // A sensor that is not there, or whose wire is broken, makes no pulse.
            lines::input(pins::INDEX + axis, lines::Pull::Down);
        }
        Self {
            ring: Ring::new(),
            tick_cycles: tick_cycles as i32,
            tick_looks: tick_cycles / LOOK_CYCLES,
            tick_rest: tick_cycles % LOOK_CYCLES,
            looks: 0,
            rest: 0,
            levels: 0,
            unknown: u8::MAX,
            stirred: u8::MAX,
        }
    }

    /// Takes note that the machine has been let go, `cycles` before a tick begins; the tick before that one is
    /// the next to be read.
    pub const fn begin(&mut self, cycles: u32) {
        let since = cycles as i32 - self.tick_cycles;
        self.looks = since.div_euclid(LOOK_CYCLES as i32) as u32;
        self.rest = since.rem_euclid(LOOK_CYCLES as i32) as u32;
    }

    /// Reads the changes of the tick that is over, in order.
    pub fn read(&mut self, mut change: impl FnMut(Change)) {
        let mut waiting = self.ring.waiting();
        while waiting > 0 {
            let word = self.ring.peek();
            let cycle = self.cycle(word);
            if cycle >= self.tick_cycles {
                return; // the next tick's
            }
            let levels = (word >> COUNT_BITS) as u8;
            let changed = (levels ^ self.levels) | self.unknown;
            (self.levels, self.unknown) = (levels, 0);
            self.stirred |= changed;
            change(Change {
                levels,
                changed,
                cycle,
            });
            self.ring.advance();
            waiting -= 1;
        }
    }

    /// Lines, a bit each, that have changed since they were [`Self::calmed`].
    pub const fn stirred(&self) -> u8 {
        self.stirred
    }

    /// Takes note that nothing that a line did is of consequence any more, until it changes again.
    pub const fn calmed(&mut self, axis: usize) {
        self.stirred &= !(1 << axis);
    }

    /// Cycles of a tick.
    pub const fn tick_cycles(&self) -> u32 {
        self.tick_cycles as u32
    }

    /// Goes on to the next tick.
    pub const fn end_tick(&mut self) {
        self.looks = self.looks.wrapping_add(self.tick_looks);
        self.rest += self.tick_rest;
        if self.rest >= LOOK_CYCLES {
            self.rest -= LOOK_CYCLES;
            self.looks = self.looks.wrapping_add(1);
        }
    }

    /// When the lines changed, in the middle of when they may have: since the look before.
    const fn cycle(&self, word: u32) -> i32 {
        // The n-th look's count is −n. Less those before the tick, the difference is small and may be negative.
        let looks = word.wrapping_neg().wrapping_sub(1).wrapping_sub(self.looks) & COUNT;
        const UNUSED_BITS: u32 = u32::BITS - COUNT_BITS;
        let looks = (looks << UNUSED_BITS) as i32 >> UNUSED_BITS;
        looks * LOOK_CYCLES as i32 + (SAMPLED_AFTER - LOOK_CYCLES / 2) as i32 - self.rest as i32
    }
}
