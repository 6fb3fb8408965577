//! Constants of the phase offset of one axis, and conversion between steps and turns.

use core::hash::{Hash, Hasher};

use crate::functions::{Divisor, multiply_long};
use crate::pulse::StepsPerTurn;
use crate::settings::{AxisSettings, Settings, turns_at_most};
use crate::units::{FRACTION_BITS, ONE_TURN, Turns};

/// One step, in the planner's half-steps of 2⁻⁴⁸.
pub(super) const STEP: i64 = 2 * ONE_TURN;

/// Steps that an axis moves in a tick of its slot, if it moves at its rate on average.
fn steps_per_tick(settings: &Settings, axis: &AxisSettings) -> f64 {
    let share = settings.axes.len() as f64 / f64::from(settings.tick_hz);
    axis.trim_rate_hz * axis.steps_per_crank_turn().to_f64() * share
}

/// Most steps of an axis in a slot of some ticks.
#[cold]
pub(super) fn slot_steps(settings: &Settings, axis: &AxisSettings, slot_ticks: u32) -> u32 {
    let steps = libm::floor(steps_per_tick(settings, axis) * f64::from(slot_ticks));
    steps.max(1.0) as u32
}

/// Largest motion of any axis in a slot, turns. The settings must have been checked.
#[cold]
pub fn slot_turns(settings: &Settings) -> f64 {
    let ticks = slot_ticks(settings);
    let turns = |axis: &AxisSettings| {
        f64::from(slot_steps(settings, axis, ticks)) / axis.steps_per_crank_turn().to_f64()
    };
    settings.axes.iter().map(turns).fold(0.0, f64::max)
}

/// Shortest slot, in ticks, in which an axis uses at least four fifths of its rate with whole steps.
#[cold]
pub(super) fn slot_ticks(settings: &Settings) -> u32 {
    let each = settings
        .axes
        .iter()
        .map(|axis| steps_per_tick(settings, axis));
    let steps_per_tick = each.fold(f64::INFINITY, f64::min);
    let is_used = |ticks: &u32| {
        let steps = steps_per_tick * f64::from(*ticks);
        libm::floor(steps) >= 0.8 * steps
    };
    let least = libm::ceil(1.0 / steps_per_tick).max(1.0) as u32;
    (least..u32::MAX).find(is_used).unwrap_or(least)
}

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
