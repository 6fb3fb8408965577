//! Index pulses of a tick.

use crate::units::{AxisSet, MAX_AXES, PerAxis};

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
