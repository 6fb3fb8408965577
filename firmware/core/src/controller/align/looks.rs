//! What cranks did when they were moved, next to what they were told: which of them strays, and whether it does what another was told.

use crate::controller::wiring_proof::APART;
use crate::drift::AxisSet;
use crate::units::{Turns, nearest};

/// When cranks are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum When {
    /// While they move: one may be anywhere between.
    OnTheWay,
    /// In align, when all have been heard since.
    Moved,
    /// In run, before the next correction. A swap makes each half as large again as the one before: it must be seen before it looks like
    /// something else, so that less is allowed; and it shows in both cranks, where one that slips is alone.
    Corrected,
}

/// Cranks that were moved, or are on their way: a place for each in every slice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moves<'a> {
    pub when: When,
    /// Drifts before, and now.
    pub before: &'a [Turns],
    pub drift: &'a [Turns],
    /// Trims before, and those that they were told.
    pub from: &'a [Turns],
    pub to: &'a [Turns],
    /// What a reading may be off by.
    pub tolerance: &'a [Turns],
    /// How many axes there are.
    pub count: usize,
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
    #[inline(never)]
    pub(super) fn stray(&self, set: AxisSet) -> Option<Stray> {
        let mut worst: Option<Stray> = None;
        for axis in 0..self.count {
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
        worst.is_swapped = (0..self.count).any(|other| self.follows(&worst, other));
        Some(worst)
    }

    /// Whether a crank is as far off as another was moved further.
    fn follows(&self, stray: &Stray, other: usize) -> bool {
        let moved = |axis| difference(self.to, self.from, axis);
        let between = moved(other).wrapping_sub(moved(stray.axis));
        let allowed = self.allowed(stray.axis);
        if other == stray.axis || between.abs() <= allowed {
            return false;
        }
        let is_by = |off: Turns, by: Turns| nearest(by.wrapping_sub(off)).abs() <= allowed;
        let is_there = is_by(stray.off, between);
        match self.when {
            When::OnTheWay => {
                let rest = nearest(between.wrapping_sub(stray.off));
                let same_sense = |turns: Turns| (turns < 0) == (between < 0);
                is_there || same_sense(stray.off) && same_sense(rest)
            }
            When::Moved => is_there,
            When::Corrected => {
                let back = nearest(difference(self.drift, self.before, other));
                is_there && back.abs() > allowed && is_by(back, between.wrapping_neg())
            }
        }
    }

    fn allowed(&self, axis: usize) -> Turns {
        let tolerance = self.tolerance.get(axis).copied().unwrap_or_default();
        match self.when {
            When::Corrected => tolerance,
            // Half way to what a swap would make of a tilt.
            When::OnTheWay | When::Moved => Turns::from_bits(tolerance.to_bits() * APART / 2),
        }
    }
}

fn difference(now: &[Turns], before: &[Turns], axis: usize) -> Turns {
    let at = |turns: &[Turns]| turns.get(axis).copied().unwrap_or_default();
    at(now).wrapping_sub(at(before))
}
