//! Step rate of an axis in a tick, from which the times of its edges are computed.
//!
//! Axes with the same travel and the same steps per turn share one step rate, as the cranks of a machine mostly do. It
//! is computed once for all of them.

use crate::functions::{multiply_high, multiply_long, normalised, reciprocal, upper_word};
use crate::units::FRACTION_BITS;

/// One half-step, in the planner's units of 2⁻⁴⁸.
pub(super) const HALF_STEP: u64 = 1 << FRACTION_BITS;

/// Fraction bits of times within a tick; with these the longest tick, 2¹⁸ − 1 cycles, has 32 bits.
pub(super) const TIME_BITS: u32 = 14;

/// Cache of the last two computed step rates, for the next axes.
///
/// The cranks of a machine mostly have one step rate, or two while a phase offset moves.
#[derive(Clone, Debug)]
pub struct StepRates {
    tick_cycles: u32,
    kept: [StepRate; 2],
    /// Index of the one that was computed last.
    newer: usize,
}

impl StepRates {
    /// Step rates of axes at rest, in ticks of `tick_cycles` cycles.
    pub const fn new(tick_cycles: u32) -> Self {
        Self {
            tick_cycles,
            kept: [const { StepRate::new() }; 2],
            newer: 0,
        }
    }

    /// Cycles of a tick, which never change.
    pub const fn tick_cycles(&self) -> u32 {
        let Self {
            tick_cycles,
            kept: _,
            newer: _,
        } = self;
        *tick_cycles
    }

    /// Step rate of an axis that covers `turns`, in 2⁻⁴⁸, in a tick, and `offset` half-steps more, in 2⁻⁴⁸.
    #[inline(always)]
    pub(super) fn take(&mut self, turns: i64, offset: i64, half_steps_per_turn: u32) -> &StepRate {
        let is_it = |step_rate: &StepRate| {
            step_rate.turns == turns
                && step_rate.half_steps_per_turn == half_steps_per_turn
                && step_rate.offset == offset
        };
        let [one, other] = &mut self.kept;
        if is_it(one) {
            return one;
        }
        if is_it(other) {
            return other;
        }
        self.newer ^= 1;
        let older = if self.newer == 0 { one } else { other };
        older.compute(turns, offset, half_steps_per_turn, self.tick_cycles);
        older
    }
}

/// Step rate of one axis in one tick.
#[derive(Clone, Debug)]
pub(super) struct StepRate {
    /// Inputs of the computation: turns in 2⁻⁴⁸, half-steps on top of them in 2⁻⁴⁸, and half-steps per turn.
    turns: i64,
    offset: i64,
    half_steps_per_turn: u32,
    /// False if the half-steps are covered backwards.
    pub(super) forward: bool,
    /// Half-steps covered, without their sign, in 2⁻⁴⁸.
    pub(super) length: u64,
    /// Shift that normalises the length: shifted up by `up` and then down by 32, it has its top bit set, and 32 bits.
    up: u32,
    /// 2⁶³ divided by the normalised length.
    inverse: u32,
    /// [`Self::within`] a whole tick, and the spacing that it gives.
    whole: u32,
    pub(super) spacing: u32,
}

impl StepRate {
    /// Step rate of an axis at rest.
    const fn new() -> Self {
        Self {
            turns: 0,
            offset: 0,
            half_steps_per_turn: 0,
            forward: true,
            length: 0,
            up: 0,
            inverse: 0,
            whole: 0,
            spacing: 0,
        }
    }

    #[inline(always)] // Its arguments take as long as a quarter of it.
    fn compute(&mut self, turns: i64, offset: i64, half_steps_per_turn: u32, tick_cycles: u32) {
        self.turns = turns;
        self.offset = offset;
        self.half_steps_per_turn = half_steps_per_turn;
        let length = multiply_long(turns as u64, half_steps_per_turn) as i64 + offset;
        self.forward = length >= 0;
        self.length = length.unsigned_abs();
        let (scaled, up) = normalised(self.length);
        self.up = up;
        // At rest the inverse is never used.
        self.inverse = if scaled == 0 { 0 } else { reciprocal(scaled) };
        self.whole = self.within(tick_cycles);
        self.spacing = self.spacing_of(self.whole);
    }

    // With d the scaled length, r = 2^63/d and T a window, m is T r / 2^32. A crossing at f, scaled likewise, comes at
    // T f/d = 2 f m / 2^32, and a half-step, 2^48 of length d 2^(32 − up), takes m 2^(up − 15).

    /// m for a window in cycles.
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
            None => 0, // Below one half-step there are no two crossings.
        }
    }

    /// Time, with [`TIME_BITS`], of the first crossing of a whole tick, `to_first` half-steps of 2⁻⁴⁸ away (at most
    /// the length). Later crossings are [`Self::spacing`] apart.
    #[inline(always)]
    pub(super) const fn first(&self, to_first: u64) -> u32 {
        self.first_of(self.whole, to_first)
    }

    /// Time of the first crossing and the spacing, where all crossings are compressed into a `window` in cycles.
    pub(super) fn times(&self, to_first: u64, window: u32) -> (u32, u32) {
        let m = self.within(window);
        (self.first_of(m, to_first), self.spacing_of(m))
    }
}
