//! How a run ended.

use cophase_core::supervisor::{Fault, State};
use cophase_methods::Scheme;

use super::statistics::Statistics;

/// How a run ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The last state. Neither parked nor fault: the run was cut off, as nothing more was to happen.
    pub state: State,
    /// The fault that latched, if one did at any time.
    pub fault: Option<Fault>,
    /// Control ticks simulated.
    pub ticks: u64,
    /// Control ticks a second.
    pub tick_hz: u32,
    /// What was seen on the way.
    pub statistics: Statistics,
    /// How the machine was advanced, and in how many steps a tick; none if nothing was integrated.
    pub method: Option<(Scheme, u32)>,
    /// Why the simulated machine went no further, in a sentence: its equations, not the loop, came to an end.
    pub diverged: Option<String>,
}

impl Outcome {
    /// Whether a motor slipped and nothing was told of it: the controller believes the cranks in phase, and they are not.
    pub fn slipped_unseen(&self) -> bool {
        self.fault.is_none()
            && self.statistics.told == 0
            && self
                .statistics
                .slipped_cycles
                .iter()
                .any(|&cycles| cycles != 0)
    }

    /// Simulated time, s.
    pub fn simulated_s(&self) -> f64 {
        self.ticks as f64 / f64::from(self.tick_hz)
    }
}
