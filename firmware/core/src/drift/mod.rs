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

use crate::functions::{multiply_high, multiply_long};
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
    /// A tick in which nothing moves.
    pub const fn still(phase: Phase) -> Self {
        Self {
            start: phase,
            turns: Turns::ZERO,
        }
    }

    /// Commanded phase `cycle` cycles into a tick.
    fn at(&self, cycle: u32, clock: TickClock) -> Phase {
        // cycle / tick_cycles with 24 fraction bits; and of the turns of a tick, below ½, the upper 40: 2⁻²⁴ of a tick
        // is less than a cycle.
        let part = multiply_high(cycle << CYCLE_SPARE_BITS, clock.per_cycle).min(1 << 24);
        let turns = (self.turns.to_bits() >> 8) as u64;
        let turns = multiply_long(turns, part) as i64 >> 16;
        self.start.advanced(Turns::from_bits(turns))
    }
}

/// A tick has at most 18 bits of cycles: 250,000.
const CYCLE_SPARE_BITS: u32 = 14;

/// How long a tick is.
#[derive(Clone, Copy, Debug)]
struct TickClock {
    cycles: u32,
    /// 2⁴² / cycles.
    per_cycle: u32,
}

/// A set of axes: a bit for each.
type Axes = u8;

/// The index sensor of one axis, if it has one.
#[derive(Clone, Debug)]
struct Sensor {
    /// The phase at which it stands.
    index: Option<Turns>,
    /// Commanded turns since its last pulse.
    since: Turns,
    /// Turns commanded in the tick before the one that is over, which ended where the one that is over began.
    before: Turns,
}

impl Sensor {
    /// The drift that a pulse shows; none if it came in a tick of which nothing is known.
    #[inline(never)] // seldom, and what it needs of registers the loop over all axes would lack
    fn drift(
        &self,
        index: Turns,
        pulse: IndexPulse,
        commanded: &TickPhase,
        before_is_known: bool,
        clock: TickClock,
    ) -> Option<Turns> {
        let back = pulse.cycle.min(0).unsigned_abs();
        let at = if back == 0 {
            commanded.at(pulse.cycle.unsigned_abs(), clock)
        } else if before_is_known {
            let before = TickPhase {
                start: commanded.start.advanced(self.before.wrapping_neg()),
                turns: self.before,
            };
            before.at(clock.cycles.saturating_sub(back), clock)
        } else {
            return None;
        };
        Some(nearest(Phase::from_turns(index).since(at)))
    }
}

/// Watches the drift of `N` axes.
#[derive(Clone, Debug)]
pub struct DriftMonitor<const N: usize> {
    limits: DriftLimits,
    mount: Mount<N>,
    sensors: [Sensor; N],
    /// Axes that have a sensor.
    sensed: Axes,
    clock: TickClock,
    /// The last call of [`Self::observe`] told of the tick before the one that is over.
    before_is_known: bool,
    drift: [Turns; N],
    /// Axes heard since the modes were taken last.
    heard: Axes,
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
            sensors: index.map(|index| Sensor {
                index,
                since: Turns::ZERO,
                before: Turns::ZERO,
            }),
            sensed: (0..N)
                .filter(|&axis| index[axis].is_some())
                .fold(0, |axes, axis| axes | 1 << axis),
            clock: TickClock {
                cycles: tick_cycles,
                // Ticks have 12,500 cycles and more: 29 bits.
                per_cycle: ((1 << (24 + 32 - CYCLE_SPARE_BITS)) / u64::from(tick_cycles)) as u32,
            },
            before_is_known: false,
            drift: [Turns::ZERO; N],
            heard: 0,
            known: 0,
            modes: Modes::default(),
        }
    }

    /// Takes in the index pulses of a tick that is over, with the phases that were commanded in it.
    ///
    /// # Errors
    /// A mode past its limit, or an index pulse that stays away for over a turn.
    #[inline(never)]
    pub fn observe(
        &mut self,
        pulses: &[Option<IndexPulse>; N],
        commanded: &[&TickPhase; N],
    ) -> Result<(), Fault> {
        let limit = self.limits.index_turns;
        let mut missing = None;
        let mut heard = 0;
        let before_is_known = core::mem::replace(&mut self.before_is_known, true);
        for axis in 0..N {
            let (sensor, pulse, commanded) =
                (&mut self.sensors[axis], &pulses[axis], commanded[axis]);
            let Some(index) = sensor.index else {
                continue;
            };
            if let Some(pulse) = *pulse {
                let drift = sensor.drift(index, pulse, commanded, before_is_known, self.clock);
                if let (Some(drift), Some(slot)) = (drift, self.drift.get_mut(axis)) {
                    *slot = drift;
                    heard |= 1 << axis;
                }
                sensor.since = Turns::ZERO;
            } else {
                // The turns of this tick come on top only now: a pulse in it may wait to be confirmed.
                if sensor.since > limit {
                    missing = Some(axis);
                }
                // Bounded: beyond the limit it is a fault and begins anew, and no axis goes back by more than
                // its trim.
                sensor.since = sensor.since.wrapping_add(commanded.turns);
            }
            sensor.before = commanded.turns;
        }
        self.heard |= heard;
        self.known |= heard;
        if let Some(axis) = missing {
            if let Some(sensor) = self.sensors.get_mut(axis) {
                sensor.since = Turns::ZERO;
            }
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
        self.before_is_known = false;
        for (sensor, pulse) in self.sensors.iter_mut().zip(pulses) {
            if pulse.is_some() {
                sensor.since = Turns::ZERO;
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
        for sensor in &mut self.sensors {
            sensor.since = Turns::ZERO;
        }
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
