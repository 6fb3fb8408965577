//! Evaluation of updates: of one axis, of all axes of a round, and against the limits.

use super::angles::{Angles, angle, in_common, middle, of_angle};
use super::modes::AxisSet;
use crate::drift::axis_watch::{AxisWatch, Measured, Motion};
use crate::drift::sensing::encoder_watch::Read;
use crate::drift::sensing::index_watch::Detection;
use crate::drift::{DriftMonitor, Sensed};
use crate::supervisor::FaultKind;
use crate::units::{MAX_AXES, PerAxis, Turns, nearest};

impl DriftMonitor {
    /// Processes the detections of one axis in a tick. If all axes are late together, a pulse may be late by `patience`.
    #[inline(never)]
    pub(in crate::drift) fn take_in(
        &mut self,
        axis: usize,
        detection: Detection,
        read: Read,
        patience: Option<Turns>,
        sensed: &Sensed<'_>,
    ) {
        let Some(watch) = self.axes.get_mut(axis) else {
            return;
        };
        let sorted = watch.sort(detection, read, patience, self.is_homing);
        let own = 1 << axis;
        if sorted.is_detected {
            self.queue.updated |= own;
            self.detected |= own;
            self.unchecked &= !own;
        }
        // During homing, the steps of homing evaluate the motion of the cranks.
        if let Some(by) = sorted.has_moved
            && self.is_homing
        {
            if self.findings.has_requested_stop() && watch.is_by_index() {
                // The first pulse after a time without pulses shows how far the crank moved.
                let kind = watch.jump(by);
                self.report(axis, (kind, by, false), sensed);
            } else {
                self.moved = Some((axis, by));
            }
        }
        self.update(axis);
        if let Some(reported) = sorted.reported {
            self.report(axis, reported, sensed);
        }
    }

    /// Evaluates the updates of a batch: computes the modes, and compares them with the limits. At the end of a round, this happens in the
    /// next tick. While another axis is late, only its pulse or its timeout shows where the cranks are.
    #[inline(never)]
    pub(in crate::drift) fn evaluate(&mut self, sensed: &Sensed<'_>) {
        let updated = core::mem::take(&mut self.queue.updated);
        if self.is_homing {
            self.check_encoders();
        }
        if !self.is_homed() {
            return;
        }
        let errors = self.errors_to_first(sensed.correction, self.is_homing);
        self.modes = self.mount.modes(&errors);
        self.changed = true;
        if self.is_homing || self.encoders() != 0 {
            self.check(Turns::ZERO, sensed);
        } else if !self.is_round_over() && self.others_are_detected(updated) {
            // A pulse that comes during the stop names the fault, though it may show no limit exceeded: a crank that runs away is a whole turn
            // ahead for a moment.
            if self.findings.has_requested_stop() && self.moves_apart() {
                self.compare();
            }
            // The others were measured up to a turn ago. Since then they have made the common motion.
            let since = self.common_jump.wrapping_abs();
            let is_even = since <= self.limits.reading;
            self.check(if is_even { Turns::ZERO } else { since }, sensed);
        }
    }

    /// True if all axes by index have been detected since the last round.
    pub(in crate::drift) const fn is_round_over(&self) -> bool {
        self.detected != 0 && self.detected & self.by_index == self.by_index
    }

    /// Ends a round: compares the axes with each other, and the modes with their limits.
    #[inline(never)]
    pub(in crate::drift) fn conclude_round(&mut self, sensed: &Sensed<'_>) {
        self.detected = 0;
        self.rounds = self.rounds.wrapping_add(1);
        if !self.is_homing {
            self.common_jump = self.compare();
            self.check(Turns::ZERO, sensed);
        }
    }

    /// True if no axis is late except those in `updated`.
    fn others_are_detected(&self, updated: AxisSet) -> bool {
        let others = self.by_index & !updated;
        let mut axes = self.axes.iter().enumerate();
        axes.all(|(axis, watch)| others & 1 << axis == 0 || !watch.index.is_late())
    }

    /// Compares the axes without an encoder, and records those that moved differently from the others. Returns the common motion.
    fn compare(&mut self) -> Turns {
        let motion = self.common_motion();
        for watch in self.axes.iter_mut().filter(|watch| watch.is_by_index()) {
            watch.compare(motion);
        }
        of_angle(motion.jump)
    }

    /// Motion that the axes without an encoder have in common.
    #[inline(never)]
    fn common_motion(&self) -> Motion {
        let (mut jumps, mut walks) = (Angles::new(), Angles::new());
        for watch in self.axes.iter().filter(|watch| watch.is_by_index()) {
            let Motion { jump, walk } = watch.motion();
            let _ = (jumps.push(jump), walks.push(walk)); // There is room.
        }
        Motion {
            jump: middle(&mut jumps),
            walk: middle(&mut walks),
        }
    }

    /// The watched axis that is furthest from the phase error that all have in common.
    #[inline(never)]
    pub fn furthest(&self, error: &PerAxis<Turns>) -> usize {
        let watched = self.watched();
        let common = in_common(error, watched);
        let axes = error.iter().enumerate();
        axes.filter(|(axis, _)| watched & 1 << axis != 0)
            .max_by_key(|(_, error)| angle(error.wrapping_sub(common)).unsigned_abs())
            .map_or(0, |(axis, _)| axis)
    }

    /// Axis that is furthest from all others, and its distance, if the cranks exceed a limit of the platform as they stand.
    pub fn left_beyond_limits(&self, correction: &PerAxis<Turns>) -> Option<(usize, Turns)> {
        let errors = self.errors_to_first(correction, true);
        if self.allows(&errors) {
            return None;
        }
        let axis = self.furthest(&errors);
        // This is the common error of the others. The mean of all would contain the error of this axis itself.
        let others = self.watched() & !(1 << axis);
        let others = in_common(&errors, others);
        Some((axis, nearest(errors.get(axis)?.wrapping_sub(others))))
    }

    /// Phase errors with their corrections. In homing the common zero is not known, and phase errors may lie around half a turn. Then
    /// only their `differences` to the first axis are used. Cranks may stand near a limit for many ticks then, so that the noise of an
    /// encoder has to be filtered.
    #[inline(never)]
    fn errors_to_first(&self, correction: &PerAxis<Turns>, differences: bool) -> PerAxis<Turns> {
        let mut error = if differences {
            self.errors(Measured::Lately)
        } else {
            self.phase_error
        };
        let first = self.watched().trailing_zeros() as usize;
        let base = match error.get(first) {
            Some(&first) if differences => first,
            _ => Turns::ZERO,
        };
        for (error, &correction) in error.iter_mut().zip(correction) {
            *error = nearest(error.wrapping_add(correction).wrapping_sub(base));
        }
        error
    }

    /// Compares the modes with the limits, and reports events that are new. Those of tilt and warp are wider by `margin`, turns of crank
    /// angle.
    #[inline(never)]
    fn check(&mut self, margin: Turns, sensed: &Sensed<'_>) {
        let exceeded = self.exceeded(margin, sensed.speed);
        let is_ones_own = exceeded.is_some_and(|kind| kind != FaultKind::CommonLag);
        if is_ones_own && !self.is_homing {
            self.compare();
        }
        self.report_moves(exceeded.is_none(), sensed);
        if let Some(kind) = exceeded {
            let error = self.errors_to_first(sensed.correction, self.is_homing);
            self.attribute(kind, &error, sensed);
        }
    }

    /// Reports new motions of cranks by name. During homing and levelling, the steps of homing evaluate the motion of the cranks.
    fn report_moves(&mut self, within_limits: bool, sensed: &Sensed<'_>) {
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let Some(watch) = self.axes.get_mut(axis) else {
                return;
            };
            let drift = watch.steady_drift.take_new();
            let fresh = watch.diagnosis.take_new();
            if self.is_homing {
                continue;
            }
            if let Some((kind, by)) = fresh {
                self.report(axis, (kind, by, within_limits), sensed);
            }
            if let Some(by) = drift {
                self.report(axis, (FaultKind::Drift, by, true), sensed);
            }
        }
    }

    /// The limit that the cranks exceed by `margin`, if they do: of the platform, or of the common lag.
    fn exceeded(&self, margin: Turns, speed: Turns) -> Option<FaultKind> {
        // In homing a crank stays where it was left, or was moved to prove its wiring, so the true limit applies. A crank that has moved
        // may move on, and it may be beyond the true limit while its reading is not.
        let has_moved = |watch: &AxisWatch| watch.name().is_some();
        let may_be = self.limits.of_readings().exceeded(&self.modes, margin);
        let exceeded = may_be.and_then(|kind| {
            if !self.is_homing && (self.axes.iter().any(has_moved) || self.moves_apart()) {
                Some(kind)
            } else {
                self.limits.of_cranks.exceeded(&self.modes, margin)
            }
        });
        if exceeded.is_some() || self.is_homing {
            return exceeded;
        }
        self.limits.of_common(&self.modes, speed)
    }

    /// True if a crank by index moved away from the others by more than a gate since the axes were compared.
    fn moves_apart(&self) -> bool {
        let motion = self.common_motion();
        let mut axes = self.axes.iter();
        axes.any(|watch| watch.is_by_index() && watch.moves_from(motion))
    }
}
