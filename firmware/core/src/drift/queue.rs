//! Queue of index updates: one piece of work in each tick.
//!
//! With all sensors at one crank angle, the pulses of all axes come in one tick, and each costs a large part of a tick. A pulse is
//! therefore queued with the phase that was commanded when it came.
//!
//! Updates that are queued together are a *batch*. Each tick processes one axis. When the last of a batch has been processed, the
//! next tick compares the axes. The tick after that separates their phase errors into modes, and one more checks the limits. The
//! measured phase errors are those of the pulses' own ticks.
//!
//! **Delay.** A single update is checked three ticks after its own. If n axes have updates in one tick, that is n + 3 ticks after it.
//! Later updates belong to the next batch, so that every axis has its turn. They may wait for that by n + 3 ticks more. If an axis has a second pulse while the first is queued
//! (noise, or more than 1/N turn a tick), the first is processed at once.

use super::detection::modes::AxisSet;
use super::sensing::tick_phase::{IndexPulse, TickPhase};
use crate::units::{MAX_AXES, PerAxis, Phase, Turns};

/// An index pulse, and what was commanded when it came.
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
}

/// Updates that are to be processed.
#[derive(Clone, Debug)]
#[repr(C)] // as in `DriftMonitor`
pub(super) struct Queue {
    /// Axes with a queued pulse.
    pub(super) pulsed: AxisSet,
    /// Axes with another update: an index timeout, or one of an encoder. Their `AxisWatch` holds it.
    pub(super) other: AxisSet,
    /// Axes of the present batch that are still to be processed.
    pub(super) batch: AxisSet,
    /// Axes of the present batch that were updated, and those of them that have moved far.
    pub(super) updated: AxisSet,
    pub(super) moved: AxisSet,
    pub(super) evaluation: Evaluation,
    /// Pulses, of the axes that have one queued.
    pub(super) pulses: PerAxis<QueuedPulse>,
}

/// Next step in the evaluation of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Evaluation {
    /// Compare the axes with each other, once all have been processed.
    Compare,
    /// Separate the phase errors into modes.
    Modes,
    /// Check the limits.
    Check,
}

impl Queue {
    pub(super) const fn new() -> Self {
        Self {
            pulses: [QueuedPulse::NONE; MAX_AXES],
            pulsed: 0,
            other: 0,
            batch: 0,
            updated: 0,
            moved: 0,
            evaluation: Evaluation::Compare,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pulsed | self.other == 0 && self.is_evaluated()
    }

    /// True if all updates that were processed have been evaluated.
    pub(super) fn is_evaluated(&self) -> bool {
        self.updated == 0 && self.evaluation == Evaluation::Compare
    }

    /// True if the updates of a batch have been processed, and are to be evaluated.
    pub(super) fn is_processed(&self) -> bool {
        self.batch | self.other == 0 && !self.is_evaluated()
    }

    /// Returns the next axis to process. Timeouts come first, for two reasons: the machine may have to be stopped, and the reaction
    /// depends on whether all axes are late.
    pub(super) fn next(&mut self) -> Option<usize> {
        if self.batch == 0 {
            self.batch = self.pulsed;
        }
        let first = match self.other {
            0 => self.batch,
            other => other,
        };
        let axis = (0..MAX_AXES).find(|axis| first & 1 << axis != 0)?;
        Some(axis)
    }
}
