//! Changes of the loop from tick to tick, which become log lines and events.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Fault, RefusedCommand, State};

use crate::message::{Event, FaultRecord, RefusedRecord};

/// Something that changed in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// New state of the machine.
    State(State),
    /// An event: a fault that latched, or got a better name, or one that is only reported.
    Event {
        /// The event.
        fault: Fault,
        /// True if it is the latched fault.
        latched: bool,
    },
    /// A command that was not possible.
    Refused(RefusedCommand),
    /// Deadlines missed so far.
    Missed(u32),
    /// Deadlines met late so far.
    Late(u32),
}

impl From<&Change> for Event {
    fn from(change: &Change) -> Self {
        match change {
            Change::State(state) => Self::State(*state as u8),
            Change::Event { fault, latched } => {
                let record = FaultRecord::from(fault);
                if *latched {
                    Self::Fault(record)
                } else {
                    Self::Reported(record)
                }
            }
            Change::Refused(refused) => Self::Refused(RefusedRecord::from(refused)),
            Change::Missed(all) => Self::Missed(*all),
            Change::Late(all) => Self::Late(*all),
        }
    }
}

/// Comparison of each tick with the one before.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    state: State,
    faulty: bool,
    missed: u32,
    late: u32,
}

impl Watch {
    /// Watch of a loop that is idle and has missed no deadline.
    pub const fn new() -> Self {
        Self {
            state: State::Idle,
            faulty: false,
            missed: 0,
            late: 0,
        }
    }

    /// Compares the telemetry of a tick with the one before, and passes on each change.
    #[inline]
    pub fn observe(&mut self, telemetry: &Telemetry, mut publish: impl FnMut(Change)) {
        // A fault that latched before the first tick was not an event of any tick.
        let is_new = telemetry.fault.is_some() && !self.faulty;
        self.faulty = telemetry.fault.is_some();
        if (telemetry.event.is_some() || is_new)
            && let Some(fault) = telemetry.event.or(telemetry.fault)
        {
            let latched = telemetry.fault == Some(fault);
            publish(Change::Event { fault, latched });
        }
        if let Some(refused) = telemetry.refused {
            publish(Change::Refused(refused));
        }
        if telemetry.state != self.state {
            self.state = telemetry.state;
            publish(Change::State(self.state));
        }
        let limits = &telemetry.limits;
        if limits.missed_deadlines != self.missed {
            self.missed = limits.missed_deadlines;
            publish(Change::Missed(self.missed));
        }
        if limits.late_deadlines != self.late {
            self.late = limits.late_deadlines;
            publish(Change::Late(self.late));
        }
    }
}
