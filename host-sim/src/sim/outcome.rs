//! Outcome of a run.

use cophase_core::supervisor::{Fault, State};
use cophase_methods::Scheme;

use super::statistics::Statistics;

/// Outcome of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Last state. If it is neither parked nor fault, the run was cut off, because nothing more was due.
    pub state: State,
    /// Fault that latched, if one did at any time.
    pub fault: Option<Fault>,
    /// Control ticks simulated.
    pub ticks: u64,
    /// Control ticks per second.
    pub tick_hz: u32,
    /// Statistics of the run.
    pub statistics: Statistics,
    /// Integration method of the machine and its steps per tick; none if nothing was integrated.
    pub method: Option<(Scheme, u32)>,
    /// Reason, in a sentence, why the simulated machine could not be advanced further. Its equations failed, not the loop.
    pub diverged: Option<String>,
}

impl Outcome {
    /// True if a motor slipped and nothing was reported. The controller then assumes the cranks in phase, and they are not.
    pub fn slipped_undetected(&self) -> bool {
        self.fault.is_none()
            && self.statistics.reported == 0
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
