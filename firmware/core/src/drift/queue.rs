//! Queue of index pulses: one piece of work in each tick.
//!
//! With all sensors at one crank angle, the pulses of all axes come in one tick, and each costs a large part of a tick. A pulse is
//! therefore queued with the phase that was commanded when it came. The measured phase errors are those of the pulses' own ticks.
//!
//! Each tick processes one pulse. Pulses that come meanwhile join the *batch*, up to one of each axis. When none is left, the next tick
//! computes the modes and checks the limits. If the batch ended a round, one more tick compares the axes with each other.
//!
//! **Delay.** A single pulse is processed in the tick that reads it, and checked in the next, or in the one after at the end of a round. If
//! those of more than half of the axes arrive, that tick processes none. `docs/detection.md` has the sum. If an axis has a second pulse
//! while the first is queued (noise, or more than 1/(N + 2) turn a tick), the first is processed at once.

use super::detection::modes::AxisSet;
use super::sensing::history::Recent;
use super::sensing::tick_phase::{IndexPulse, TickPhase};
use crate::units::{MAX_AXES, PerAxis, Phase, Turns};

/// An index pulse, and the phase that was commanded when it arrived.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedPulse {
    pub pulse: IndexPulse,
    pub commanded: TickPhase,
    /// Turns in the tick before; none if they are not known.
    pub before: Option<Turns>,
}

impl QueuedPulse {
    const NONE: Self = Self {
        pulse: IndexPulse { cycle: 0 },
        commanded: TickPhase::still(Phase::ZERO),
        before: None,
    };

    /// Replaces the commands by those of an axis that did not make the master's turns. `phase` is its commanded phase at the end of the tick
    /// that was planned last.
    #[inline(never)] // Few axes do, and the master's turns then stay in registers.
    pub(super) fn command_own(
        &mut self,
        axis: usize,
        recent: Recent<'_>,
        phase: Phase,
        before_is_known: bool,
    ) {
        let (commanded, before) = recent.over(axis, phase);
        self.commanded = commanded;
        self.before = before_is_known.then_some(before);
    }
}

/// Pulses that are to be processed, and the axes whose update is to be evaluated.
#[derive(Clone, Debug)]
#[repr(C)] // as in `DriftMonitor`
pub(super) struct Queue {
    /// Axes with a queued pulse.
    pub(super) pulsed: AxisSet,
    /// Axes that were updated since the last evaluation.
    pub(super) updated: AxisSet,
    /// Queued pulse of each axis; valid only for axes that have one.
    pub(super) pulses: PerAxis<QueuedPulse>,
}

impl Queue {
    pub(super) const fn new() -> Self {
        Self {
            pulses: [QueuedPulse::NONE; MAX_AXES],
            pulsed: 0,
            updated: 0,
        }
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.pulsed | self.updated == 0
    }

    /// Axis whose pulse is processed next; none if the batch is complete.
    pub(super) fn next(&self) -> Option<usize> {
        let waiting = self.pulsed & !self.updated;
        (0..MAX_AXES).find(|axis| waiting & 1 << axis != 0)
    }
}
