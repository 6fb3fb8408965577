//! What is told of all that happened in a tick, and which of it comes first.

use super::Controller;
use crate::drift::{Finding, is_better};
use crate::signals::Feedback;
use crate::supervisor::{Fault, FaultKind, Reaction, Seen, Supervisor, reaction};

impl Controller {
    /// Tells what has happened, one thing a tick: a fault that latched or has a better name, what else was seen, the stop input.
    #[inline(never)]
    pub(super) fn tell(&mut self, is_news: bool, told: Option<Fault>, stop: bool) {
        let (tick, phase) = (self.ticks, self.crank_phase());
        let news = [
            self.supervisor.fault().filter(|_| is_news),
            self.untold.take(),
            told.map(|fault| fault.at(tick, phase)),
            stop.then(|| Fault::new(FaultKind::StopInput).at(tick, phase)),
        ];
        let (first, second, count) = first_two(&news);
        let telemetry = &mut self.output.telemetry;
        // More than two at once are counted, and no more.
        let known = u32::from(second.is_some());
        telemetry.incidents = telemetry.incidents.wrapping_add(count - known);
        telemetry.incident = first.copied();
        self.untold = second.copied();
    }

    /// Which of all that is wrong comes first.
    #[inline(never)] // a fault has 48 bytes, to be moved about only where there is one
    pub(super) fn blame(&mut self, feedback: &Feedback, seen: &mut Seen) {
        let dry = feedback
            .ran_dry
            .map(|axis| Fault::new(FaultKind::RanDry).on_axis(axis));
        let alarm = feedback.alarm.iter().position(|&alarm| alarm);
        let alarm = alarm.map(|axis| Fault::new(FaultKind::DriveAlarm).on_axis(axis));
        // What disables the drives comes before all that stops them; and a better name is for what latched before.
        if seen.fault.is_some() && (seen.reaction == Reaction::Disable || seen.refines) {
            return;
        }
        if let Some(fault) = dry.or_else(|| self.overrun.take()).or(alarm) {
            seen.fault = Some(fault);
            seen.reaction = reaction(fault.kind, false);
            seen.refines = false;
        }
    }
}

/// Of what there is to tell, what is told now, what next, and how much there is.
#[inline(never)]
fn first_two(news: &[Option<Fault>]) -> (Option<&Fault>, Option<&Fault>, u32) {
    let mut all = news.iter().flatten();
    let (first, second) = (all.next(), all.next());
    let count = news.iter().flatten().count() as u32;
    (first, second, count)
}

/// What is to be done about what was found: what is seen of it, or else what is told.
#[inline(never)]
pub(super) fn weigh(found: Finding, supervisor: &Supervisor, seen: &mut Seen) -> Option<Fault> {
    let Finding { fault, .. } = found;
    let reaction = reaction(fault.kind, found.in_safety);
    if found.refines {
        // What latched may be something else, which no sensor of a crank has a better name for.
        let latched = supervisor.fault();
        if latched.is_none_or(|old| !is_better(fault.kind, old.kind)) {
            return None;
        }
        seen.refines = true;
    } else if reaction < Reaction::Stop {
        return Some(fault);
    }
    seen.fault = Some(fault);
    seen.reaction = reaction;
    None
}
