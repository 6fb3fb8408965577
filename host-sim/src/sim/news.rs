//! What a loop tells: what of it is new in a tick.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::Fault;

/// What is new in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct News {
    /// What was told, whatever is done about it.
    pub told: Option<Fault>,
    /// The fault that latched, or the better name that it has got.
    pub latched: Option<Fault>,
}

/// Looks for news, tick by tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tellings {
    latched: Option<Fault>,
}

impl Tellings {
    /// What a tick brings; most bring nothing, and are passed over quickly.
    #[inline]
    pub fn tick(&mut self, telemetry: &Telemetry) -> Option<News> {
        let is_well = telemetry.fault.is_none() && self.latched.is_none();
        if is_well && telemetry.incident.is_none() {
            return None;
        }
        let mut news = News {
            told: telemetry.incident,
            latched: None,
        };
        if telemetry.fault != self.latched {
            self.latched = telemetry.fault;
            news.latched = telemetry.fault;
        }
        (news != News::default()).then_some(news)
    }
}
