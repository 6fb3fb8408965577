//! Constants of the phase offset of one axis, and conversion between steps and turns.

use core::hash::{Hash, Hasher};

use crate::functions::{Divisor, multiply_long};
use crate::pulse::StepsPerTurn;
use crate::settings::{AxisSettings, turns_at_most};
use crate::units::{FRACTION_BITS, ONE_TURN, Turns};

/// One step, in the planner's half-steps of 2⁻⁴⁸.
pub(super) const STEP: i64 = 2 * ONE_TURN;

/// Constants of one axis.
#[derive(Clone, Debug)]
pub(super) struct Lane {
    /// One step in turns of 2⁻⁶⁴, and steps per turn of the crank.
    pub(super) turns_per_step: u64,
    pub(super) steps_per_turn: StepsPerTurn,
    pub(super) limit: Turns,
    pub(super) limit_steps: i32,
    /// Most steps in a slot, and the divisor for it.
    pub(super) slot_steps: u32,
    pub(super) per_slot: Divisor,
    /// Motion in a tick of a slot in which the axis moves by one step: half-steps of 2⁻⁴⁸, and turns of 2⁻⁴⁸.
    pub(super) half_steps_per_tick: i64,
    pub(super) turns_per_tick: i64,
}

impl Lane {
    #[cold]
    pub(super) fn new(axis: &AxisSettings, slot_ticks: u32, slot_steps: u32) -> Self {
        let steps_per_turn = axis.steps_per_crank_turn();
        let ticks = i64::from(slot_ticks);
        Self {
            turns_per_step: steps_per_turn.step_in_2_64(),
            steps_per_turn,
            limit: Turns::from_bits(turns_at_most(axis.trim_limit_turns)),
            // A limit of whole steps stays whole.
            limit_steps: libm::floor(axis.trim_limit_turns * steps_per_turn.to_f64() + 1e-6) as i32,
            slot_steps,
            per_slot: Divisor::new(slot_steps),
            half_steps_per_tick: STEP / ticks,
            turns_per_tick: steps_per_turn.step_turns().0 / ticks,
        }
    }

    /// Hashes one of three slices.
    #[inline(always)]
    pub(super) fn hash_slice(&self, slice: usize, hasher: &mut impl Hasher) {
        let Self {
            turns_per_step,
            steps_per_turn,
            limit,
            limit_steps,
            slot_steps,
            per_slot,
            half_steps_per_tick,
            turns_per_tick,
        } = self;
        match slice {
            0 => (turns_per_step, steps_per_turn, limit).hash(hasher),
            1 => (limit_steps, half_steps_per_tick, turns_per_tick).hash(hasher),
            _ => (slot_steps, per_slot).hash(hasher),
        }
    }

    pub(super) fn limited(&self, turns: Turns) -> Turns {
        turns.max(self.limit.wrapping_neg()).min(self.limit)
    }

    /// Turns of a number of steps, to 2⁻⁴⁸; below one turn.
    pub(super) fn turns_of(&self, steps: i32) -> Turns {
        let all = multiply_long(self.turns_per_step, steps.unsigned_abs());
        let turns = Turns::from_bits(((all >> 15) as i64 + 1) >> 1);
        if steps < 0 {
            turns.wrapping_neg()
        } else {
            turns
        }
    }

    /// Rounds `turns`, up to ±½, to the nearest whole number of steps. Returns it, and how many steps of 2⁻⁴⁸ rounding added. If the offset
    /// with the `other` part would exceed the limit, the result is one step towards a smaller offset.
    pub(super) fn rounded(&self, turns: Turns, other: i32) -> (i32, i64) {
        let (exact, mut steps) = self.steps_per_turn.distance(turns.to_bits());
        let offset = steps + other;
        if offset.abs() > self.limit_steps {
            steps -= offset.signum();
        }
        (
            steps,
            (i64::from(steps) << FRACTION_BITS).wrapping_sub(exact),
        )
    }
}
