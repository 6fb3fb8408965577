//! Comparison of the motion of cranks with their commands: names the crank that deviates, and detects one that follows the command of
//! another.

use crate::controller::wiring_proof::APART;
use crate::units::{AxisSet, Turns, nearest};

/// Time of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum When {
    /// Check while the cranks move. A crank may be anywhere between start and target.
    InTransit,
    /// Check in homing, after every crank has been detected since its move.
    Moved,
    /// Check in run, before the next offsets. With swapped wiring, each deviation is 1.5 times the one before. It must be detected before
    /// it looks like another fault, so a smaller deviation is allowed. A swap shows in both cranks; a slip shows in one only.
    Corrected,
}

/// Cranks that were moved, or that are still moving. Every slice has an element for each of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moves<'a> {
    pub when: When,
    /// Phase errors before the move, and now.
    pub before: &'a [Turns],
    pub phase_error: &'a [Turns],
    /// Trims before the move, and commanded trims.
    pub from: &'a [Turns],
    pub to: &'a [Turns],
    /// Largest error of a reading, for each axis.
    pub tolerance: &'a [Turns],
    /// Number of axes.
    pub count: usize,
}

/// A crank that did not follow its command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviation {
    pub axis: usize,
    /// Deviation from the command.
    pub off: Turns,
    /// True if the crank follows the command of another.
    pub is_swapped: bool,
    /// True if the other also follows the command of this one.
    pub is_mutual: bool,
}

impl Moves<'_> {
    /// Returns the axis of a set that deviates most, if any deviates more than allowed.
    #[inline(never)]
    pub(super) fn deviation(&self, set: AxisSet) -> Option<Deviation> {
        let mut worst: Option<Deviation> = None;
        for axis in 0..self.count {
            let off = nearest(difference(self.phase_error, self.before, axis));
            let max = worst.map_or(self.allowed(axis), |worst| worst.off.abs());
            if set & 1 << axis != 0 && off.abs() > max {
                worst = Some(Deviation {
                    axis,
                    off,
                    is_swapped: false,
                    is_mutual: false,
                });
            }
        }
        let mut worst = worst?;
        for other in 0..self.count {
            if self.follows(&worst, other) {
                worst.is_swapped = true;
                worst.is_mutual |= self.mirrors(&worst, other);
            }
        }
        Some(worst)
    }

    /// Returns the move of another axis, less the move of this one.
    fn between(&self, axis: usize, other: usize) -> Turns {
        let moved = |axis| difference(self.to, self.from, axis);
        moved(other).wrapping_sub(moved(axis))
    }

    /// True if another axis deviates in the opposite sense by the difference of the two moves.
    fn mirrors(&self, deviation: &Deviation, other: usize) -> bool {
        let between = self.between(deviation.axis, other);
        let back = nearest(difference(self.phase_error, self.before, other));
        let allowed = self.allowed(deviation.axis);
        back.abs() > allowed && nearest(between.wrapping_add(back)).abs() <= allowed
    }

    /// True if the deviation of a crank equals the difference of the moves of another crank and this one. In transit, a part of that
    /// difference is enough.
    fn follows(&self, deviation: &Deviation, other: usize) -> bool {
        let between = self.between(deviation.axis, other);
        let allowed = self.allowed(deviation.axis);
        if other == deviation.axis || between.abs() <= allowed {
            return false;
        }
        let rest = nearest(between.wrapping_sub(deviation.off));
        let is_there = rest.abs() <= allowed;
        match self.when {
            When::InTransit => {
                let same_sense = |turns: Turns| (turns < 0) == (between < 0);
                is_there || same_sense(deviation.off) && same_sense(rest)
            }
            When::Moved | When::Corrected => is_there,
        }
    }

    fn allowed(&self, axis: usize) -> Turns {
        let tolerance = self.tolerance.get(axis).copied().unwrap_or_default();
        match self.when {
            When::Corrected => tolerance,
            // Half of the deviation that a swap causes in a tilt.
            When::InTransit | When::Moved => Turns::from_bits(tolerance.to_bits() * APART / 2),
        }
    }
}

fn difference(now: &[Turns], before: &[Turns], axis: usize) -> Turns {
    let at = |turns: &[Turns]| turns.get(axis).copied().unwrap_or_default();
    at(now).wrapping_sub(at(before))
}
