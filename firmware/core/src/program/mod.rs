//! The mixing program: amax(t), the acceleration amplitude that the platform is to have.
//!
//! A program is a list of *segments* (a level, the time to get there, the shape of the way, a time
//! to hold it) and of *repeats* that send the reading back over what stands before them. It is read
//! by a [`Cursor`], one control tick at a time; a tick costs the same at the end of a month as at
//! the beginning.

mod builder;
mod cursor;
mod segment;

pub use builder::{EntrySettings, ProgramBuilder, SegmentSettings};
pub use cursor::{Cursor, Reading};
pub use segment::{Segment, Shape};

/// How many entries (segments and repeats) a program holds.
pub const CAPACITY: usize = 128;

/// An entry of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Entry {
    /// Go to a level and stay there.
    Segment(Segment),
    /// Play what stands from entry `first` up to here `times` times in all.
    Repeat { first: u8, times: u16 },
}

/// A checked program; made by [`ProgramBuilder`].
#[derive(Clone, Debug, Default)]
pub struct Program {
    entries: heapless::Vec<Entry, CAPACITY>,
    /// For each entry, the ticks from the program's start to the entry's end, in its first pass and
    /// with the repeats up to it done.
    ends: heapless::Vec<u64, CAPACITY>,
}

impl Program {
    /// A program without entries, which is over at once.
    pub const fn new() -> Self {
        Self {
            entries: heapless::Vec::new(),
            ends: heapless::Vec::new(),
        }
    }

    /// Removes all entries.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.ends.clear();
    }

    /// How long the whole program lasts, in ticks.
    pub fn duration(&self) -> u64 {
        self.ends.last().copied().unwrap_or(0)
    }

    /// The ticks before entry `index`, in its first pass.
    fn start(&self, index: usize) -> u64 {
        match index.checked_sub(1) {
            Some(before) => self.ends.get(before).copied().unwrap_or(0),
            None => 0,
        }
    }
}
