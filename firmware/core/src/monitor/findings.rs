//! Findings that wait to be reported, one per tick, and the fault that caused a stop, which may get a better name.

use crate::supervisor::{Fault, FaultKind, Reaction};
use crate::units::Turns;
use heapless::Deque;

/// Fault or event that the monitor reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Fault or event.
    pub fault: Fault,
    /// True if the platform is within its limits, and the sensors still show the crank.
    pub within_limits: bool,
    /// True if this is a better name for the finding before it.
    pub supersedes: bool,
    /// True if every axis lags by about as much.
    pub all_lag: bool,
}

impl Finding {
    /// A finding that is outside the limits, and was not reported before.
    pub(crate) const fn from_fault(fault: Fault) -> Self {
        Self {
            fault,
            within_limits: false,
            supersedes: false,
            all_lag: false,
        }
    }
}

/// Turns after which a fault gets no better name. At the end of a stop, a crank moves for other reasons.
const NAMED_WITHIN: Turns = Turns::lit("4");

/// Findings that may wait to be reported, one a tick.
const WAITING: usize = 8;

/// True if a stop does not reach an axis with this fault.
fn disables(kind: FaultKind) -> bool {
    kind.reaction(false) == Reaction::Disable
}

/// Findings, in the order in which they are reported.
#[derive(Clone, Debug)]
pub(super) struct Findings {
    waiting: Deque<Finding, WAITING>,
    /// Axis and kind of the fault for which a stop was requested, and the master's turns since then.
    open: Option<(Option<usize>, FaultKind, Turns)>,
}

impl Findings {
    pub(super) const fn new() -> Self {
        Self {
            waiting: Deque::new(),
            open: None,
        }
    }

    /// Adds turns of the master.
    pub(super) const fn pass(&mut self, turns: Turns) {
        if let Some((_, _, since)) = &mut self.open {
            *since = since.saturating_add(turns);
        }
    }

    /// Takes the next finding to report.
    pub(super) fn next(&mut self) -> Option<Finding> {
        // Usually there is none, and `is_empty` is faster than moving an empty finding.
        if self.waiting.is_empty() {
            None
        } else {
            self.waiting.pop_front()
        }
    }

    pub(super) const fn has_requested_stop(&self) -> bool {
        self.open.is_some()
    }

    pub(super) fn clear(&mut self) {
        self.waiting.clear();
        self.open = None;
    }

    /// Queues a finding, `all_lag` for a lag of all axes. A finding outside the limits goes to the front. Of later ones outside
    /// the limits, the queue takes only better names for the first, and faults that a stop does not reach. Those within limits are queued.
    /// If the first has not been reported yet, it is reported by its better name alone.
    #[inline(never)]
    pub(super) fn push(&mut self, fault: Fault, within_limits: bool, all_lag: bool) {
        let before = self.open;
        let mut supersedes = false;
        let mut turns = Turns::ZERO;
        if let Some((axis, kind, since)) = before {
            let same = axis == fault.axis || axis.is_none();
            if same && since < NAMED_WITHIN && fault.kind.is_better_than(kind) {
                (supersedes, turns) = (true, since);
            } else if !within_limits && (!disables(fault.kind) || disables(kind)) {
                return; // The machine stops already.
            }
        }
        let within_limits = within_limits && !supersedes;
        if !within_limits {
            self.open = Some((fault.axis, fault.kind, turns));
        }
        if supersedes
            && let (Some((axis, kind, _)), Some(unreported)) = (before, self.waiting.front_mut())
            && (unreported.fault.axis, unreported.fault.kind) == (axis, kind)
            && !unreported.within_limits
        {
            (unreported.fault, unreported.all_lag) = (fault, all_lag);
            return;
        }
        let finding = Finding {
            fault,
            within_limits,
            supersedes,
            all_lag,
        };
        if self.waiting.is_full() {
            self.waiting.pop_back();
        }
        // There is room now.
        let _ = if within_limits {
            self.waiting.push_back(finding)
        } else {
            self.waiting.push_front(finding)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the better name is reported first, and then the worse one as another fault.
    #[test]
    fn a_fault_with_a_better_name_in_the_same_tick_is_reported_once() {
        let mut findings = Findings::new();
        let fault = |kind| Fault::new(kind).on_axis(1);
        findings.push(fault(FaultKind::Tilt), false, true);
        findings.push(fault(FaultKind::EncoderGlitch), true, false);
        findings.push(fault(FaultKind::Reversed), false, false);
        let first = findings.next().expect("one is reported");
        assert_eq!(first, Finding::from_fault(fault(FaultKind::Reversed)));
        let second = findings.next().map(|second| second.fault.kind);
        assert_eq!(second, Some(FaultKind::EncoderGlitch));
        assert_eq!(findings.next(), None);
    }

    /// If this fails, a better name for a fault that was reported hides another fault that still waits.
    #[test]
    fn a_better_name_replaces_no_other_fault_that_waits() {
        let mut findings = Findings::new();
        findings.push(Fault::new(FaultKind::IndexTimeout).on_axis(1), false, false);
        findings.push(Fault::new(FaultKind::Runaway).on_axis(2), false, false);
        let next = |findings: &mut Findings| {
            let found = findings.next().expect("it is reported");
            (found.fault.kind, found.supersedes)
        };
        assert_eq!(next(&mut findings), (FaultKind::Runaway, false));
        findings.push(Fault::new(FaultKind::Reversed).on_axis(2), false, false);
        assert_eq!(next(&mut findings), (FaultKind::Reversed, true));
        assert_eq!(next(&mut findings), (FaultKind::IndexTimeout, false));
    }

    /// A name that comes in a later tick replaces the one that was reported.
    #[test]
    fn a_fault_with_a_better_name_in_a_later_tick_is_reported_again() {
        let mut findings = Findings::new();
        for kind in [FaultKind::Tilt, FaultKind::Reversed] {
            findings.push(Fault::new(kind).on_axis(1), false, false);
            let found = findings.next().expect("it is reported");
            assert_eq!(found.supersedes, kind == FaultKind::Reversed);
        }
    }
}
