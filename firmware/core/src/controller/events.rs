//! What is reported of all that happened in a tick, and which of it comes first.

use super::Controller;
use crate::drift::{Finding, is_better};
use crate::signals::Feedback;
use crate::supervisor::{Fault, FaultKind, Reaction, Supervisor, SupervisorInput, reaction};
use crate::units::MAX_AXES;

/// Ticks after a stop in which its last pulses still lead to a report: 2 until a tick is read, `MAX_AXES` + 3 until it is evaluated.
const LAST_PULSES: u64 = 7 + MAX_AXES as u64;

impl Controller {
    /// Drops a finding that is nobody's fault, and names one that homing or the master's speed has a better name for.
    #[inline(never)] // A finding has 48 bytes: it is moved about only where there is one.
    pub(super) fn judge(&self, found: Option<Finding>) -> Option<Finding> {
        let mut finding = found?;
        // What cranks do that nothing drives is nobody's fault, and cranks that are held have a watch of their own. But a name may come
        // with the last of a stop's pulses.
        let in_time = finding.supersedes && self.ticks - self.driven <= LAST_PULSES;
        if !self.supervisor.operates() && !in_time {
            return None;
        }
        if finding.fault.kind == FaultKind::HomingRangeExceeded
            && let Some(fault) = self.homing.explain(&self.drift, &self.offsets)
        {
            finding.fault = fault;
        }
        if finding.all_lag && self.shaft.limits().is_at_band(self.motion.speed) {
            finding.fault.kind = FaultKind::Capture;
            finding.fault.axis = None;
        }
        Some(finding)
    }

    /// Shows what has happened, one thing a tick: a fault that latched or has a better name, what else was detected, the stop input.
    #[inline(never)]
    pub(super) fn publish(&mut self, is_new: bool, reported: Option<&Fault>, stop: bool) {
        let (tick, phase) = (self.ticks, self.crank_phase());
        let new_faults = [
            self.supervisor.fault().filter(|_| is_new),
            self.unpublished.take(),
            reported.map(|fault| fault.at(tick, phase)),
            stop.then(|| Fault::new(FaultKind::StopInput).at(tick, phase)),
        ];
        let (first, second, count) = first_two(&new_faults);
        let telemetry = &mut self.output.telemetry;
        // More than two at once are counted, and no more.
        let known = u32::from(second.is_some());
        telemetry.event_count = telemetry.event_count.wrapping_add(count - known);
        telemetry.event = first.copied();
        self.unpublished = second.copied();
    }

    /// Which of all that is wrong comes first.
    #[inline(never)] // a fault has 48 bytes, to be moved about only where there is one
    pub(super) fn highest_priority_fault(
        &mut self,
        feedback: &Feedback,
        input: &mut SupervisorInput,
    ) {
        let dry = feedback
            .fifo_underrun
            .map(|axis| Fault::new(FaultKind::StepFifoUnderrun).on_axis(axis));
        let mut alarms = feedback.alarm.iter().take(self.channels.len());
        let alarm = alarms.position(|&alarm| alarm);
        let alarm = alarm.map(|axis| Fault::new(FaultKind::DriveAlarm).on_axis(axis));
        // What disables the drives comes before all that stops them; and a better name is for what latched before.
        if input.fault.is_some() && (input.reaction == Reaction::Disable || input.supersedes) {
            return;
        }
        if let Some(fault) = dry.or_else(|| self.overrun.take()).or(alarm) {
            input.fault = Some(fault);
            input.reaction = reaction(fault.kind, false);
            input.supersedes = false;
        }
    }
}

/// The event that is published now, the one that is published next, and the number of events.
#[inline(never)]
fn first_two(new_faults: &[Option<Fault>]) -> (Option<&Fault>, Option<&Fault>, u32) {
    let mut all = new_faults.iter().flatten();
    let (first, second) = (all.next(), all.next());
    let count = new_faults.iter().flatten().count() as u32;
    (first, second, count)
}

/// Selects the reaction to a finding; returns the fault if it is only to be published.
#[inline(never)]
pub(super) fn select_reaction(
    found: Finding,
    supervisor: &Supervisor,
    input: &mut SupervisorInput,
) -> Option<Fault> {
    let Finding { fault, .. } = found;
    let reaction = reaction(fault.kind, found.within_limits);
    if found.supersedes {
        // What latched may be something else, which no sensor of a crank has a better name for.
        let latched = supervisor.fault();
        let is_of_it = |old: Fault| old.axis == fault.axis || old.axis.is_none();
        if !latched.is_some_and(|old| is_of_it(old) && is_better(fault.kind, old.kind)) {
            return None;
        }
        input.supersedes = true;
    } else if !reaction.stops() {
        return Some(fault);
    }
    input.fault = Some(fault);
    input.reaction = reaction;
    None
}
