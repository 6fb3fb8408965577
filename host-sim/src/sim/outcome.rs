//! Outcome of a run.

use cophase_core::supervisor::{Fault, State};
use cophase_methods::Scheme;

use super::record::RunRecord;

/// Outcome of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Last state. If it is neither parked nor fault, the run was cut off, because nothing more was due.
    pub state: State,
    /// Fault that latched, if one did at any time.
    pub fault: Option<Fault>,
    /// Control ticks per second.
    pub tick_hz: u32,
    /// Record of the run.
    pub record: RunRecord,
    /// Integration method of the machine and its steps per tick; none if nothing was integrated.
    pub method: Option<(Scheme, u32)>,
    /// Reason, in a sentence, why the simulated machine could not be advanced further. Its equations failed, not the loop.
    pub diverged: Option<String>,
}

impl Outcome {
    /// Axes that slipped, stood, or ended off their commands, in a run in which the controller reported nothing. It then assumes them in
    /// place, and they are not.
    pub fn lost_unnoticed(&self) -> impl Iterator<Item = usize> {
        let is_noticed = self.fault.is_some() || self.record.reported > 0;
        let axes = self.record.axes.iter().enumerate();
        axes.filter(move |(_, axis)| {
            let slipped = axis.slipped_cycles.is_some_and(|cycles| cycles != 0);
            (slipped || axis.off_command_turns != 0.0 || axis.stood) && !is_noticed
        })
        .map(|(i, _)| i)
    }

    /// True if the run did not end as it should: by a fault, with shafts that the controller lost unnoticed, or with a machine that
    /// diverged.
    pub fn went_wrong(&self) -> bool {
        self.fault.is_some() || self.diverged.is_some() || self.lost_unnoticed().next().is_some()
    }

    /// Simulated time, s.
    pub fn simulated_s(&self) -> f64 {
        self.record.control_ticks as f64 / f64::from(self.tick_hz)
    }
}
