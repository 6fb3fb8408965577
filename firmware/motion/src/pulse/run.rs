//! A run: one 32-bit word that the step hardware plays by itself.

use core::fmt;

/// Equally spaced edges of STEP, or a pause without edges: one word of the step hardware.
///
/// The layout of the word is a contract with that hardware:
///
/// | bits | field | |
/// | --- | --- | --- |
/// | 0 to 12 | edges | 0 to 8191; 0 is a pause |
/// | 13 to 30 | cycles − 8 | period of a run's edges, or length of the pause: 8 to 262,151 cycles of the step clock |
/// | 31 | DIR | 1 counts up in the axis's own sense |
///
/// In a run STEP changes its level at the end of each period. DIR changes only in a pause, [`Run::DIR_DELAY`] cycles
/// after the pause begins. In a run bit 31 is ignored and repeats the level of the line.
///
/// ```
/// use cophase_motion::pulse::Run;
/// let run = Run::new(4, 125, true);
/// assert_eq!((run.edges(), run.period(), run.cycles()), (4, 125, 500));
/// assert!(Run::pause(500, true).is_pause());
/// ```
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Run(u32);

const EDGE_BITS: u32 = 13;
const CYCLE_BITS: u32 = 18;
const DIR_BIT: u32 = EDGE_BITS + CYCLE_BITS;

impl Run {
    /// Least period, and least pause, in cycles: the time that the hardware needs to read a word.
    pub const MIN_CYCLES: u32 = 8;

    /// Greatest period, and greatest pause, in cycles.
    pub const MAX_CYCLES: u32 = Self::MIN_CYCLES + (1 << CYCLE_BITS) - 1;

    /// Greatest number of edges of one run.
    pub const MAX_EDGES: u32 = (1 << EDGE_BITS) - 1;

    /// Cycles from the start of a pause until DIR has the level that the pause carries.
    pub const DIR_DELAY: u32 = 8;

    /// Run of `edges` (1 to [`Self::MAX_EDGES`]) edges, each at the end of a `period` of [`Self::MIN_CYCLES`] to
    /// [`Self::MAX_CYCLES`] cycles. `forward` must be the present level of DIR.
    pub const fn new(edges: u32, period: u32, forward: bool) -> Self {
        debug_assert!(edges > 0 && edges <= Self::MAX_EDGES);
        Self::word(edges, period, forward)
    }

    /// Pause of `cycles` ([`Self::MIN_CYCLES`] to [`Self::MAX_CYCLES`]) without edges; DIR has the level `forward`
    /// from [`Self::DIR_DELAY`] on.
    pub const fn pause(cycles: u32, forward: bool) -> Self {
        Self::word(0, cycles, forward)
    }

    const fn word(edges: u32, cycles: u32, forward: bool) -> Self {
        debug_assert!(cycles >= Self::MIN_CYCLES && cycles <= Self::MAX_CYCLES);
        let cycles = cycles.wrapping_sub(Self::MIN_CYCLES) << EDGE_BITS;
        Self(edges | cycles | (forward as u32) << DIR_BIT)
    }

    /// Checks that the edges of another run continue this one: with the same period, in the same direction.
    #[inline(always)]
    pub(super) const fn goes_on_with(self, other: Self) -> bool {
        (self.0 ^ other.0) >> EDGE_BITS == 0
    }

    /// Extends this run by `edges`.
    #[inline(always)]
    pub(super) const fn lengthened(self, edges: u32) -> Self {
        debug_assert!(!self.is_pause() && self.edges() + edges <= Self::MAX_EDGES);
        Self(self.0 + edges)
    }

    /// Word for the hardware.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Number of edges; 0 is a pause.
    pub const fn edges(self) -> u32 {
        self.0 & Self::MAX_EDGES
    }

    /// Cycles before each edge, or length of the pause in cycles.
    pub const fn period(self) -> u32 {
        ((self.0 >> EDGE_BITS) & ((1 << CYCLE_BITS) - 1)) + Self::MIN_CYCLES
    }

    /// Level of DIR: for a run the present level of the line, for a pause the new one.
    pub const fn forward(self) -> bool {
        self.0 >> DIR_BIT == 1
    }

    /// True for a pause.
    pub const fn is_pause(self) -> bool {
        self.edges() == 0
    }

    /// Total duration in cycles.
    pub const fn cycles(self) -> u32 {
        match self.edges() {
            0 => self.period(),
            edges => self.period() * edges,
        }
    }
}

/// Bits common to all runs of one direction; with them, making a run takes a shift and two additions.
#[derive(Clone, Copy)]
pub(super) struct RunsOf(u32);

impl RunsOf {
    #[inline(always)]
    pub(super) const fn new(forward: bool) -> Self {
        Self(((forward as u32) << DIR_BIT).wrapping_sub(Run::MIN_CYCLES << EDGE_BITS))
    }

    /// Makes a run as [`Run::new`] does, or without edges a pause as [`Run::pause`] does.
    #[inline(always)]
    pub(super) const fn run(self, edges: u32, period: u32) -> Run {
        Run(self.0.wrapping_add(period << EDGE_BITS).wrapping_add(edges))
    }
}

impl fmt::Debug for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run")
            .field("edges", &self.edges())
            .field("period", &self.period())
            .field("forward", &self.forward())
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The layout, bit for bit. The program of the hardware relies on it.
    #[test]
    fn the_word_has_the_layout_of_the_hardware() {
        assert_eq!(Run::new(1, 8, false).bits(), 1);
        assert_eq!(Run::new(1, 9, false).bits(), 0x2001);
        assert_eq!(Run::pause(8, true).bits(), 0x8000_0000);
        assert_eq!(Run::new(8191, 262_151, true).bits(), u32::MAX);
    }

    proptest! {
        /// If this fails, fields overlap or are too narrow, and do not return the values that were put in.
        #[test]
        fn run_fields_round_trip_through_the_word(
            edges in 1..=Run::MAX_EDGES,
            cycles in Run::MIN_CYCLES..=Run::MAX_CYCLES,
            forward: bool,
        ) {
            let run = Run::new(edges, cycles, forward);
            prop_assert_eq!((run.edges(), run.period(), run.forward()), (edges, cycles, forward));
            prop_assert!(!run.is_pause());
            prop_assert_eq!(RunsOf::new(forward).run(edges, cycles), run);
            prop_assert_eq!(RunsOf::new(forward).run(0, cycles), Run::pause(cycles, forward));
            prop_assert!(run.goes_on_with(Run::new(1, cycles, forward)));
            prop_assert!(!run.goes_on_with(Run::new(edges, cycles, !forward)));
            prop_assert!(!run.goes_on_with(Run::new(edges, cycles ^ 1, forward)));
            let pause = Run::pause(cycles, forward);
            prop_assert_eq!((pause.edges(), pause.cycles(), pause.forward()), (0, cycles, forward));
            prop_assert!(pause.is_pause());
        }
    }
}
