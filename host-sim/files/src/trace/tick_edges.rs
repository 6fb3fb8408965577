//! Edges of one tick, as `steps.vcd` takes them.

use cophase_core::pulse::Runs;
use host_sim::sim::Moment;

/// Pulses of all axes in one tick, and the levels of the other wires.
#[derive(Debug)]
pub struct TickEdges<'a> {
    /// Beginning of the tick, ns since power-up.
    pub start_ns: u64,
    /// End of the tick, ns since power-up.
    pub end_ns: u64,
    /// Cycles of the step clock in the tick.
    pub tick_cycles: u32,
    /// True if the master turns.
    pub moves: bool,
    /// Pulses of each axis.
    pub runs: heapless::Vec<&'a Runs, { cophase_core::units::MAX_AXES }>,
    /// Axes whose direction is inverted at the pin.
    pub reversed: &'a [bool],
    /// Level of the drives' enable.
    pub enable: bool,
    /// Edges of the wires that no controller reports. `None` unless the machine is simulated.
    pub sensed: Option<SensedEdges<'a>>,
}

/// Wires that no controller reports.
#[derive(Debug)]
pub struct SensedEdges<'a> {
    /// Times at which index lines rose, cycles from the tick's beginning.
    pub index: &'a [Option<u32>],
    /// Times at which index lines fell, cycles from the tick's beginning.
    pub index_fell: &'a [Option<u32>],
    /// Levels of the index lines at the end of the tick.
    pub index_high: &'a [bool],
    /// Level of the sync line.
    pub sync: bool,
}

impl<'a> TickEdges<'a> {
    /// Edges of a tick of a simulated run.
    pub fn from_moment(moment: &Moment<'a>, reversed: &'a [bool]) -> Self {
        Self {
            start_ns: moment.start_ns,
            end_ns: moment.end_ns,
            tick_cycles: moment.machine.tick_cycles(),
            moves: moment.telemetry.motion.speed != 0,
            runs: (0..moment.axis_count())
                .map(|i| moment.played.runs(i))
                .collect(),
            reversed,
            enable: moment.drives_enabled,
            sensed: Some(SensedEdges {
                index: moment.index,
                index_fell: moment.index_fell,
                index_high: moment.index_high,
                sync: moment.sync,
            }),
        }
    }

    /// Time of a number of cycles of the step clock, ns, rounded down.
    pub fn ns(&self, cycles: u64) -> u64 {
        cycles * (self.end_ns - self.start_ns) / u64::from(self.tick_cycles)
    }

    /// Returns the changes of the index line of an axis, in order: the time, ns since power-up, and the level.
    pub(super) fn index_changes(&self, axis: usize) -> impl Iterator<Item = (u64, bool)> {
        let sensed = self.sensed.as_ref();
        let at = |cycle: Option<u32>| Some(self.start_ns + self.ns(cycle?.into()));
        let rise = sensed.and_then(|sensed| at(sensed.index[axis]));
        let fall = sensed.and_then(|sensed| at(sensed.index_fell[axis]));
        let (rise, fall) = (rise.map(|at| (at, true)), fall.map(|at| (at, false)));
        let is_down_first = fall.map(|(at, _)| at) < rise.map(|(at, _)| at);
        let changes = if is_down_first {
            [fall, rise]
        } else {
            [rise, fall]
        };
        changes.into_iter().flatten()
    }

    /// Returns the level of the index line of an axis at the end of the tick.
    pub(super) fn is_index_high(&self, axis: usize) -> bool {
        let sensed = self.sensed.as_ref();
        sensed.is_some_and(|sensed| sensed.index_high[axis])
    }
}
