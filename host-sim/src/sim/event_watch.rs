//! Events of a loop: the changes of its state in a tick.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Fault, RefusedCommand};

/// New events of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NewEvents {
    /// Fault that was reported, whatever the reaction to it.
    pub reported: Option<Fault>,
    /// Fault that latched, or the better name of a latched fault.
    pub latched: Option<Fault>,
    /// Command that was not possible.
    pub refused: Option<RefusedCommand>,
}

/// Detects new events, tick by tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct EventWatch {
    latched: Option<Fault>,
}

impl EventWatch {
    /// Returns the new events of a tick. Most ticks have none, and are handled quickly.
    #[inline]
    pub fn tick(&mut self, telemetry: &Telemetry) -> Option<NewEvents> {
        let is_well = telemetry.fault.is_none() && self.latched.is_none();
        if is_well && telemetry.event.is_none() && telemetry.refused.is_none() {
            return None;
        }
        let mut new_events = NewEvents {
            reported: telemetry.event,
            latched: None,
            refused: telemetry.refused,
        };
        if telemetry.fault != self.latched {
            self.latched = telemetry.fault;
            new_events.latched = telemetry.fault;
        }
        (new_events != NewEvents::default()).then_some(new_events)
    }
}
