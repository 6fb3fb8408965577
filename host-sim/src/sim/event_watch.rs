//! Events of a loop: which of its state is new in a tick.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::Fault;

/// What is new in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NewEvents {
    /// Fault that was reported, whatever is done about it.
    pub reported: Option<Fault>,
    /// The fault that latched, or the better name that it has got.
    pub latched: Option<Fault>,
}

/// Looks for news, tick by tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct EventWatch {
    latched: Option<Fault>,
}

impl EventWatch {
    /// What a tick brings; most bring nothing, and are passed over quickly.
    #[inline]
    pub fn tick(&mut self, telemetry: &Telemetry) -> Option<NewEvents> {
        let is_well = telemetry.fault.is_none() && self.latched.is_none();
        if is_well && telemetry.event.is_none() {
            return None;
        }
        let mut new_events = NewEvents {
            reported: telemetry.event,
            latched: None,
        };
        if telemetry.fault != self.latched {
            self.latched = telemetry.fault;
            new_events.latched = telemetry.fault;
        }
        (new_events != NewEvents::default()).then_some(new_events)
    }
}
