//! Steady drift: a phase error that walks in one direction, turn after turn.
//!
//! A sensor that shifts on its bracket and a crank that shifts on its shaft look the same to the monitor. A correction follows either, so
//! that no limit is reached for a long time. The mean of the phase error over [`WINDOW_TURNS`] turns shows it early. It makes a *step* where
//! it is further than half a tolerance from the mean at the last step. [`STEPS`] steps in a row in one direction are a steady drift. Together
//! they exceed two tolerances, which is the largest difference of two readings of a crank that has not moved.
//!
//! A jump is no drift: it has a name of its own, and the caller subtracts it. A jump that is too small for a name makes two steps at most,
//! as it lies in one window. An error that comes and goes, with the load or the temperature, ends a row.

use crate::drift::detection::angles::of_angle;
use crate::units::Turns;

/// Binary logarithm of the number of turns of a window. It is long against a slip, and short against the shift of a warm sensor.
const WINDOW_SHIFT: u32 = 6;

/// Turns of a window.
pub(in crate::drift) const WINDOW_TURNS: u8 = 1 << WINDOW_SHIFT;

/// Steps in a row that are a steady drift.
pub(in crate::drift) const STEPS: u8 = 4;

/// Steady drift, per axis. All distances are angles.
#[derive(Clone, Debug, Default)]
pub(in crate::drift) struct SteadyDrift {
    /// Turns of this window, and the sum of their errors, each divided by the number of turns of a whole window.
    turns: u8,
    sum: i32,
    /// Mean of the window that made the last step; none before the first window.
    last: Option<i32>,
    /// Mean before the first step of the row.
    origin: i32,
    /// Steps in a row; negative backward.
    row: i8,
    is_new: bool,
}

impl SteadyDrift {
    /// Adds the phase error of a turn, as an angle. A mean makes a step if it is further than `step` from the last.
    pub(in crate::drift) fn add(&mut self, error: i32, step: u32) {
        self.sum = self.sum.wrapping_add(error >> WINDOW_SHIFT);
        self.turns += 1;
        if self.turns < WINDOW_TURNS {
            return;
        }
        let mean = core::mem::take(&mut self.sum);
        self.turns = 0;
        let last = *self.last.get_or_insert(mean);
        let by = mean.wrapping_sub(last);
        if by.unsigned_abs() <= step {
            return;
        }
        let sense = if by < 0 { -1 } else { 1 };
        if self.row.signum() != sense {
            self.row = 0;
            self.origin = last;
        }
        self.row = self.row.saturating_add(sense);
        self.last = Some(mean);
        self.is_new |= self.row.unsigned_abs().is_multiple_of(STEPS);
    }

    /// Moves the zero of all errors, so that each falls by `by`, an angle.
    pub(in crate::drift) fn shift(&mut self, by: i32) {
        let part = (by >> WINDOW_SHIFT).wrapping_mul(i32::from(self.turns));
        self.sum = self.sum.wrapping_sub(part);
        self.last = self.last.map(|last| last.wrapping_sub(by));
        self.origin = self.origin.wrapping_sub(by);
    }

    /// Takes the way that the error has walked in one direction, if it is to be reported: after [`STEPS`] steps, and after as many more.
    pub(in crate::drift) fn take_new(&mut self) -> Option<Turns> {
        if !core::mem::take(&mut self.is_new) {
            return None;
        }
        Some(of_angle(self.last?.wrapping_sub(self.origin)))
    }
}
