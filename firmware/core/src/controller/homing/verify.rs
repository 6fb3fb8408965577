//! Checks whether cranks that were moved followed their commands, in homing and in run.

use super::checks::When;
use super::{Homing, Step};
use crate::axes::PhaseOffsets;
use crate::drift::DriftMonitor;
use crate::supervisor::{Fault, FaultKind};
use crate::units::{Turns, nearest};

/// Checks after which a crank that deviates in each is believed to.
const CHECKS: u8 = 3;
/// Corrections after which it is believed in run: by the third, what a swap does may pass for a crank that runs away.
const CONFIRMED: u8 = 2;
/// One of the looks, 16 fraction bits.
const CHECK_SHARE: i64 = 65_536 / CHECKS as i64;

/// Result of a check of cranks that were moved.
pub(super) enum Verdict {
    /// All cranks followed their commands.
    Followed,
    /// One deviates so far: it is to be checked again.
    Unsure,
    /// One deviated in every check. `is_mutual`: another shows its move, and it shows the other's.
    Deviates { fault: Fault, is_mutual: bool },
}

impl Homing {
    /// Fault of swapped wiring, if that is why cranks that were moved seem to exceed the homing range.
    #[inline(never)]
    pub(in crate::controller) fn explain(
        &self,
        monitor: &DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Option<Fault> {
        if !matches!(self.step, Step::Level | Step::Verify) {
            return None;
        }
        // While they are on their way, each may show part of the other's command.
        let deviation = self.in_transit(monitor.watched(), monitor, offsets)?;
        let fault = Fault::new(FaultKind::SwappedWiring).on_axis(deviation.axis);
        deviation
            .is_swapped
            .then_some(fault.with_size(deviation.off))
    }

    /// A crank was detected elsewhere than in the turn before, by so much: that is reported at once, unless it is no further than a rotor
    /// swings, or another was commanded to go there, so that the checks have to decide.
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
        if self.step != Step::Find && self.in_transit(1 << axis, monitor, offsets)?.is_swapped {
            return None;
        }
        let kind = monitor.name_of(axis, by);
        Some(Fault::new(kind).on_axis(axis).with_size(by))
    }

    /// The cranks are about to be corrected once more, in run: checks whether they followed their commands the last time. One that shows
    /// in two corrections, one after the other, the command of another has its lines swapped with that one's, and the more is
    /// corrected the further they go.
    #[inline(never)]
    pub(in crate::controller) fn corrected(
        &mut self,
        monitor: &DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Option<Fault> {
        let phase_error = monitor.errors_at_flags();
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

    /// The cranks have been moved, and each detected once more.
    #[inline(never)]
    pub(super) fn checked(
        &mut self,
        monitor: &mut DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Verdict {
        let mut phase_error = monitor.turn_errors();
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
