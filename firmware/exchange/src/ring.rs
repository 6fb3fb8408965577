//! A ring of words in memory that hardware fills, and does not wait for its reader.

#[cfg(not(feature = "loom"))]
pub use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering;
#[cfg(feature = "loom")]
pub use loom::sync::atomic::AtomicU32;

/// Reader of a ring: word n of the stream is at place n modulo `N`.
///
/// The writer writes a word first, and counts it then. `written` returns that count, wrapping. It counts no word that is not in the ring
/// yet.
///
/// The writer may overrun the reader. Then the unread words are skipped: some are overwritten, and the order of the rest is unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reader<const N: usize> {
    /// Number of words read or skipped, wrapping.
    read: u32,
}

impl<const N: usize> Reader<N> {
    /// Reader of a stream from its first word on.
    pub const fn new() -> Self {
        // The place of a word must not jump when the count wraps.
        const { assert!(N.is_power_of_two()) };
        Self { read: 0 }
    }

    /// Returns true if there are unread words.
    #[inline(always)]
    pub const fn has_unread(&self, written: u32) -> bool {
        written != self.read
    }

    /// Next unread word, which stays unread until [`Self::advance`]. Returns none if there is none, or if the writer has overrun the reader.
    #[inline(always)]
    pub fn peek(&mut self, ring: &[AtomicU32; N], written: impl Fn() -> u32) -> Option<u32> {
        if !self.has_unread(written()) {
            return None;
        }
        let place = self.read as usize % N;
        let word = ring.get(place)?.load(Ordering::Acquire);
        // The count comes after the word, so it has all words that can be at this place by now but one: the writer may have written that
        // one, and not counted it yet. Therefore a ring with N unread words counts as overrun.
        let now = written();
        if now.wrapping_sub(self.read) as usize >= N {
            self.read = now;
            return None;
        }
        Some(word)
    }

    /// Advances to the next word.
    #[inline(always)]
    pub const fn advance(&mut self) {
        self.read = self.read.wrapping_add(1);
    }
}
