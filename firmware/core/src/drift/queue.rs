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
//! Later updates belong to the next batch, so that every axis has its turn. If an axis has a second pulse while the first is queued
//! (noise, or more than 1/N turn a tick), the first is processed at once.

use super::tick_phase::{IndexPulse, TickPhase};
use super::{AxisSet, DriftMonitor, Sensed};
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
#[repr(C)] // as the monitor
pub(super) struct Queue {
    /// Axes with a queued pulse.
    pulsed: AxisSet,
    /// Axes with another update, an index timeout or one of an encoder, which is kept by their watch.
    other: AxisSet,
    /// Axes of the present batch that are still to be processed.
    batch: AxisSet,
    /// Axes of the present batch that were updated, and those of them that have moved far.
    updated: AxisSet,
    moved: AxisSet,
    work: Work,
    /// Pulses, of the axes that have one queued.
    pulses: PerAxis<QueuedPulse>,
}

/// Piece of work of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Work {
    /// Process the update of one axis.
    Axis,
    /// Compare the axes of a batch with each other.
    Conclude,
    /// Take the phase errors apart into modes.
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
            work: Work::Axis,
        }
    }

    fn is_empty(&self) -> bool {
        self.pulsed | self.other | self.updated == 0 && self.work == Work::Axis
    }

    /// Takes the next axis. Timeouts come first, as the machine may have to be stopped, and as their reaction depends on whether all
    /// axes are late.
    fn next(&mut self) -> Option<usize> {
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

impl DriftMonitor {
    pub(super) fn has_updates(&self) -> bool {
        !self.queue.is_empty() || self.encoders() != 0
    }

    /// Queues the pulses of a tick; returns their number.
    #[inline(always)]
    pub(super) fn queue_pulses(&mut self, sensed: &Sensed<'_>, before_is_known: bool) -> usize {
        let mut arrived: AxisSet = 0;
        for (axis, pulse) in sensed.index.iter().enumerate() {
            arrived |= AxisSet::from(pulse.is_some()) << axis;
        }
        arrived &= self.by_index;
        if arrived == 0 {
            return 0;
        }
        self.queue_arrived(arrived, sensed, before_is_known);
        arrived.count_ones() as usize
    }

    #[inline(never)]
    fn queue_arrived(&mut self, arrived: AxisSet, sensed: &Sensed<'_>, before_is_known: bool) {
        if arrived & self.queue.pulsed != 0 {
            self.make_room(arrived, sensed);
        }
        self.queue.pulsed |= arrived;
        let recent = sensed.history.recent();
        let own = recent.own();
        // Most axes made the master's turns.
        let (by_master, before_by_master) = recent.over_by_master(sensed.phase);
        let slots = self.queue.pulses.iter_mut().zip(sensed.index);
        for (axis, ((slot, pulse), &lead)) in slots.zip(sensed.lead).enumerate() {
            if let Some(pulse) = pulse
                && arrived & 1 << axis != 0
            {
                slot.pulse = *pulse;
                slot.before = None;
                let before = if own & 1 << axis == 0 {
                    slot.commanded.start = by_master.start.advanced(lead);
                    slot.commanded.turns = by_master.turns;
                    before_by_master
                } else {
                    let (commanded, before) = recent.over(axis, sensed.phase.advanced(lead));
                    slot.commanded = commanded;
                    before
                };
                if before_is_known {
                    slot.before = Some(before);
                }
            }
        }
    }

    /// Processes the pulses that are still queued of axes that have another: an axis has room for one.
    #[inline(never)]
    fn make_room(&mut self, arrived: AxisSet, sensed: &Sensed<'_>) {
        for axis in 0..MAX_AXES {
            while arrived & self.queue.pulsed & 1 << axis != 0 {
                self.process_axis(axis, sensed);
            }
        }
    }

    /// Checks axes by index without an update for a timeout, and computes the margin up to which they need no further check.
    #[inline(never)]
    pub(super) fn check_timeouts(&mut self, sensed: &Sensed<'_>) {
        let mut margin = Turns::MAX;
        let unchecked = self.by_index & !(self.queue.pulsed | self.queue.other);
        for (axis, watch) in self.axes.iter_mut().enumerate() {
            let own = 1 << axis;
            if unchecked & own == 0 {
                continue;
            }
            let commanded = sensed.over(axis);
            if watch.margin(&commanded) < 0 && watch.check_timeout(&commanded) {
                self.queue.other |= own;
            }
            margin = margin.min(watch.margin(&commanded));
        }
        self.margin = margin;
    }

    /// Processes a tick of the axes with encoders.
    #[inline(never)]
    pub(super) fn observe_encoders(&mut self, sensed: &Sensed<'_>, before_is_known: bool) {
        for (axis, watch) in self.axes.iter_mut().enumerate() {
            if self.by_encoder & 1 << axis == 0 {
                continue;
            }
            let pulse = sensed.index.get(axis).and_then(Option::as_ref);
            let count = sensed.encoder.get(axis).copied().unwrap_or_default();
            let commanded = sensed.over(axis);
            if watch.observe(pulse, count, &commanded, before_is_known, self.clock) {
                self.queue.other |= 1 << axis;
            }
        }
    }

    /// Does one piece of the pending work. On a machine with encoders, which are read in every tick, or where the
    /// settings ask for it, does all of it.
    #[inline(never)]
    pub(super) fn process_queue(&mut self, sensed: &Sensed<'_>, arrived: usize) {
        if self.is_at_once() {
            while let Some(axis) = self.queue.next() {
                self.process_axis(axis, sensed);
            }
            if self.queue.updated != 0 || self.encoders() != 0 {
                self.conclude_batch();
                self.take_modes(sensed);
                self.check_batch(sensed);
            }
            return;
        }
        match self.queue.work {
            // A timeout does not wait: the machine may have to be stopped.
            _ if self.queue.other != 0 => {
                if let Some(axis) = self.queue.next() {
                    self.process_axis(axis, sensed);
                }
            }
            // Reading the pulses of several axes takes as long as processing one.
            Work::Axis if arrived > 1 => {}
            Work::Axis => {
                if let Some(axis) = self.queue.next() {
                    self.process_axis(axis, sensed);
                }
            }
            Work::Conclude => self.conclude_batch(),
            Work::Modes => self.take_modes(sensed),
            Work::Check => self.check_batch(sensed),
        }
        let queue = &mut self.queue;
        if queue.work == Work::Axis && queue.batch | queue.other == 0 && queue.updated != 0 {
            queue.work = Work::Conclude;
        }
    }

    fn conclude_batch(&mut self) {
        let updated = core::mem::take(&mut self.queue.updated);
        let moved = core::mem::take(&mut self.queue.moved);
        self.queue.work = if self.conclude(updated, moved) {
            Work::Modes
        } else {
            self.end_batch()
        };
    }

    fn take_modes(&mut self, sensed: &Sensed<'_>) {
        if self.queue.work == Work::Modes {
            self.queue.work = if self.update_modes(sensed) {
                Work::Check
            } else {
                self.end_batch()
            };
        }
    }

    fn check_batch(&mut self, sensed: &Sensed<'_>) {
        if self.queue.work == Work::Check {
            self.check(sensed);
            self.queue.work = self.end_batch();
        }
    }

    const fn end_batch(&mut self) -> Work {
        self.evaluated = self.known;
        self.evaluated_checked = self.checked;
        Work::Axis
    }

    fn process_axis(&mut self, axis: usize, sensed: &Sensed<'_>) {
        let own = 1 << axis;
        let Some(watch) = self.axes.get_mut(axis) else {
            return;
        };
        let is_other = self.queue.other & own != 0;
        let is_updated = if is_other {
            self.queue.other &= !own;
            true
        } else {
            self.queue.pulsed &= !own;
            self.queue.batch &= !own;
            let queued = self.queue.pulses.get(axis);
            queued.is_some_and(|queued| watch.detect(queued, self.clock))
        };
        if is_updated {
            self.queue.updated |= own;
            if self.sort(axis, is_other, sensed) {
                self.queue.moved |= own;
            }
        }
        if let Some(watch) = self.axes.get(axis)
            && self.by_index & own != 0
        {
            self.margin = self.margin.min(watch.margin(&sensed.over(axis)));
        }
    }
}
