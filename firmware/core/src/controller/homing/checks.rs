//! Comparison of what cranks did when they were moved with their commands: which of them deviates, and whether it follows the
//! command of another.

use crate::controller::wiring_proof::APART;
use crate::drift::AxisSet;
use crate::units::{Turns, nearest};

/// When cranks are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum When {
    /// While they move: one may be anywhere between.
    InTransit,
    /// In homing, when all have been detected since.
    Moved,
    /// In run, before the next offsets. A swap makes each half as large again as the one before: it must be detected before it looks like
    /// something else, so that less is allowed; and it shows in both cranks, where one that slips is alone.
    Corrected,
}

/// Cranks that were moved, or are on their way: a place for each in every slice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moves<'a> {
    pub when: When,
    /// Phase errors before, and now.
    pub before: &'a [Turns],
    pub phase_error: &'a [Turns],
    /// Trims before, and those that were commanded.
    pub from: &'a [Turns],
    pub to: &'a [Turns],
    /// What a reading may be off by.
    pub tolerance: &'a [Turns],
    /// How many axes there are.
    pub count: usize,
}

/// A crank that did not follow its command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviation {
    pub axis: usize,
    /// By how much it is off.
    pub off: Turns,
    /// It follows the command of another.
    pub is_swapped: bool,
    /// The other follows this one's command, too.
    pub is_mutual: bool,
}

impl Moves<'_> {
    /// Of a set of axes, the one that deviates most.
    #[inline(never)]
    pub(super) fn deviation(&self, set: AxisSet) -> Option<Deviation> {
        let mut worst: Option<Deviation> = None;
        for axis in 0..self.count {
            let off = nearest(difference(self.phase_error, self.before, axis));
            let most = worst.map_or(self.allowed(axis), |worst| worst.off.abs());
            if set & 1 << axis != 0 && off.abs() > most {
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

    /// Move of another, less this one's.
    fn between(&self, axis: usize, other: usize) -> Turns {
        let moved = |axis| difference(self.to, self.from, axis);
        moved(other).wrapping_sub(moved(axis))
    }

    /// True if another is off the other way, by the difference of their moves.
    fn mirrors(&self, deviation: &Deviation, other: usize) -> bool {
        let between = self.between(deviation.axis, other);
        let back = nearest(difference(self.phase_error, self.before, other));
        let allowed = self.allowed(deviation.axis);
        back.abs() > allowed && nearest(between.wrapping_add(back)).abs() <= allowed
    }

    /// Whether a crank is as far off as another was moved further.
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
            // Half way to what a swap would make of a tilt.
            When::InTransit | When::Moved => Turns::from_bits(tolerance.to_bits() * APART / 2),
        }
    }
}

fn difference(now: &[Turns], before: &[Turns], axis: usize) -> Turns {
    let at = |turns: &[Turns]| turns.get(axis).copied().unwrap_or_default();
    at(now).wrapping_sub(at(before))
}
