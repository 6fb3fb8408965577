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
#[derive(Clone, Debug, Default)]
pub struct Paces {
    kept: [Pace; 2],
    /// The one that was reckoned last.
    newer: usize,
}

impl Paces {
    /// Of axes that stand.
    pub const fn new() -> Self {
        Self {
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
        older.reckon(turns, half_steps_per_turn);
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
        }
    }

    #[inline(never)]
    fn reckon(&mut self, turns: i64, half_steps_per_turn: u32) {
        self.turns = turns;
        self.half_steps_per_turn = half_steps_per_turn;
        self.length = multiply_long(turns.unsigned_abs(), half_steps_per_turn);
        let (scaled, up) = normalised(self.length);
        self.up = up;
        // If it stands nothing will be asked.
        self.inverse = if scaled == 0 { 0 } else { reciprocal(scaled) };
    }

    /// Times within `window` cycles, with [`TIME_BITS`]: of the first crossing, `to_first` half-steps of 2⁻⁴⁸ away (at
    /// most the length), and between two.
    #[inline(always)]
    pub(super) fn times(&self, to_first: u64, window: u32) -> (u32, u32) {
        // With d the scaled length, r = 2^63/d and T the window: m is T r / 2^32. A crossing at f, scaled likewise,
        // comes at T f/d = 2 f m / 2^32, and a half-step, 2^48 of length d 2^(32 − up), takes m 2^(up − 15). Below one
        // half-step there are no two crossings.
        let m = multiply_high(window << TIME_BITS, self.inverse);
        let f = upper_word(to_first, self.up);
        let spacing = match 15_u32.checked_sub(self.up) {
            Some(down) => m >> down,
            None => 0,
        };
        (multiply_high(f, m) << 1, spacing)
    }
}

impl Default for Pace {
    fn default() -> Self {
        Self::new()
    }
}
