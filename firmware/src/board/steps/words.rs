//! Words of a tick in memory, as the channels read them.

use core::arch::asm;

use cophase_core::pulse::{BLOCK, MAX_RUNS, Run, Runs};

use super::AXES;

/// DIR in a word.
pub const DIR: u32 = 1 << 31;

/// Buffer for the words of one tick of one axis, after one for the pause at the start.
pub struct Words {
    words: [u32; MAX_RUNS + 1],
    /// Number of words that the tick uses.
    count: u32,
}

impl Words {
    const EMPTY: Self = Self {
        words: [0; MAX_RUNS + 1],
        count: 0,
    };

    /// Copies a tick's runs. Inverts DIR for an axis that is reversed.
    ///
    /// The compiler's own loop is for long copies, and takes twice as long for the 5 to 10 runs of a tick.
    #[inline(always)]
    pub fn copy(&mut self, runs: &Runs, reversed: u32) {
        const { assert!(BLOCK == 4 && size_of::<Run>() == size_of::<u32>()) };
        let blocks = runs.blocks();
        if !blocks.is_empty() {
            let [_, words @ ..] = &mut self.words;
            // SAFETY: whole blocks have at most MAX_RUNS runs, for which there is room behind the first word. A run is
            // a word. Only that room and these registers are changed.
            unsafe {
                asm!(
                    "2:",
                    "ldmia {from}!, {{r2, r3}}",
                    "eors r2, {reversed}",
                    "eors r3, {reversed}",
                    "stmia {to}!, {{r2, r3}}",
                    "ldmia {from}!, {{r2, r3}}",
                    "eors r2, {reversed}",
                    "eors r3, {reversed}",
                    "stmia {to}!, {{r2, r3}}",
                    "subs {blocks}, #1",
                    "bne 2b",
                    from = inout(reg) blocks.as_ptr() => _,
                    to = inout(reg) words.as_mut_ptr() => _,
                    blocks = inout(reg) blocks.len() => _,
                    reversed = in(reg) reversed,
                    out("r2") _,
                    out("r3") _,
                    options(nostack),
                );
            }
        }
        self.count = runs.len() as u32;
    }

    /// The tick's words.
    #[inline(always)]
    pub fn tick(&self) -> Span {
        let [_, words @ ..] = &self.words;
        Span::new(words, self.count)
    }

    /// Puts a pause of `cycles` before the tick, with the DIR with which the tick begins.
    pub const fn begin_with_pause(&mut self, cycles: u32) {
        let [pause, first, ..] = &mut self.words;
        *pause = Run::pause(cycles, *first & DIR != 0).bits();
    }

    /// The pause before the tick, and the tick's words.
    pub fn with_pause(&self) -> Span {
        Span::new(&self.words, 1 + self.count)
    }
}

/// Words in memory, for a channel to move.
#[derive(Clone, Copy)]
pub struct Span {
    /// Address of the first.
    pub address: u32,
    /// Number of words.
    pub count: u32,
}

impl Span {
    /// No words.
    pub const EMPTY: Self = Self {
        address: 0,
        count: 0,
    };

    /// The first `count` of `words`, or all if there are fewer.
    #[inline(always)]
    fn new(words: &[u32], count: u32) -> Self {
        Self {
            address: words.as_ptr() as u32,
            count: count.min(words.len() as u32),
        }
    }
}

/// Room for two ticks of every axis: the one that is played, and the next one.
pub struct Buffers([[Words; AXES]; 2]);

impl Buffers {
    /// Empty.
    pub const fn new() -> Self {
        Self([const { [const { Words::EMPTY }; AXES] }; 2])
    }

    /// The room for each of the two ticks.
    pub const fn split(&mut self) -> [&mut [Words; AXES]; 2] {
        let Self([free, given]) = self;
        [free, given]
    }
}
