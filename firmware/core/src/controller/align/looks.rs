//! What cranks did when they were moved, next to what they were told: which of them strays, and whether it does what another was told.

use crate::drift::AxisSet;
use crate::units::{Turns, nearest};

/// Cranks that were moved, or are on their way: a place for each in every slice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moves<'a> {
    /// Drifts before, and now.
    pub before: &'a [Turns],
    pub drift: &'a [Turns],
    /// Trims before, and those that they were told.
    pub from: &'a [Turns],
    pub to: &'a [Turns],
    /// What a reading may be off by.
    pub tolerance: &'a [Turns],
    /// So many halves of that are allowed.
    pub halves: i64,
    /// On the way there a crank may be anywhere between.
    pub on_the_way: bool,
    /// Two that are swapped must both show it.
    pub both: bool,
}

/// A crank that did not do what it was told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stray {
    pub axis: usize,
    /// By how much it is off.
    pub off: Turns,
    /// It does what another was told.
    pub is_swapped: bool,
}

impl Moves<'_> {
    /// Of a set of axes, the one that strays most.
    #[inline(never)] // one for every number of axes
    pub(super) fn stray(&self, set: AxisSet) -> Option<Stray> {
        let mut worst: Option<Stray> = None;
        for axis in 0..self.drift.len() {
            let off = nearest(difference(self.drift, self.before, axis));
            let most = worst.map_or(self.allowed(axis), |worst| worst.off.abs());
            if set & 1 << axis != 0 && off.abs() > most {
                worst = Some(Stray {
                    axis,
                    off,
                    is_swapped: false,
                });
            }
        }
        let mut worst = worst?;
        worst.is_swapped = (0..self.drift.len()).any(|other| self.follows(&worst, other));
        Some(worst)
    }

    /// Whether a crank is as far off as another was moved further; and perhaps that one the other way.
    fn follows(&self, stray: &Stray, other: usize) -> bool {
        if other == stray.axis {
            return false;
        }
        let moved = |axis| difference(self.to, self.from, axis);
        let between = moved(other).wrapping_sub(moved(stray.axis));
        let allowed = self.allowed(stray.axis);
        if between.abs() <= allowed {
            return false;
        }
        let rest = nearest(between.wrapping_sub(stray.off));
        if self.on_the_way {
            let same_sense = |turns: Turns| (turns < 0) == (between < 0);
            return same_sense(stray.off) && same_sense(rest) || rest.abs() <= allowed;
        }
        if !self.both {
            return rest.abs() <= allowed;
        }
        // A crank that slips while it is corrected is alone in this.
        let back = nearest(difference(self.drift, self.before, other));
        let rest_of_other = nearest(between.wrapping_add(back));
        rest.abs() <= allowed && back.abs() > allowed && rest_of_other.abs() <= allowed
    }

    fn allowed(&self, axis: usize) -> Turns {
        let tolerance = self.tolerance.get(axis).copied().unwrap_or_default();
        Turns::from_bits(tolerance.to_bits() * self.halves / 2)
    }
}

fn difference(now: &[Turns], before: &[Turns], axis: usize) -> Turns {
    let at = |turns: &[Turns]| turns.get(axis).copied().unwrap_or_default();
    at(now).wrapping_sub(at(before))
}
