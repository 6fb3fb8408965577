//! The drift monitor: how far each crank is from where it was told to be, and what that does to the
//! platform.
//!
//! Words: *drift* is measured minus commanded phase of one axis. An *index pulse* comes once a turn
//! of a crank, when it passes its sensor. The cranks stand in a circle, so their N drifts are taken
//! apart into *modes*: common (all lag alike: harmless), tilt about two axes, and warp, which is what
//! no flat platform can follow.
//!
//! The modes are taken whenever every axis has been heard since they were taken last, so that drifts
//! of one turn are compared with each other and not with those of the turn before.
//!
//! Index lines are noisy; [`IndexFilter`] makes pulses of their levels, which are what is heard here.
//!
//! What it does not do yet: name what happened (lost steps, slip, a bad sensor), or use encoders.

pub mod index_filter;
mod limits;
mod modes;

pub use index_filter::IndexFilter;
pub use limits::DriftLimits;
pub use modes::{Modes, Mount};

use crate::functions::{multiply, multiply_long};
use crate::supervisor::{Fault, FaultKind};
use crate::units::{Phase, Turns, nearest};

/// An index pulse: when it came, seen from the tick that was over when it was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexPulse {
    /// Cycles of the step clock from the beginning of that tick, up to a tick's cycles; negative if it
    /// came in the tick before, and was confirmed in that one.
    pub cycle: i32,
}

/// Phase of an axis over one tick: where it began, and how far it went, at constant speed.
#[derive(Clone, Copy, Debug, Default)]
pub struct TickPhase {
    /// Commanded phase at the tick's beginning.
    pub start: Phase,
    /// Turns commanded in it.
    pub turns: Turns,
}

impl TickPhase {
    /// Commanded phase `cycle` cycles into a tick, of whose cycles `per_tick_cycle` is the reciprocal.
    fn at(&self, cycle: u32, per_tick_cycle: u32) -> Phase {
        // cycle / tick_cycles with 44 fraction bits, of which 24 are plenty; and of the turns of a
        // tick, below ½, the upper 40: 2⁻²⁴ of a tick is less than a cycle.
        let part = multiply(cycle, per_tick_cycle).min(1 << 44) >> 20;
        let turns = (self.turns.to_bits() >> 8) as u64;
        let turns = multiply_long(turns, part as u32) as i64 >> 16;
        self.start.advanced(Turns::from_bits(turns))
    }
}

/// A set of axes: a bit for each.
type Axes = u8;

/// Watches the drift of `N` axes.
#[derive(Clone, Debug)]
pub struct DriftMonitor<const N: usize> {
    limits: DriftLimits,
    mount: Mount<N>,
    index: [Option<Turns>; N],
    /// Axes that have a sensor.
    sensed: Axes,
    tick_cycles: u32,
    /// 2⁴⁴ / cycles of a tick.
    per_tick_cycle: u32,
    /// What was commanded in the tick before the one that is over; none if that is not known.
    before: Option<[TickPhase; N]>,
    drift: [Turns; N],
    /// Axes heard since the modes were taken last.
    heard: Axes,
    /// Commanded turns of each axis since its last index pulse.
    since_index: [Turns; N],
    /// Axes that have been heard at all.
    known: Axes,
    modes: Modes,
}

impl<const N: usize> DriftMonitor<N> {
    /// For sensors at the phases `index` (none: the axis has no sensor).
    pub fn new(limits: DriftLimits, index: [Option<Turns>; N], tick_cycles: u32) -> Self {
        Self {
            limits,
            mount: Mount::new(),
            index,
            sensed: (0..N)
                .filter(|&axis| index[axis].is_some())
                .fold(0, |axes, axis| axes | 1 << axis),
            tick_cycles,
            // Ticks have 12,500 cycles and more: 31 bits.
            per_tick_cycle: ((1 << 44) / u64::from(tick_cycles)) as u32,
            before: None,
            drift: [Turns::ZERO; N],
            heard: 0,
            since_index: [Turns::ZERO; N],
            known: 0,
            modes: Modes::default(),
        }
    }

    /// Takes in the index pulses of a tick that is over, with the phases that were commanded in it.
    ///
    /// # Errors
    /// A mode past its limit, or an index pulse that stays away for over a turn.
    pub fn observe(
        &mut self,
        pulses: &[Option<IndexPulse>; N],
        commanded: &[TickPhase; N],
    ) -> Result<(), Fault> {
        let before = self.before.replace(*commanded);
        let mut missing = None;
        let mut heard = 0;
        for axis in 0..N {
            let (Some(index), phase) = (self.index[axis], &commanded[axis]) else {
                continue;
            };
            let Some(pulse) = pulses[axis] else {
                // The turns of this tick come on top only now: a pulse in it may wait to be confirmed.
                if self.since_index[axis] > self.limits.index_turns {
                    missing = Some(axis);
                }
                // Bounded: beyond the limit it is a fault and begins anew, and no axis goes back by more than
                // its trim.
                self.since_index[axis] = self.since_index[axis].wrapping_add(phase.turns);
                continue;
            };
            let back = pulse.cycle.min(0).unsigned_abs();
            self.since_index[axis] = Turns::ZERO;
            let (phase, cycle) = if back == 0 {
                (Some(phase), pulse.cycle.unsigned_abs())
            } else {
                let before = before.as_ref().map(|before| &before[axis]);
                (before, self.tick_cycles.saturating_sub(back))
            };
            if let Some(phase) = phase {
                let at = phase.at(cycle, self.per_tick_cycle);
                self.drift[axis] = nearest(Phase::from_turns(index).since(at));
                heard |= 1 << axis;
            }
        }
        self.heard |= heard;
        self.known |= heard;
        if let Some(axis) = missing {
            self.since_index[axis] = Turns::ZERO;
            return Err(Fault::new(FaultKind::IndexMissing).on_axis(axis));
        }
        if heard != 0 && self.heard == self.sensed {
            self.heard = 0;
            self.modes = self.mount.modes(&self.drift);
            return self.limits.check(&self.modes, &self.drift);
        }
        Ok(())
    }

    /// Takes note of index pulses that came at times to which no phase belongs: their sensors are alive.
    pub fn disregard(&mut self, pulses: &[Option<IndexPulse>; N]) {
        self.before = None;
        for (since, pulse) in self.since_index.iter_mut().zip(pulses) {
            if pulse.is_some() {
                *since = Turns::ZERO;
            }
        }
    }

    /// Whether every axis that has a sensor has been heard since [`Self::reset`].
    pub const fn is_aligned(&self) -> bool {
        self.known == self.sensed
    }

    /// Forgets what was measured: the cranks may have been turned while the drives were off.
    pub fn reset(&mut self) {
        self.heard = 0;
        self.known = 0;
        self.since_index = [Turns::ZERO; N];
        self.drift = [Turns::ZERO; N];
        self.modes = Modes::default();
    }

    /// The drift of each axis, as last measured: turns, −½ to ½.
    pub const fn drift(&self) -> &[Turns; N] {
        &self.drift
    }

    /// The modes of the drifts, as last taken.
    pub const fn modes(&self) -> &Modes {
        &self.modes
    }
}

#[cfg(test)]
mod tests;
