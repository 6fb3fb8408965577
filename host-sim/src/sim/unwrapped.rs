//! Conversion of a wrapping phase to turns since power-up.

use cophase_core::units::{Phase, Turns};

/// Turns since power-up. Whole turns and the fraction are separate, so that the fraction keeps its resolution after a
/// month of turns.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwrapped {
    last: Phase,
    turns: i64,
    rest: i64,
}

impl Unwrapped {
    /// Creates the turns of an axis that is at a phase at power-up: at its offset.
    pub fn starting_at(phase: Phase) -> Self {
        let mut unwrapped = Self::default();
        unwrapped.follow(phase);
        unwrapped
    }

    /// Takes in the next phase, less than half a wrap from the last. Returns the turns since power-up.
    pub fn follow(&mut self, phase: Phase) -> f64 {
        const ONE: i64 = Turns::ONE.to_bits();
        let rest = self.rest + phase.since(self.last).to_bits();
        self.last = phase;
        self.turns += rest >> Turns::FRAC_NBITS;
        self.rest = rest & (ONE - 1);
        self.turns as f64 + self.rest as f64 / ONE as f64
    }
}
