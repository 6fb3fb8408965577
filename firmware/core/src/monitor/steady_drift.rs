//! Steady drift: a phase error that walks in one direction, turn after turn.
//!
//! A sensor that shifts on its bracket and a crank that shifts on its shaft look the same to the monitor. A correction follows either, so
//! that no limit is reached for a long time. The mean of the phase error over [`WINDOW_TURNS`] turns shows it early. It makes a *step* where
//! it is further than half a tolerance from the mean at the last step. [`STEPS`] steps in a row in one direction are a steady drift. Together
//! they exceed two tolerances, which is the largest difference of two readings of a crank that has not moved.
//!
//! A jump is no drift: it has a name of its own, and the caller subtracts it. A jump that is too small for a name makes two steps at most,
//! as it lies in one window. An error that comes and goes, with the load or the temperature, ends a row.

use super::angles::{Angle, exceeds, of_angle};
use crate::units::Turns;

/// Binary logarithm of the number of turns of a window. It is long against a slip, and short against the shift of a warm sensor.
const WINDOW_SHIFT: u32 = 6;

/// Turns of a window.
pub(super) const WINDOW_TURNS: u8 = 1 << WINDOW_SHIFT;

/// Steps in a row that are a steady drift.
pub(super) const STEPS: u8 = 4;

/// Steady drift, per axis. All distances are angles.
#[derive(Clone, Debug, Default)]
pub(super) struct SteadyDrift {
    /// Turns of this window, and the sum of their errors, each divided by the number of turns of a whole window.
    turns: u8,
    sum: Angle,
    /// Mean of the window that made the last step; none before the first window.
    last: Option<Angle>,
    /// Mean before the first step of the row.
    origin: Angle,
    /// Steps in a row; negative backward.
    row: i8,
}

impl SteadyDrift {
    /// Adds the phase error of a turn. A mean makes a step if it is further than `step` from the last. Returns true if the walk in one
    /// direction is to be reported: after [`STEPS`] steps, and after as many more.
    pub(super) fn add(&mut self, error: Angle, step: Turns) -> bool {
        self.sum += error >> WINDOW_SHIFT;
        self.turns += 1;
        if self.turns < WINDOW_TURNS {
            return false;
        }
        let mean = core::mem::take(&mut self.sum);
        self.turns = 0;
        let last = *self.last.get_or_insert(mean);
        let by = mean - last;
        if !exceeds(by, step) {
            return false;
        }
        let sense = if by < Angle::ZERO { -1 } else { 1 };
        if self.row.signum() != sense {
            self.row = 0;
            self.origin = last;
        }
        self.row = self.row.saturating_add(sense);
        self.last = Some(mean);
        self.row.unsigned_abs().is_multiple_of(STEPS)
    }

    /// Moves the zero of all errors, so that each falls by `by`.
    pub(super) fn shift(&mut self, by: Angle) {
        self.sum -= (by >> WINDOW_SHIFT) * i32::from(self.turns);
        self.last = self.last.map(|last| last - by);
        self.origin -= by;
    }

    /// Distance that the error has walked in one direction.
    pub(super) fn distance(&self) -> Turns {
        self.last
            .map_or(Turns::ZERO, |last| of_angle(last - self.origin))
    }
}
