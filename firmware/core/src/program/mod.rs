//! Mixing program: amax(t), the acceleration amplitude requested of the platform.
//!
//! A program is a list of *segments* (level, ramp time, ramp shape, hold time) and of *repeats*, which play a block of
//! earlier entries again. A [`Cursor`] reads it, one control tick at a time. A tick costs the same at the end of a month
//! as at the beginning.

mod amplitude;
mod builder;
mod cursor;
mod segment;

use core::hash::{Hash, Hasher};

pub use amplitude::{AmplitudeOverride, MAX_OVERRIDE_PERMILLE};
pub use builder::{AMAX_G, EntrySettings, HOLD_S, ProgramBuilder, RAMP_S, REPEAT, SegmentSettings};
pub use cursor::{Cursor, Reading};
pub use segment::{Segment, Shape};

/// Greatest number of entries (segments and repeats) in a program.
pub const CAPACITY: usize = 128;

/// An entry of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Entry {
    /// Ramp to a level and hold it.
    Segment(Segment),
    /// Play the entries from `first` up to here `times` times in total.
    Repeat { first: u8, times: u16 },
}

/// A checked program; made by [`ProgramBuilder`].
#[derive(Clone, Debug, Default)]
pub struct Program {
    entries: heapless::Vec<Entry, CAPACITY>,
    /// Ticks from the start of the program to the end of each entry, in its first pass and with the repeats up to it
    /// done.
    ends: heapless::Vec<u64, CAPACITY>,
}

impl Program {
    /// Creates a program without entries, which is over at once.
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

    /// Replaces the entries by those of another program.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.clear();
        for (&entry, &end) in other.entries.iter().zip(&other.ends) {
            // Both lists have as much room as those of the other program.
            let _ = self.entries.push(entry);
            let _ = self.ends.push(end);
        }
    }

    /// Hashes one of three slices of an entry. Returns false for the entry after the last.
    #[inline(always)]
    pub(crate) fn hash_slice(&self, index: usize, slice: usize, hasher: &mut impl Hasher) -> bool {
        let Self { entries, ends: _ } = self;
        // Beyond their capacity there are none, even if their number is wrong.
        if index >= CAPACITY {
            return false;
        }
        let Some(entry) = entries.get(index) else {
            return false;
        };
        match entry {
            Entry::Segment(segment) => segment.hash_slice(slice, hasher),
            Entry::Repeat { first, times } if slice == 0 => (first, times).hash(hasher),
            Entry::Repeat { .. } => {}
        }
        if slice == 1 {
            core::mem::discriminant(entry).hash(hasher);
        }
        true
    }

    /// Hashes the end of an entry. Returns false for the entry after the last.
    #[inline(always)]
    pub(crate) fn hash_end(&self, index: usize, hasher: &mut impl Hasher) -> bool {
        match self.ends.get(index) {
            Some(end) if index < CAPACITY => {
                end.hash(hasher);
                true
            }
            _ => false,
        }
    }

    /// Numbers of entries and of their ends, which are equal.
    pub(crate) fn lengths(&self) -> (usize, usize) {
        (self.entries.len(), self.ends.len())
    }

    /// Duration of the whole program, in ticks.
    pub fn duration(&self) -> u64 {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Ticks before entry `index`, in its first pass.
    fn start(&self, index: usize) -> u64 {
        match index.checked_sub(1) {
            Some(before) => self.ends.get(before).copied().unwrap_or(0),
            None => 0,
        }
    }
}
