//! What the monitor has found and not told yet, one thing a tick; and what a stop was asked for, which may get a better name.

use super::naming;
use crate::supervisor::{Fault, FaultKind};
use crate::units::Turns;
use heapless::Deque;

/// What the monitor has to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What it is.
    pub fault: Fault,
    /// The platform is within its limits, and the crank still seen.
    pub in_safety: bool,
    /// It is what was found before, better named.
    pub refines: bool,
}

impl Finding {
    /// Of what is no longer safe, and was not told before.
    pub(crate) const fn of(fault: Fault) -> Self {
        Self {
            fault,
            in_safety: false,
            refines: false,
        }
    }
}

/// Turns after which what a machine was stopped for gets no better name: a crank at the end of a stop does other things.
const NAMED_WITHIN: Turns = Turns::lit("4");

/// Findings that may wait to be told, one a tick.
const WAITING: usize = 8;

/// Findings, in the order in which they are told.
#[derive(Clone, Debug)]
pub(super) struct Findings {
    waiting: Deque<Finding, WAITING>,
    /// What a stop was asked for, of which axis, and the master's turns since.
    open: Option<(Option<usize>, FaultKind)>,
    since_open: Turns,
}

impl Findings {
    pub(super) const fn new() -> Self {
        Self {
            waiting: Deque::new(),
            open: None,
            since_open: Turns::ZERO,
        }
    }

    /// The master made so many turns.
    pub(super) const fn pass(&mut self, turns: Turns) {
        if self.open.is_some() {
            self.since_open = self.since_open.saturating_add(turns);
        }
    }

    /// What is told now.
    pub(super) fn next(&mut self) -> Option<Finding> {
        // Mostly there is none: that is asked before an empty finding is moved about.
        if self.waiting.is_empty() {
            None
        } else {
            self.waiting.pop_front()
        }
    }

    pub(super) const fn has_asked_for_a_stop(&self) -> bool {
        self.open.is_some()
    }

    pub(super) fn clear(&mut self) {
        self.waiting.clear();
        self.open = None;
    }

    /// To be told. What is no longer safe goes first, and once; after that only better names for it.
    #[inline(never)]
    pub(super) fn push(&mut self, fault: Fault, in_safety: bool) {
        let mut refines = false;
        if let Some((axis, kind)) = self.open {
            let same = axis == fault.axis || axis.is_none();
            let in_time = self.since_open < NAMED_WITHIN;
            if same && in_time && naming::is_better(fault.kind, kind) {
                refines = true;
            } else if !in_safety {
                return; // it is being stopped
            }
        }
        if !refines && !in_safety {
            self.since_open = Turns::ZERO;
        }
        if !in_safety || refines {
            self.open = Some((fault.axis, fault.kind));
        }
        let finding = Finding {
            fault,
            in_safety: in_safety && !refines,
            refines,
        };
        if self.waiting.is_full() {
            self.waiting.pop_back();
        }
        // There is room now.
        let _ = if in_safety {
            self.waiting.push_back(finding)
        } else {
            self.waiting.push_front(finding)
        };
    }
}
