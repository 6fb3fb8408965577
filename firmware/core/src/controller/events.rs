//! Events of a tick: selection of the one that is reported first, and of the reaction to it.

use super::Controller;
use crate::monitor::Finding;
use crate::signals::Feedback;
use crate::supervisor::{Fault, FaultKind, Reaction, Supervisor, SupervisorInput};
use crate::units::MAX_AXES;

/// Number of ticks after a stop in which its last pulses still lead to a report: 2 until a tick is read, and one for each axis, as one
/// finding is reported per tick.
const LAST_PULSES: u64 = 2 + MAX_AXES as u64;

impl Controller {
    /// Drops a finding that is no fault of an axis. Renames one for which homing or the master's speed gives a better name.
    #[inline(never)] // seldom
    pub(super) fn judge(&mut self, found: &mut Option<Finding>) {
        let Some(finding) = found else {
            return;
        };
        // Motion of cranks whose drives are off is no fault, and a separate watch covers held cranks. But the last pulses of a stop may
        // still give a better name.
        let in_time = finding.supersedes && self.state.ticks - self.state.driven <= LAST_PULSES;
        if !self.supervisor.operates() && !in_time {
            *found = None;
            return;
        }
        if finding.fault.kind == FaultKind::HomingRangeExceeded
            && let Some(fault) = self.homing.explain(&mut self.monitor, &self.offsets)
        {
            finding.fault = fault;
        }
        if finding.all_lag && self.shaft.limits().is_at_band(self.state.motion.speed) {
            finding.fault.kind = FaultKind::Capture;
            finding.fault.axis = None;
        }
    }

    /// Publishes one event in each tick: a fault that latched or has a better name, another detected event, or the stop input. No event
    /// may have been published in this tick yet.
    #[inline(never)]
    pub(super) fn publish(&mut self, is_new: bool, reported: Option<&Fault>, stop: bool) {
        let waiting = self.state.unpublished.take();
        if is_new && let Some(fault) = self.supervisor.fault() {
            self.add_event(&fault);
        }
        if let Some(fault) = waiting {
            self.add_event(&fault);
        }
        if let Some(fault) = reported {
            self.add_event_now(fault);
        }
        if stop {
            self.add_event_now(&Fault::new(FaultKind::StopInput));
        }
    }

    /// Adds an event of this tick.
    #[inline(never)]
    fn add_event_now(&mut self, fault: &Fault) {
        let (tick, phase) = (self.state.ticks, self.crank_phase());
        if let Some(event) = self.add_event(fault) {
            event.tick = tick;
            event.phase = phase;
        }
    }

    /// Publishes an event in this tick, or in the next one if another is published in this. More than two events at once are counted, but
    /// not published.
    #[inline(never)] // It copies the event's 40 bytes once, by words.
    fn add_event(&mut self, fault: &Fault) -> Option<&mut Fault> {
        let telemetry = &mut self.output.telemetry;
        if telemetry.event.is_some() && self.state.unpublished.is_none() {
            return Some(self.state.unpublished.insert(*fault));
        }
        telemetry.event_count = telemetry.event_count.wrapping_add(1);
        if telemetry.event.is_some() {
            return None;
        }
        Some(telemetry.event.insert(*fault))
    }

    /// Selects the fault with the highest priority.
    #[inline(never)] // A fault has 40 bytes: it is copied only if there is one.
    pub(super) fn highest_priority_fault(
        &mut self,
        feedback: &Feedback,
        input: &mut SupervisorInput,
    ) {
        let dry = feedback
            .fifo_underrun
            .map(|axis| Fault::new(FaultKind::StepFifoUnderrun).on_axis(axis));
        let alarm = (0..self.channels.len()).find(|axis| feedback.alarms & 1 << axis != 0);
        let alarm = alarm.map(|axis| Fault::new(FaultKind::DriveAlarm).on_axis(axis));
        // A fault that disables the drives has priority over all that stop the machine. A better name belongs to the fault that latched
        // before.
        if input.fault.is_some() && (input.reaction == Reaction::Disable || input.supersedes) {
            return;
        }
        if let Some(fault) = dry.or_else(|| self.state.overrun.take()).or(alarm) {
            input.fault = Some(fault);
            input.reaction = fault.kind.reaction(false);
            input.supersedes = false;
        }
    }
}

/// Selects the reaction to a finding. Returns the fault if it is only to be published.
#[inline(never)]
pub(super) fn select_reaction(
    found: &Finding,
    supervisor: &Supervisor,
    input: &mut SupervisorInput,
) -> Option<Fault> {
    let fault = &found.fault;
    let reaction = fault.kind.reaction(found.within_limits);
    if found.supersedes {
        // The latched fault may be a different one, for which this finding is no better name.
        let latched = supervisor.fault();
        let is_of_it = |old: Fault| old.axis == fault.axis || old.axis.is_none();
        if !latched.is_some_and(|old| is_of_it(old) && fault.kind.is_better_than(old.kind)) {
            return None;
        }
        input.supersedes = true;
    } else if !reaction.stops() {
        return Some(*fault);
    }
    input.fault = Some(*fault);
    input.reaction = reaction;
    None
}
