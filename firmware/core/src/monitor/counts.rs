//! Counts of a sensor that shows the position of a motor in every tick, as turns of its crank.

use core::hash::Hash;

use crate::functions::Ratio;
use crate::settings::AxisSettings;
use crate::units::Turns;

/// Conversion of counts to turns of the crank, exact over any number of readings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counts {
    /// True if the counts are against the axis's own sense.
    reversed: bool,
    /// Turns per count: whole units, and the exact fraction of one that is left, with the remainder so far.
    per_count: i64,
    fraction: Ratio,
    last: Option<i32>,
}

impl Counts {
    #[cold]
    pub(super) const fn new(axis: &AxisSettings) -> Self {
        let (per_count, fraction) = axis.steps_per_crank_turn().step_turns();
        Self {
            reversed: axis.reversed,
            per_count,
            fraction,
            last: None,
        }
    }

    /// Forgets the last reading, because the motor may have been turned since.
    pub(super) const fn forget(&mut self) {
        self.last = None;
    }

    /// Turns of the crank since the last reading, in the sense of the axis; none for the first.
    pub(super) fn travel(&mut self, reading: i32) -> Option<Turns> {
        // A tick has at most half a turn, which is at most 2^15 counts. A larger difference is invalid, and may wrap.
        let counts = i64::from(reading.wrapping_sub(self.last.replace(reading)?));
        let counts = if self.reversed { -counts } else { counts };
        let whole = counts.wrapping_mul(self.per_count);
        let fraction = self.fraction.advance(counts);
        Some(Turns::from_bits(whole.wrapping_add(fraction)))
    }

    /// Constants, which no tick changes.
    pub(super) fn constants(&self) -> impl Hash + use<> {
        let Self {
            reversed,
            per_count,
            fraction,
            last: _,
        } = *self;
        (reversed, per_count, fraction.constants())
    }
}
