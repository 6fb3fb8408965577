//! Phase of an axis over one tick, and at a cycle of it.

use super::modes::AxisSet;
use crate::functions::{multiply_high, multiply_long};
use crate::units::{MAX_AXES, PerAxis, Phase, Turns};

/// Time of an index pulse, relative to the tick that was over when it was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexPulse {
    /// Cycles of the step clock from the beginning of that tick, up to a tick's cycles; negative if it
    /// came in the tick before, and was confirmed in that one.
    pub cycle: i32,
}

/// Index pulses that are read at a deadline, at most one of each axis.
#[derive(Clone, Copy, Debug)]
pub struct IndexPulses {
    axes: AxisSet,
    /// Cycle of each pulse; valid only for axes that have one.
    cycle: PerAxis<i32>,
}

impl IndexPulses {
    /// No pulse of any axis.
    pub const NONE: Self = Self {
        axes: 0,
        cycle: [0; MAX_AXES],
    };

    /// Axes that have a pulse.
    #[inline(always)]
    pub const fn axes(&self) -> AxisSet {
        self.axes
    }

    /// Pulse of an axis.
    #[inline]
    pub fn of(&self, axis: usize) -> Option<IndexPulse> {
        let cycle = *self.cycle.get(axis)?;
        (self.axes & 1 << axis != 0).then_some(IndexPulse { cycle })
    }

    /// Replaces the pulse of an axis.
    #[inline]
    pub fn set(&mut self, axis: usize, pulse: Option<IndexPulse>) {
        if let Some(cycle) = self.cycle.get_mut(axis) {
            self.axes &= !(1 << axis);
            if let Some(pulse) = pulse {
                self.axes |= 1 << axis;
                *cycle = pulse.cycle;
            }
        }
    }

    /// Swaps the pulses of two axes.
    pub fn swap(&mut self, one: usize, other: usize) {
        let (of_one, of_other) = (self.of(one), self.of(other));
        self.set(one, of_other);
        self.set(other, of_one);
    }

    /// Removes all pulses.
    #[inline(always)]
    pub const fn clear(&mut self) {
        self.axes = 0;
    }
}

impl From<PerAxis<Option<IndexPulse>>> for IndexPulses {
    fn from(of_axes: PerAxis<Option<IndexPulse>>) -> Self {
        let mut pulses = Self::NONE;
        for (axis, pulse) in of_axes.into_iter().enumerate() {
            pulses.set(axis, pulse);
        }
        pulses
    }
}

/// Phase of an axis over one tick, at constant speed.
#[derive(Clone, Copy, Debug, Default)]
pub struct TickPhase {
    /// Phase at the tick's beginning.
    pub start: Phase,
    /// Turns in the tick.
    pub turns: Turns,
}

/// A tick has at most 18 bits of cycles.
const CYCLE_SPARE_BITS: u32 = 14;

/// Length of a tick.
#[derive(Clone, Copy, Debug, Hash)]
pub(super) struct TickClock {
    pub(super) cycles: u32,
    /// 2⁴² / cycles.
    per_cycle: u32,
}

impl TickClock {
    /// Clock of a tick of `cycles`, at least 2048.
    pub(super) const fn new(cycles: u32) -> Self {
        Self {
            cycles,
            per_cycle: ((1 << (24 + 32 - CYCLE_SPARE_BITS)) / cycles as u64) as u32, // at most 2³¹
        }
    }
}

impl TickPhase {
    /// A tick in which nothing moves.
    pub const fn still(phase: Phase) -> Self {
        Self {
            start: phase,
            turns: Turns::ZERO,
        }
    }

    /// A tick of `turns` that ends at this phase.
    pub(super) const fn ending_at(end: Phase, turns: Turns) -> Self {
        Self {
            start: end.advanced(turns.wrapping_neg()),
            turns,
        }
    }

    /// Phase `cycle` cycles into a tick.
    pub(super) fn at(&self, cycle: u32, clock: TickClock) -> Phase {
        // cycle / tick_cycles with 24 fraction bits; and of the turns of a tick, below ½, the upper 40: 2⁻²⁴ of a tick
        // is less than a cycle.
        let part = multiply_high(cycle << CYCLE_SPARE_BITS, clock.per_cycle).min(1 << 24);
        let travel = self.turns.to_bits().unsigned_abs() >> 8;
        let travel = (multiply_long(travel, part) >> 16) as i64;
        self.start.advanced(Turns::from_bits(if self.turns < 0 {
            -travel
        } else {
            travel
        }))
    }
}
