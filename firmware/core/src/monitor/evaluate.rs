//! Evaluation of a tick: the estimates of all axes, their comparison with the limits and with each other, and the report.

use super::angles::{angle, in_common, middle, of_angle};
use super::axis::{Axis, Motion, Report, Shown};
use super::index::MAX_LATE;
use super::{Angle, DriftMonitor, ErrorFilter, Modes, Sensed};
use crate::commanded::{Recent, TickClock, TickPhase};
use crate::supervisor::{Fault, FaultKind};
use crate::units::{AxisSet, MAX_AXES, PerAxis, Phase, Turns};

/// A tick that is over, for all axes.
#[derive(Clone, Debug)]
pub(super) struct Tick<'a> {
    pub sensed: &'a Sensed<'a>,
    recent: Recent<'a>,
    /// True if the tick before it is known.
    before_is_known: bool,
    /// Turns by which homing has moved the flags.
    pub zero: Turns,
    pub clock: TickClock,
}

impl Tick<'_> {
    fn planned(&self, axis: usize) -> Phase {
        let lead = self.sensed.lead.get(axis).copied().unwrap_or_default();
        self.sensed.phase.advanced(lead)
    }

    /// Commanded phase of an axis over the tick.
    pub fn over(&self, axis: usize) -> TickPhase {
        self.recent.over(axis, self.planned(axis))
    }

    /// The same, at its end.
    #[inline(always)]
    pub fn end(&self, axis: usize) -> Phase {
        self.recent.end(axis, self.planned(axis))
    }

    /// Turns of an axis in the tick before, if they are known.
    pub fn before(&self, axis: usize) -> Option<Turns> {
        self.before_is_known.then_some(self.recent.before(axis))
    }
}

impl DriftMonitor {
    /// Reads all sensors, and evaluates what they show.
    #[inline(never)]
    pub(super) fn sense(&mut self, sensed: &Sensed<'_>) {
        let tick = Tick {
            sensed,
            recent: sensed.history.recent(),
            before_is_known: self.before_is_known,
            zero: self.zero,
            clock: self.config.clock,
        };
        let mut shown = Shown {
            is_homing: self.is_homing,
            ..Shown::default()
        };
        self.margin = Turns::MAX;
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let Some(state) = self.axes.get_mut(axis) else {
                break;
            };
            shown.axis = axis;
            if self.config.by_index & 1 << axis != 0 {
                let late = state.observe(&tick, &mut shown);
                self.margin = self.margin.min(state.config.tolerance.wrapping_sub(late));
                if late > 0 {
                    let over = tick.over(axis);
                    state.wait(over.start, over.turns, None, &mut shown);
                }
            } else {
                state.observe_encoder(&tick, &mut shown);
            }
            if shown.has_moved.is_some() || shown.reported.is_some() {
                self.report_of_axis(&mut shown, sensed);
            }
        }
        let read = shown.updated | self.encoders();
        if read != 0 {
            self.detected |= shown.updated;
            self.shown = shown.updated;
            self.update(read);
        }
        self.evaluate(&mut shown, sensed);
    }

    /// Updates the phase errors of the axes that were read.
    fn update(&mut self, read: AxisSet) {
        let slots = self.phase_error.iter_mut().zip(&mut self.peak);
        for (axis, (state, (error, peak))) in self.axes.iter().zip(slots).enumerate() {
            if read & 1 << axis != 0 {
                *error = state.error(ErrorFilter::None);
                *peak = error.wrapping_abs().max(*peak);
            }
        }
        self.changed = true;
    }

    /// Takes in what an axis has to report.
    #[inline(never)] // seldom
    fn report_of_axis(&mut self, shown: &mut Shown, sensed: &Sensed<'_>) {
        let axis = shown.axis;
        // During homing, the steps of homing evaluate the motion of the cranks.
        if let Some(by) = shown.has_moved.take()
            && self.is_homing
        {
            if let Some(state) = self.axes.get_mut(axis)
                && self.findings.has_requested_stop()
                && state.encoder.is_none()
            {
                // The first pulse after a time without pulses shows how far the crank moved.
                state.jump(by);
                let kind = state.name().unwrap_or(FaultKind::Slip);
                self.report(axis, (kind, of_angle(by), false), shown, sensed);
            } else if self
                .moved
                .is_none_or(|(_, max)| of_angle(by).abs() > max.abs())
            {
                self.moved = Some((axis, of_angle(by)));
            }
        }
        if let Some(reported) = shown.reported.take() {
            self.report(axis, reported, shown, sensed);
        }
    }

    /// Evaluates a tick: compares the cranks with each other at the end of a round, and the modes of their estimates with the limits.
    fn evaluate(&mut self, shown: &mut Shown, sensed: &Sensed<'_>) {
        if self.is_homing {
            self.check_encoders();
        }
        let stops = self.findings.has_requested_stop();
        let is_late = shown.late != 0;
        if shown.updated == 0 && (!is_late || stops) && self.encoders() == 0 {
            return;
        }
        let by_index = self.config.by_index;
        let is_round_over = self.detected != 0 && self.detected & by_index == by_index;
        if is_round_over {
            self.detected = 0;
            self.rounds = self.rounds.wrapping_add(1);
        }
        // A pulse that comes during the stop names the fault, though it may show no limit exceeded: a crank that runs away is a whole turn
        // ahead for a moment.
        let is_compared = self.is_homing || is_round_over || stops && self.moves_apart();
        if is_compared && !self.is_homing {
            let jump = self.compare(shown);
            if is_round_over {
                self.common_jump = jump;
            }
        }
        let mut errors = self.measured(sensed.correction);
        if shown.updated != 0 || self.encoders() != 0 {
            self.modes = self.config.mount.modes(&errors);
            self.changed = true;
        }
        let mut modes = self.modes;
        if is_late {
            self.fall(&mut errors, shown);
            modes = self.config.mount.modes(&errors);
        }
        // Within a round, the others were measured up to a turn ago. Since then they have made the common motion.
        let since = of_angle(self.common_jump).wrapping_abs();
        let is_even = self.is_homing || is_round_over || since <= self.config.limits.reading;
        let margin = if is_even { Turns::ZERO } else { since };
        let exceeded = self.exceeded(&modes, margin, is_compared, shown, sensed.speed);
        let is_ones_own = exceeded.is_some_and(|kind| kind != FaultKind::CommonLag);
        if is_ones_own && !is_compared && shown.updated != 0 {
            self.compare(shown);
        }
        if shown.moved | shown.drifting != 0 {
            self.report_moves(exceeded.is_none(), shown, sensed);
        }
        if let Some(kind) = exceeded {
            self.attribute(kind, &errors, shown, sensed);
        }
    }

    /// Measured phase errors with their corrections. In homing the common zero is not known, and phase errors may lie around half a turn.
    /// Then they count from the first axis. Cranks may stand near a limit for many ticks then, so that the noise of an encoder has to be
    /// filtered. Until all places are known, none count.
    #[inline(never)]
    fn measured(&self, correction: &PerAxis<Turns>) -> PerAxis<Angle> {
        let mut errors = [Angle::ZERO; MAX_AXES];
        if self.is_homing {
            return if self.is_homed() {
                self.left(correction)
            } else {
                errors
            };
        }
        let measured = self.phase_error.iter().zip(correction);
        for (sum, (&error, &correction)) in errors.iter_mut().zip(measured) {
            *sum = angle(error) + angle(correction);
        }
        errors
    }

    /// Turns errors into estimates: a crank whose pulse is late is as far behind its last place. A stepper is behind by an electrical cycle
    /// at least, except as it accelerates in homing.
    fn fall(&self, errors: &mut PerAxis<Angle>, shown: &Shown) {
        let axes = self.axes.iter().zip(&shown.late_by);
        for (error, (axis, &late)) in errors.iter_mut().zip(axes) {
            if late != 0 {
                let min = if self.is_homing {
                    Turns::ZERO
                } else {
                    axis.config.cycle
                };
                *error -= angle(late.max(min).min(MAX_LATE));
            }
        }
    }

    /// Phase errors as the cranks were left, with their corrections, counted from the first axis.
    pub(super) fn left(&self, correction: &PerAxis<Turns>) -> PerAxis<Angle> {
        let mut errors = self.errors(ErrorFilter::LowPass).map(angle);
        for (error, &correction) in errors.iter_mut().zip(correction) {
            *error += angle(correction);
        }
        let first = self.watched().trailing_zeros() as usize;
        let base = errors.get(first).copied().unwrap_or_default();
        errors.map(|error| error - base)
    }

    /// The watched axis that is furthest from the phase error that all have in common.
    #[inline(never)]
    pub(super) fn furthest_of(&self, error: &PerAxis<Angle>) -> usize {
        let common = in_common(error, self.watched());
        let off = |axis: &usize| {
            let error = error.get(*axis).copied().unwrap_or_default();
            (error - common).0.to_bits().unsigned_abs()
        };
        axes_of(self.watched()).max_by_key(off).unwrap_or(0)
    }

    /// Compares the axes without an encoder, and records those that moved differently from the others. Returns the common jump.
    fn compare(&mut self, shown: &mut Shown) -> Angle {
        let motion = self.common_motion();
        for (axis, state) in self.axes.iter_mut().enumerate() {
            if state.config.is_by_index() {
                shown.axis = axis;
                state.compare(motion, shown);
            }
        }
        motion.jump
    }

    /// Motion that the axes without an encoder have in common.
    #[inline(never)]
    fn common_motion(&self) -> Motion {
        let mut jumps = [Angle::ZERO; MAX_AXES];
        let mut drifts = jumps;
        let mut count = 0;
        for axis in &self.axes {
            let slots = jumps.get_mut(count).zip(drifts.get_mut(count));
            if let Some((jump, drift)) = slots
                && axis.config.is_by_index()
            {
                let motion = axis.motion();
                (*jump, *drift) = (motion.jump, motion.drift);
                count += 1;
            }
        }
        Motion {
            jump: middle(jumps.get_mut(..count).unwrap_or_default()),
            drift: middle(drifts.get_mut(..count).unwrap_or_default()),
        }
    }

    /// True if a crank by index moved away from the others by more than a gate since the axes were compared.
    fn moves_apart(&self) -> bool {
        let motion = self.common_motion();
        let mut axes = self.axes.iter();
        axes.any(|axis| axis.config.is_by_index() && axis.moves_from(motion))
    }

    /// The limit that the estimates with these modes exceed by `margin`, if they do: of the platform, or of the common lag.
    fn exceeded(
        &self,
        modes: &Modes,
        margin: Turns,
        is_compared: bool,
        shown: &Shown,
        speed: Turns,
    ) -> Option<FaultKind> {
        let limits = &self.config.limits;
        // In homing a crank stays where it was left, or was moved to prove its wiring, so the true limit applies. A crank that has moved
        // may move on, and it may be beyond the true limit while its reading is not.
        let may_be = limits.of_readings().exceeded(modes, margin);
        let exceeded = may_be.and_then(|kind| {
            let has_moved = shown.late != 0
                || !is_compared && self.moves_apart()
                || !self.is_homing && self.axes.iter().any(Axis::has_moved);
            if has_moved {
                Some(kind)
            } else {
                limits.of_cranks.exceeded(modes, margin)
            }
        });
        // Limits may be so wide that no delay exceeds them. If all cranks are late together, only the common part of their errors changes.
        let mut watched = axes_of(self.watched());
        let is_overdue = shown.late != 0
            && (shown.late_by.contains(&MAX_LATE)
                || watched.all(|axis| shown.late_by.get(axis) > Some(&limits.common)));
        match exceeded.or(is_overdue.then_some(FaultKind::Tilt)) {
            None if !self.is_homing => limits.of_common(&self.modes, speed),
            exceeded => exceeded,
        }
    }

    /// Reports new motions of cranks by name. During homing and levelling, the steps of homing evaluate the motion of the cranks.
    fn report_moves(&mut self, within_limits: bool, shown: &Shown, sensed: &Sensed<'_>) {
        if self.is_homing {
            return;
        }
        for axis in axes_of(shown.moved | shown.drifting) {
            let Some(state) = self.axes.get(axis) else {
                return;
            };
            let name = state.events.name(&state.config);
            let size = of_angle(state.events.size());
            let distance = state.steady_drift.distance();
            if shown.moved & 1 << axis != 0
                && let Some(kind) = name
            {
                self.report(axis, (kind, size, within_limits), shown, sensed);
            }
            if shown.drifting & 1 << axis != 0 {
                self.report(axis, (FaultKind::Drift, distance, true), shown, sensed);
            }
        }
    }

    /// Reports a fault of one axis.
    #[inline(never)]
    fn report(
        &mut self,
        axis: usize,
        (kind, by, within_limits): Report,
        shown: &Shown,
        sensed: &Sensed<'_>,
    ) {
        // One axis alone cannot be compared with others.
        let may_be_all = kind == FaultKind::IndexTimeout && self.watched().count_ones() > 1;
        let all_lag = may_be_all && self.all_lag_by(self.lag(axis, shown, sensed), shown, sensed);
        let fault = Fault::new(kind).on_axis(axis).with_size(by);
        self.findings.push(fault, within_limits, all_lag);
    }

    /// Reports that a limit is exceeded, with the axis, and the name of the cause if it is known.
    #[inline(never)]
    fn attribute(
        &mut self,
        kind: FaultKind,
        errors: &PerAxis<Angle>,
        shown: &Shown,
        sensed: &Sensed<'_>,
    ) {
        if kind == FaultKind::CommonLag {
            let size = self.config.limits.beyond_natural(&self.modes, sensed.speed);
            let all_lag = self.all_lag_by(size.wrapping_neg(), shown, sensed);
            let fault = Fault::new(kind).with_size(size);
            return self.findings.push(fault, false, all_lag);
        }
        let kind = if self.is_homing {
            FaultKind::HomingRangeExceeded
        } else {
            kind
        };
        // The cranks differ. A crank with a recorded event is the one that moved, even if another one is further from the rest.
        let worst = self.furthest_of(errors);
        let known = (worst..self.axes.len()).chain(0..worst).find_map(|axis| {
            let state = self.axes.get(axis)?;
            if shown.late & 1 << axis != 0 {
                return Some((axis, FaultKind::IndexTimeout));
            }
            Some((axis, state.name()?))
        });
        let (axis, kind) = known.unwrap_or((worst, kind));
        let size = match kind {
            // No pulse showed how far the crank is.
            FaultKind::IndexTimeout => self.single_axis_limit(axis).wrapping_neg(),
            _ => self.phase_error.get(axis).copied().unwrap_or_default(),
        };
        self.report(axis, (kind, size, false), shown, sensed);
    }

    /// Lag of an axis beyond the lag that belongs to the speed, turns: its phase error, and the delay of its next pulse.
    fn lag(&self, axis: usize, shown: &Shown, sensed: &Sensed<'_>) -> Turns {
        let value = |of: &PerAxis<Turns>| of.get(axis).copied().unwrap_or_default();
        let error = angle(value(&self.phase_error)) + angle(value(sensed.correction));
        let natural = self.config.limits.natural(sensed.speed);
        let ahead = of_angle(error).wrapping_add(natural);
        value(&shown.late_by).wrapping_sub(ahead)
    }

    /// Returns true if every watched axis lags by at least three quarters of `lag`. Cranks that lag for a common reason lag about alike,
    /// although flags at different places show it at different times. A crank that failed lags alone.
    #[inline(never)]
    fn all_lag_by(&self, lag: Turns, shown: &Shown, sensed: &Sensed<'_>) -> bool {
        let min = lag.wrapping_sub(lag / 4);
        let mut axes = axes_of(self.watched());
        lag > 0 && axes.all(|axis| self.lag(axis, shown, sensed) >= min)
    }

    /// Reports axes whose encoder shows that they do not turn as commanded. This works in homing too, and if all of them lag alike. If the
    /// motor follows, and the others lag alike, the fault is a common lag.
    #[inline(never)]
    fn check_encoders(&mut self) {
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let Some(state) = self.axes.get(axis) else {
                return;
            };
            if !state.is_off_track() {
                continue;
            }
            let mut errors = [Angle::ZERO; MAX_AXES];
            for (error, state) in errors.iter_mut().zip(&self.axes) {
                *error = angle(state.tracking_error().unwrap_or_default());
            }
            let by = state.tracking_error().unwrap_or_default();
            let others = self.encoders() & !(1 << axis);
            let from_others = by.wrapping_sub(of_angle(in_common(&errors, others)));
            let is_alike =
                others != 0 && from_others.wrapping_abs() <= state.config.single_axis_limit;
            let fault = match state.tracking() {
                Some(kind) => Fault::new(kind).on_axis(axis),
                None if is_alike => Fault::new(FaultKind::CommonLag),
                None => Fault::new(FaultKind::Tilt).on_axis(axis),
            };
            self.findings.push(fault.with_size(by), false, false);
        }
    }
}

/// The axes of a set.
fn axes_of(set: AxisSet) -> impl Iterator<Item = usize> {
    (0..MAX_AXES).filter(move |axis| set & 1 << axis != 0)
}
