//! Watch on cranks that the drives hold. If such a crank moves, it does not follow its command, and its drive must go off.
//!
//! The machine holds while it is parked, and after a stop by a fault. All commands are constant, so a sensor shows only the crank's own
//! motion. The drives go off without a diagnosis:
//!
//! - *An encoder* shows the motion in every tick. The watch keeps the smallest phase error since the hold began. An axis has moved away
//!   once its error exceeds that by the phase error with which this crank alone exceeds a limit of the platform. A crank that settles, or
//!   makes up for a lag, comes nearer.
//! - *An index alone* shows the motion as the crank passes its flag, so within one of its own turns. The first pulse counts: waiting for a
//!   second one would let the crank make another turn against the others. The pulse may have been noise. But the machine is stopped, so a
//!   wrong reaction ends a hold, not a run.
//!
//! One more pulse is tolerated where the first one is no evidence:
//!
//! - of a crank that rests at an end of its flag, unless its drive may have run away;
//! - of a parked machine, which has no fault;
//! - of every axis after a common lag, as all cranks then turn until they have made up for it.

use super::Controller;
use crate::monitor::{DriftMonitor, may_run_away};
use crate::signals::Feedback;
use crate::supervisor::{Fault, FaultKind, State};
use crate::units::{MAX_AXES, PerAxis, Turns};

/// Reciprocal of the part of a second after which rotors no longer swing about their places: 1/10 s.
const SWINGS_FOR: u64 = 10;

/// Motion that sensors have shown since a hold began.
#[derive(Clone, Debug)]
pub(super) struct HoldWatch {
    /// Smallest phase error of each encoder, without sign.
    min: PerAxis<Turns>,
    /// Index pulses of each axis without an encoder.
    pulses: PerAxis<u8>,
}

impl HoldWatch {
    /// Watch at the beginning of a hold.
    pub(super) const fn new() -> Self {
        Self {
            min: [Turns::MAX; MAX_AXES],
            pulses: [0; MAX_AXES],
        }
    }

    /// Records the phase error of an encoder. Returns true if the crank has moved away by more than `alone`.
    fn has_moved_away(&mut self, axis: usize, error: Turns, alone: Turns) -> bool {
        let Some(min) = self.min.get_mut(axis) else {
            return false;
        };
        let off = error.wrapping_abs();
        *min = off.min(*min);
        off.saturating_sub(*min) > alone
    }

    /// Counts an index pulse. Returns true if the axis has made over `tolerated` pulses more than the axis of `all` with the fewest.
    fn is_too_many(
        &mut self,
        axis: usize,
        all: impl Iterator<Item = usize>,
        tolerated: u8,
    ) -> bool {
        let Some(own) = self.pulses.get_mut(axis) else {
            return false;
        };
        *own = own.saturating_add(1);
        let own = *own;
        let common = all.filter_map(|axis| self.pulses.get(axis)).min();
        own - common.copied().unwrap_or_default().min(own) > tolerated
    }
}

impl Controller {
    /// Returns a fault that names the axis that moves although its drive holds it, if there is one.
    #[inline(never)]
    pub(super) fn check_hold(&mut self, feedback: &Feedback) -> Option<Fault> {
        (0..self.channels.len()).find_map(|axis| self.check_held(axis, feedback))
    }

    fn check_held(&mut self, axis: usize, feedback: &Feedback) -> Option<Fault> {
        let monitor: &DriftMonitor = &self.monitor;
        let fault = Fault::new(FaultKind::Runaway).on_axis(axis);
        if let Some(error) = monitor.motor_error(axis) {
            let away = self
                .state
                .hold
                .has_moved_away(axis, error, monitor.single_axis_limit(axis));
            let size = monitor.phase_error().get(axis).copied();
            return away.then_some(fault.with_size(size.unwrap_or_default()));
        }
        feedback.index.of(axis)?;
        let is_parked = self.supervisor.state() == State::Parked;
        let latched = self.supervisor.fault();
        // A crank that may have run away is not where its last pulse showed it. With two cranks, no reading shows which one ran away.
        let is_ambiguous = monitor.watched().count_ones() <= 2;
        let may_run = latched.is_some_and(|fault| {
            (fault.axis == Some(axis) || is_ambiguous) && may_run_away(&fault)
        });
        let phase = self.output.telemetry.axis_phase(axis);
        let is_at_flag = !may_run && monitor.is_at_flag(axis, phase);
        let swings = is_parked
            || (self.state.ticks - self.state.driven) * SWINGS_FOR < u64::from(self.tick_hz);
        if is_at_flag && swings {
            return None;
        }
        let latched = latched.map(|fault| fault.kind);
        let may_catch_up = matches!(latched, Some(FaultKind::CommonLag | FaultKind::Capture));
        let tolerated = u8::from(is_parked || is_at_flag || may_catch_up);
        let is_by_index = |axis: &usize| {
            monitor.watched() & 1 << axis != 0 && monitor.motor_error(*axis).is_none()
        };
        // With one axis only, a pulse cannot be one that all axes make.
        let is_one_of_many = (0..self.channels.len()).filter(is_by_index).count() > 1;
        let all = (0..self.channels.len()).filter(|axis| is_one_of_many && is_by_index(axis));
        if !self.state.hold.is_too_many(axis, all, tolerated) {
            return None;
        }
        // The phase of the crank is unknown now.
        self.homing.forget();
        Some(fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn degrees(degrees: i64) -> Turns {
        Turns::from_bits(crate::units::ONE_TURN / 360 * degrees)
    }

    /// If this fails because the smallest error does not count, a crank that was off as the hold began is not watched. If it fails for a
    /// crank that comes nearer, one that settles loses its drive.
    #[test]
    fn moving_away_is_measured_from_the_smallest_error() {
        let mut watch = HoldWatch::new();
        for (error, moved) in [
            (-7, false),
            (-3, false),
            (-8, false),
            (-9, true),
            (3, false),
        ] {
            let away = watch.has_moved_away(2, degrees(error), degrees(5));
            assert_eq!(away, moved, "{error}");
        }
        assert!(!watch.has_moved_away(1, degrees(90), degrees(5)));
        assert!(!watch.has_moved_away(MAX_AXES, degrees(90), degrees(5)));
    }

    /// If this fails because pulses of all axes count, drives that recover from a common lag are disabled. If those pulses excuse one
    /// axis, it can run away.
    #[test]
    fn pulses_common_to_all_axes_are_not_counted() {
        let mut watch = HoldWatch::new();
        assert!(watch.is_too_many(0, 0..3, 0));
        assert!(HoldWatch::new().is_too_many(0, core::iter::empty(), 0));
        let mut watch = HoldWatch::new();
        for axis in [1, 0, 2, 2, 0, 1, 1] {
            assert!(!watch.is_too_many(axis, 0..3, 1), "{axis}");
        }
        assert!(watch.is_too_many(1, 0..3, 1));
    }
}
