//! Evaluation of updates: of one axis, of all axes of a round, and against the limits.

use super::angles::{Angles, in_common, of_angle};
use super::modes::AxisSet;
use crate::drift::axis_watch::AxisWatch;
use crate::drift::queue::Evaluation;
use crate::drift::{DriftMonitor, Sensed};
use crate::supervisor::FaultKind;
use crate::units::{MAX_AXES, PerAxis, Turns, nearest};

impl DriftMonitor {
    /// Evaluates the update of one axis: a pulse, a timeout or an encoder's reading. Returns true if the crank moved so far that the
    /// evaluation does not wait for the others.
    #[inline(never)]
    pub(in crate::drift) fn sort(
        &mut self,
        axis: usize,
        may_be_timeout: bool,
        sensed: &Sensed<'_>,
    ) -> bool {
        let all_late = may_be_timeout && self.axes.iter().all(AxisWatch::is_late);
        let tolerance = self.limits.common;
        let others = self.in_common_but(axis, sensed.correction);
        let Some(watch) = self.axes.get_mut(axis) else {
            return false;
        };
        let sorted = watch.sort(all_late.then_some(tolerance));
        if sorted.is_detected {
            self.detected |= 1 << axis;
            self.known |= 1 << axis;
            self.checked |= 1 << axis;
        }
        // A crank may pass a limit by its own pulse, long before the round is over.
        let correction = sensed.correction.get(axis).copied().unwrap_or_default();
        let own = watch.phase_error().wrapping_add(correction);
        let off = nearest(own.wrapping_sub(others)).abs();
        let has_moved = sorted.has_moved.filter(|_| watch.is_by_index());
        let most = if has_moved.is_some() {
            watch.alone()
        } else {
            watch.far()
        };
        // A late pulse that comes during the stop names the fault before the machine stands.
        let is_waited_for = has_moved.is_some() && self.findings.has_requested_stop();
        let is_far = sorted.is_detected && (off > most || is_waited_for);
        // In homing, the pulse that ends a time without pulses shows by how much the crank moved.
        if let Some(by) = has_moved
            && self.finding_out
            && self.findings.has_requested_stop()
        {
            let kind = watch.jump(by);
            self.find(axis, kind, by, false);
        } else if let Some(by) = sorted.has_moved
            && self.finding_out
        {
            self.moved = Some((axis, by));
        }
        if let Some(reported) = sorted.reported {
            self.report(axis, reported, sensed);
        }
        is_far
    }

    /// Does one step of the evaluation of a batch.
    #[inline(never)]
    pub(in crate::drift) fn evaluate(&mut self, sensed: &Sensed<'_>) {
        let goes_on = match self.queue.evaluation {
            Evaluation::Compare => self.conclude().then_some(Evaluation::Modes),
            Evaluation::Modes => self.update_modes(sensed).then_some(Evaluation::Check),
            Evaluation::Check => {
                self.check(sensed);
                None
            }
        };
        self.queue.evaluation = goes_on.unwrap_or(Evaluation::Compare);
        if goes_on.is_none() {
            self.is_homed = self.are_known();
        }
    }

    /// Compares the axes, if those that were updated end a round or have moved far. Returns true if limits are to be checked.
    fn conclude(&mut self) -> bool {
        let updated = core::mem::take(&mut self.queue.updated);
        let moved = core::mem::take(&mut self.queue.moved);
        let round =
            updated != 0 && self.detected & self.by_index == self.by_index && self.detected != 0;
        if self.finding_out && self.are_known() && updated != 0 && !round {
            // All axes turn at homing speed, so phase errors of a turn ago are comparable.
        } else if moved != 0 && !round && !self.finding_out && self.others_are_detected(moved) {
            // No other axis is late, so none moved with this one, and the round need not end first.
            self.compare();
            self.is_compared = true;
        } else if round {
            self.detected = 0;
            self.rounds = self.rounds.wrapping_add(1);
            if !self.finding_out {
                let others_moved = self.compare().abs();
                let is_whole = !core::mem::take(&mut self.is_compared);
                self.is_even = is_whole && others_moved <= self.limits.reading;
            }
        } else {
            // If the common part did not change in the last round, this crank is comparable with the others of a turn ago.
            return self.encoders() != 0 || self.is_even && self.others_are_detected(updated);
        }
        true
    }

    /// Common error of all axes except one, with their corrections. It is not the mean of all, which would contain the
    /// error of that axis itself.
    pub(in crate::drift) fn in_common_but(
        &self,
        axis: usize,
        correction: &PerAxis<Turns>,
    ) -> Turns {
        in_common(&self.phase_error, correction, self.watched() & !(1 << axis))
    }

    /// True if no axis is late except those in `moved`.
    pub(in crate::drift) fn others_are_detected(&self, moved: AxisSet) -> bool {
        let others = self.by_index & !moved;
        let mut axes = self.axes.iter().enumerate();
        axes.all(|(axis, watch)| others & 1 << axis == 0 || !watch.is_late())
    }

    /// Compares the axes without an encoder, and records those that moved otherwise than the others. Returns the common motion.
    pub(in crate::drift) fn compare(&mut self) -> Turns {
        of_angle(compare(&mut self.axes, self.by_index))
    }

    /// Axis that is furthest from all others, and by how much, if the cranks exceed a limit of the platform as they stand.
    pub fn left_beyond_limits(&self, correction: &PerAxis<Turns>) -> Option<(usize, Turns)> {
        let errors = self.errors_to_first(correction, true);
        if self.allows(&errors) {
            return None;
        }
        let axis = self.furthest(&errors);
        let own = self
            .phase_error
            .get(axis)?
            .wrapping_add(*correction.get(axis)?);
        let others = self.in_common_but(axis, correction);
        Some((axis, nearest(own.wrapping_sub(others))))
    }

    /// Phase errors with their corrections.
    pub(in crate::drift) fn corrected_errors(&self, correction: &PerAxis<Turns>) -> PerAxis<Turns> {
        self.errors_to_first(correction, self.finding_out)
    }

    /// Phase errors with their corrections. In homing the common zero is not known, and phase errors may lie around half a turn. Then
    /// only their `differences` to the first axis are used.
    #[inline(never)]
    fn errors_to_first(&self, correction: &PerAxis<Turns>, differences: bool) -> PerAxis<Turns> {
        let mut error = self.phase_error;
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

    /// Computes the modes of the phase errors. Returns false if not all phase errors are known.
    #[inline(never)]
    pub(in crate::drift) fn update_modes(&mut self, sensed: &Sensed<'_>) -> bool {
        if self.finding_out {
            self.check_encoders();
        }
        if !self.are_known() {
            return false;
        }
        self.modes = self.mount.modes(&self.corrected_errors(sensed.correction));
        self.changed = true;
        true
    }

    /// Compares the modes with the limits, and reports events that are new.
    #[inline(never)]
    pub(in crate::drift) fn check(&mut self, sensed: &Sensed<'_>) {
        let exceeded = self.exceeded(sensed.speed);
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let watch = self.axes.get_mut(axis);
            let fresh = watch.and_then(|watch| watch.diagnosis().take_new());
            // During homing and levelling the homing itself evaluates what the cranks do.
            if let Some((kind, by)) = fresh.filter(|_| !self.finding_out) {
                self.find(axis, kind, by, exceeded.is_none());
            }
        }
        if let Some(kind) = exceeded {
            let error = self.corrected_errors(sensed.correction);
            self.attribute(kind, &error, sensed);
        }
    }

    /// The limit that the cranks exceed, if they do: of the platform, or of the common lag.
    pub(in crate::drift) fn exceeded(&self, speed: Turns) -> Option<FaultKind> {
        // In homing a crank stays where it was left, or was moved to prove its wiring, so the true limit applies. A crank that has moved
        // goes on, and may be beyond the true limit while its reading is not.
        let goes_on = || !self.finding_out && self.axes.iter().any(AxisWatch::has_moved);
        let may_be = self.limits.of_readings(&self.modes);
        let exceeded = may_be.and_then(|kind| {
            if goes_on() {
                Some(kind)
            } else {
                self.limits.of_platform(&self.modes)
            }
        });
        if exceeded.is_some() || self.finding_out {
            return exceeded;
        }
        self.limits.of_common(&self.modes, speed)
    }

    /// Reports axes whose encoder shows that they do not turn as commanded. This works in homing too, and if all of them lag alike.
    pub(in crate::drift) fn check_encoders(&mut self) {
        for axis in 0..self.axes.len().min(MAX_AXES) {
            if self.axes.get(axis).is_some_and(AxisWatch::is_off_track) {
                self.report_off_track(axis);
            }
        }
    }
}

/// Compares the motion of each axis of a set in a round with their common motion, and returns the latter.
#[inline(never)]
fn compare(axes: &mut [AxisWatch], set: AxisSet) -> i32 {
    let (mut jumps, mut walks) = (Angles::default(), Angles::default());
    for (axis, watch) in axes.iter().enumerate() {
        if set & 1 << axis != 0 {
            let (jump, walk) = watch.moved();
            jumps.push(jump);
            walks.push(walk);
        }
    }
    let (jump, walk) = (jumps.common(), walks.common());
    for (axis, watch) in axes.iter_mut().enumerate() {
        if set & 1 << axis != 0 {
            watch.compare(jump, walk);
        }
    }
    jump
}
