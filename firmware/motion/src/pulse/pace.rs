//! How fast an axis steps in a tick: what the times of its edges are reckoned from.
//!
//! Axes that make the same way in as many steps have the same pace, as the cranks of a machine mostly do: it is
//! reckoned once for all of them.

use crate::functions::{multiply_high, multiply_long, normalised, reciprocal, upper_word};
use crate::units::FRACTION_BITS;

/// One half-step, in the planner's units of 2⁻⁴⁸.
pub(super) const HALF_STEP: u64 = 1 << FRACTION_BITS;

/// Fraction bits of times within a tick: the longest tick, 250,000 cycles, then has 32 bits.
pub(super) const TIME_BITS: u32 = 14;

/// The last two paces that were reckoned, for the axes to come: cranks of a machine mostly have one, or, while trims go
/// either way, two.
#[derive(Clone, Debug)]
pub struct Paces {
    tick_cycles: u32,
    kept: [Pace; 2],
    /// The one that was reckoned last.
    newer: usize,
}

impl Paces {
    /// Of axes that stand, in ticks of so many cycles.
    pub const fn new(tick_cycles: u32) -> Self {
        Self {
            tick_cycles,
            kept: [const { Pace::new() }; 2],
            newer: 0,
        }
    }

    /// The pace of an axis that makes `turns`, in 2⁻⁴⁸.
    #[inline(always)]
    pub(super) fn take(&mut self, turns: i64, half_steps_per_turn: u32) -> &Pace {
        let is_it =
            |pace: &Pace| pace.turns == turns && pace.half_steps_per_turn == half_steps_per_turn;
        let [one, other] = &mut self.kept;
        if is_it(one) {
            return one;
        }
        if is_it(other) {
            return other;
        }
        self.newer ^= 1;
        let older = if self.newer == 0 { one } else { other };
        older.reckon(turns, half_steps_per_turn, self.tick_cycles);
        older
    }
}

/// The pace of one axis in one tick.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    /// What it was reckoned from: turns in 2⁻⁴⁸, and half-steps per turn.
    turns: i64,
    half_steps_per_turn: u32,
    /// Half-steps made, without their sign, in 2⁻⁴⁸.
    pub(super) length: u64,
    /// The length has its top bit set, and 32 bits, when it is shifted up by `up` and then down by 32.
    up: u32,
    /// 2⁶³ over that.
    inverse: u32,
    /// [`Self::within`] a whole tick, and the spacing that it gives.
    whole: u32,
    pub(super) spacing: u32,
}

impl Pace {
    /// Of an axis that stands.
    const fn new() -> Self {
        Self {
            turns: 0,
            half_steps_per_turn: 0,
            length: 0,
            up: 0,
            inverse: 0,
            whole: 0,
            spacing: 0,
        }
    }

    #[inline(never)]
    fn reckon(&mut self, turns: i64, half_steps_per_turn: u32, tick_cycles: u32) {
        self.turns = turns;
        self.half_steps_per_turn = half_steps_per_turn;
        self.length = multiply_long(turns.unsigned_abs(), half_steps_per_turn);
        let (scaled, up) = normalised(self.length);
        self.up = up;
        // If it stands nothing will be asked.
        self.inverse = if scaled == 0 { 0 } else { reciprocal(scaled) };
        self.whole = self.within(tick_cycles);
        self.spacing = self.spacing_of(self.whole);
    }

    // With d the scaled length, r = 2^63/d and T a window, m is T r / 2^32. A crossing at f, scaled likewise, comes at
    // T f/d = 2 f m / 2^32, and a half-step, 2^48 of length d 2^(32 − up), takes m 2^(up − 15).

    /// m of a window of so many cycles.
    #[inline(always)]
    const fn within(&self, window: u32) -> u32 {
        multiply_high(window << TIME_BITS, self.inverse)
    }

    #[inline(always)]
    const fn first_of(&self, m: u32, to_first: u64) -> u32 {
        multiply_high(upper_word(to_first, self.up), m) << 1
    }

    #[inline(always)]
    fn spacing_of(&self, m: u32) -> u32 {
        match 15_u32.checked_sub(self.up) {
            Some(down) => m >> down,
            None => 0, // below one half-step there are no two crossings
        }
    }

    /// The time, with [`TIME_BITS`], of the first crossing of a whole tick, `to_first` half-steps of 2⁻⁴⁸ away (at most
    /// the length). Those after it are [`Self::spacing`] apart.
    #[inline(always)]
    pub(super) const fn first(&self, to_first: u64) -> u32 {
        self.first_of(self.whole, to_first)
    }

    /// The same, and the spacing, where all is pressed into a `window` of so many cycles.
    pub(super) fn times(&self, to_first: u64, window: u32) -> (u32, u32) {
        let m = self.within(window);
        (self.first_of(m, to_first), self.spacing_of(m))
    }
}
