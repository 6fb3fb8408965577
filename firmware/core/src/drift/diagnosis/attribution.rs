//! Attribution of a fault: its axis, and the name under which it is reported.

use crate::drift::axis_watch::Report;
use crate::drift::detection::angles::in_common;
use crate::drift::{DriftMonitor, Sensed};
use crate::supervisor::{Fault, FaultKind};
use crate::units::{MAX_AXES, PerAxis, Turns, nearest};

impl DriftMonitor {
    /// Reports a fault of one axis.
    #[inline(never)]
    pub(in crate::drift) fn report(
        &mut self,
        axis: usize,
        (kind, by, within_limits): Report,
        sensed: &Sensed<'_>,
    ) {
        // One axis alone cannot be compared with others.
        let may_be_all = kind == FaultKind::IndexTimeout && self.watched().count_ones() > 1;
        let all_lag = may_be_all && self.all_lag_by(self.lag(axis, sensed), sensed);
        let fault = Fault::new(kind).on_axis(axis).with_size(by);
        self.findings.push(fault, within_limits, all_lag);
    }

    /// Reports that a limit is exceeded, with the axis, and the name of the cause if it is known.
    #[inline(never)]
    pub(in crate::drift) fn attribute(
        &mut self,
        kind: FaultKind,
        error: &PerAxis<Turns>,
        sensed: &Sensed<'_>,
    ) {
        if kind == FaultKind::CommonLag {
            let size = self.limits.beyond_natural(&self.modes, sensed.speed);
            let all_lag = self.all_lag_by(size.wrapping_neg(), sensed);
            let fault = Fault::new(kind).with_size(size);
            return self.findings.push(fault, false, all_lag);
        }
        let kind = if self.is_homing {
            FaultKind::HomingRangeExceeded
        } else {
            kind
        };
        // The cranks differ. A crank with a recorded event is the one that moved, even if another one is further from the rest.
        let worst = self.furthest(error);
        let known = (worst..self.axes.len())
            .chain(0..worst)
            .find_map(|axis| Some((axis, self.axes.get(axis)?.name()?)));
        let (axis, kind) = known.unwrap_or((worst, kind));
        let size = self.phase_error.get(axis).copied().unwrap_or_default();
        self.report(axis, (kind, size, false), sensed);
    }

    /// Lag of an axis beyond the lag that belongs to the speed, turns: its phase error, and the delay of its next pulse.
    #[inline(never)]
    fn lag(&self, axis: usize, sensed: &Sensed<'_>) -> Turns {
        let value = |of: &PerAxis<Turns>| of.get(axis).copied().unwrap_or_default();
        let late = match self.axes.get(axis) {
            // If a pulse waits in the queue, the delay is not known yet.
            Some(watch) if self.by_index & !self.queue.pulsed & 1 << axis != 0 => {
                watch.index.lateness(&sensed.over(axis))
            }
            _ => Turns::ZERO,
        };
        let ahead = nearest(value(&self.phase_error).wrapping_add(value(sensed.correction)))
            .wrapping_add(self.limits.natural(sensed.speed));
        late.wrapping_sub(ahead)
    }

    /// Returns true if every watched axis lags by at least three quarters of `lag`. Cranks that lag for a common reason lag about alike,
    /// although flags at different places show it at different times. A crank that failed lags alone.
    #[inline(never)]
    fn all_lag_by(&self, lag: Turns, sensed: &Sensed<'_>) -> bool {
        let least = lag.wrapping_sub(lag / 4);
        let watched = self.watched();
        let mut axes = 0..self.axes.len();
        lag > 0 && axes.all(|axis| watched & 1 << axis == 0 || self.lag(axis, sensed) >= least)
    }

    /// Reports axes whose encoder shows that they do not turn as commanded. This works in homing too, and if all of them lag alike. If the
    /// motor follows, and the others lag alike, the fault is a common lag.
    #[inline(never)]
    pub(in crate::drift) fn check_encoders(&mut self) {
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let Some(watch) = self.axes.get(axis).filter(|watch| watch.is_off_track()) else {
                continue;
            };
            let mut error = [Turns::ZERO; MAX_AXES];
            for (error, watch) in error.iter_mut().zip(&self.axes) {
                *error = watch.tracking_error().unwrap_or_default();
            }
            let by = error.get(axis).copied().unwrap_or_default();
            let others = self.encoders() & !(1 << axis);
            let from_others = by.wrapping_sub(in_common(&error, others));
            let is_alike = others != 0 && from_others.wrapping_abs() <= watch.traits.alone;
            let fault = match watch.tracking() {
                Some(kind) => Fault::new(kind).on_axis(axis),
                None if is_alike => Fault::new(FaultKind::CommonLag),
                None => Fault::new(FaultKind::Tilt).on_axis(axis),
            };
            self.findings.push(fault.with_size(by), false, false);
        }
    }
}
