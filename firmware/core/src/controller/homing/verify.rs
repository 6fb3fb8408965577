//! Checks whether cranks that were moved followed their commands, in homing and in run.

use super::checks::When;
use super::{Homing, Step};
use crate::monitor::{DriftMonitor, ErrorFilter};
use crate::phase_offset::PhaseOffsets;
use crate::supervisor::{Fault, FaultKind};
use crate::units::{Turns, nearest};

/// Number of checks. A deviation is confirmed only if it shows in every one.
const CHECKS: u8 = 3;
/// Corrections in a row that confirm a swap in run. At the third, the effect of a swap can be mistaken for a crank that runs away.
const CONFIRMED: u8 = 2;
/// Weight of one check in their mean, 16 fraction bits.
const CHECK_SHARE: i64 = 65_536 / CHECKS as i64;

/// Result of a check of cranks that were moved.
pub(super) enum Verdict {
    /// All cranks followed their commands.
    Followed,
    /// A crank deviates, but not yet in enough checks: it must be checked again.
    Unsure,
    /// A crank deviated in every check. `is_mutual` is true if another crank shows its move, and it shows the move of the other.
    Deviates { fault: Fault, is_mutual: bool },
}

impl Homing {
    /// Returns the fault that explains why cranks exceed the homing range, if it is known: one of them has just moved, or those that were
    /// moved have swapped wiring.
    #[inline(never)]
    pub(in crate::controller) fn explain(
        &self,
        monitor: &mut DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Option<Fault> {
        if let Some((axis, by)) = monitor.take_moved()
            && let Some(fault) = self.moved(axis, by, monitor, offsets)
        {
            return Some(fault);
        }
        if !matches!(self.step, Step::Level | Step::Verify) {
            return None;
        }
        // While the cranks move, each may show a part of the command of the other.
        let deviation = self.in_transit(monitor.watched(), monitor, offsets)?;
        let fault = Fault::new(FaultKind::SwappedWiring).on_axis(deviation.axis);
        deviation
            .is_swapped
            .then_some(fault.with_size(deviation.off))
    }

    /// Returns a fault at once if a crank is detected elsewhere than in the turn before, by `by`. There is none if the crank moved no
    /// farther than a rotor swings. In the search there is none as long as the cranks are within the limits of the platform: the next turn
    /// has to confirm the new place. After the search there is also none for a crank within its tolerance, or for one that follows the
    /// command of another: the later checks decide on it.
    #[inline(never)]
    pub(super) fn moved(
        &self,
        axis: usize,
        by: Turns,
        monitor: &DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Option<Fault> {
        if by.abs() <= monitor.swing(axis) {
            return None;
        }
        if self.step == Step::Find {
            monitor.left_beyond_limits(offsets.now())?;
        } else if self.in_transit(1 << axis, monitor, offsets)?.is_swapped {
            return None;
        }
        let kind = monitor.name_of(axis, by);
        Some(Fault::new(kind).on_axis(axis).with_size(by))
    }

    /// Checks, before the next correction in run, whether the cranks followed the last one. Two axes have swapped lines if each shows the
    /// command of the other in two corrections in a row. Each further correction would move them farther apart.
    #[inline(never)]
    pub(in crate::controller) fn corrected(
        &mut self,
        monitor: &DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Option<Fault> {
        let phase_error = monitor.errors(ErrorFilter::AtIndex);
        let swapped = self
            .moves(When::Corrected, &phase_error, offsets.now())
            .deviation(monitor.watched())
            .filter(|deviation| deviation.is_mutual);
        self.before = phase_error;
        self.from = *offsets.now();
        let Some(swapped) = swapped else {
            self.checks = 0;
            return None;
        };
        self.checks += 1;
        let fault = Fault::new(FaultKind::SwappedWiring).on_axis(swapped.axis);
        (self.checks >= CONFIRMED).then_some(fault.with_size(swapped.off))
    }

    /// Checks cranks that were moved, after each was detected once more.
    #[inline(never)]
    pub(super) fn checked(
        &mut self,
        monitor: &mut DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Verdict {
        let mut phase_error = self.turn.errors(monitor);
        self.checks += 1;
        for (sum, (now, &before)) in self
            .off
            .iter_mut()
            .zip(phase_error.iter().zip(&self.before))
        {
            *sum = sum.wrapping_add(nearest(now.wrapping_sub(before)));
        }
        let moves = self.moves(When::Moved, &phase_error, offsets.now());
        if moves.deviation(monitor.watched()).is_none() {
            return Verdict::Followed;
        }
        if self.checks < CHECKS {
            return Verdict::Unsure;
        }
        for (mean, (off, &before)) in phase_error
            .iter_mut()
            .zip(self.off.iter().zip(&self.before))
        {
            let off = Turns::from_bits((off.to_bits() >> 16) * CHECK_SHARE);
            *mean = before.wrapping_add(off);
        }
        let moves = self.moves(When::Moved, &phase_error, offsets.now());
        let Some(deviation) = moves.deviation(monitor.watched()) else {
            return Verdict::Followed;
        };
        let kind = if deviation.is_swapped {
            FaultKind::SwappedWiring
        } else {
            monitor.name_of(deviation.axis, deviation.off)
        };
        let fault = Fault::new(kind).on_axis(deviation.axis);
        Verdict::Deviates {
            fault: fault.with_size(deviation.off),
            is_mutual: deviation.is_mutual,
        }
    }
}
