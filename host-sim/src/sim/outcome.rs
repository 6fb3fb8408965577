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
    /// Axes that slipped, stood, or ended off their commands, in a run in which the controller reported nothing. It then assumes them in
    /// place, and they are not.
    pub fn lost_unnoticed(&self) -> impl Iterator<Item = usize> {
        let statistics = &self.statistics;
        let is_noticed = self.fault.is_some() || statistics.reported > 0;
        (0..statistics.slipped_cycles.len()).filter(move |&i| {
            let slipped = statistics.cycles_off(i) != 0;
            let is_off = statistics.off_command_turns[i] != 0.0;
            (slipped || is_off || statistics.stood[i]) && !is_noticed
        })
    }

    /// True if the run did not end as it should: by a fault, with shafts that the controller lost unnoticed, or with a machine that
    /// diverged.
    pub fn went_wrong(&self) -> bool {
        self.fault.is_some() || self.diverged.is_some() || self.lost_unnoticed().next().is_some()
    }

    /// Simulated time, s.
    pub fn simulated_s(&self) -> f64 {
        self.ticks as f64 / f64::from(self.tick_hz)
    }
}
