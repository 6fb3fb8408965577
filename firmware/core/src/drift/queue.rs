//! Index news, one axis at a time.
//!
//! Where all sensors stand at one crank angle the pulses of all axes come in one tick, and what a pulse takes is much next to the rest
//! of a tick. So pulses wait with the phases that were commanded when they came, and one is measured in each tick.
//!
//! **Delay.** Of n axes whose news come in one tick the last is sorted n − 1 ticks later, so that what is done about it comes up to
//! N − 1 ticks later on a machine of N axes. News that come alone are sorted at once. What is measured is the same: each pulse
//! against the phase of its own tick.
//!
//! News that wait together are a *batch*: what they say together is concluded when its last is sorted, and what comes meanwhile
//! belongs to the next. So none waits for longer than all others of its batch take. A second pulse of an axis whose first still waits
//! (noise, or over 1/N turn a tick) has that one measured at once.

use super::tick_phase::{IndexPulse, TickPhase};
use super::{AxisSet, DriftMonitor, Sensed};
use crate::units::{MAX_AXES, PerAxis, Turns};

/// An index pulse, with what was commanded when it came.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub pulse: IndexPulse,
    pub commanded: TickPhase,
    /// Turns in the tick before that; none if they are not known.
    pub before: Option<Turns>,
}

/// News that wait to be sorted.
#[derive(Clone, Debug)]
pub(super) struct Queue {
    pulses: PerAxis<Option<Waiting>>,
    /// Axes of which a pulse waits; that have other news, which lie with their watch.
    waiting: AxisSet,
    other: AxisSet,
    /// Axes of the present batch that are still to be sorted; that had news in it; of these, that are far from where they were.
    batch: AxisSet,
    news: AxisSet,
    moved: AxisSet,
}

impl Queue {
    pub(super) const fn new() -> Self {
        Self {
            pulses: [None; MAX_AXES],
            waiting: 0,
            other: 0,
            batch: 0,
            news: 0,
            moved: 0,
        }
    }

    const fn is_empty(&self) -> bool {
        self.waiting | self.other == 0
    }

    /// The axis whose turn it is. Silence goes first: whether all axes are silent is asked before a pulse of one is measured.
    fn next(&mut self) -> Option<usize> {
        if self.batch == 0 {
            self.batch = self.waiting | self.other;
        }
        let first = match self.batch & self.other {
            0 => self.batch,
            other => other,
        };
        let axis = (0..MAX_AXES).find(|axis| first & 1 << axis != 0)?;
        self.batch &= !(1 << axis);
        Some(axis)
    }
}

impl DriftMonitor {
    /// Queues the pulses of a tick.
    #[inline(always)]
    pub(super) fn queue_pulses(&mut self, sensed: &Sensed<'_>, before_is_known: bool) {
        for (axis, pulse) in sensed.index.iter().enumerate() {
            if let Some(pulse) = pulse
                && self.by_index & 1 << axis != 0
            {
                self.queue_pulse(axis, *pulse, sensed, before_is_known);
            }
        }
    }

    #[inline(never)]
    fn queue_pulse(
        &mut self,
        axis: usize,
        pulse: IndexPulse,
        sensed: &Sensed<'_>,
        before_is_known: bool,
    ) {
        if self.queue.waiting & 1 << axis != 0 {
            self.sort_one(axis, sensed);
        }
        let waiting = Waiting {
            pulse,
            commanded: sensed.over(axis),
            before: before_is_known.then(|| sensed.history.before(axis)),
        };
        if let Some(slot) = self.queue.pulses.get_mut(axis) {
            *slot = Some(waiting);
            self.queue.waiting |= 1 << axis;
        }
    }

    /// Looks at axes by index from which no pulse waits: at whether theirs are due.
    ///
    /// Until the axes have come so much further that one of them may be due, they need not be looked at again.
    #[inline(never)]
    pub(super) fn seek_silence(&mut self, sensed: &Sensed<'_>) {
        let mut margin = Turns::MAX;
        let done = self.queue.waiting | self.queue.other;
        for (axis, watch) in self.axes.iter_mut().enumerate() {
            let own = 1 << axis;
            if self.by_index & !done & own == 0 {
                continue;
            }
            let commanded = sensed.over(axis);
            if watch.margin(&commanded) < 0 && watch.look(&commanded) {
                self.queue.other |= own;
            }
            margin = margin.min(watch.margin(&commanded));
        }
        self.margin = margin;
    }

    /// Takes in a tick of axes with encoders, which are looked at all the time.
    #[inline(never)]
    pub(super) fn observe_encoders(&mut self, sensed: &Sensed<'_>, before_is_known: bool) {
        for (axis, watch) in self.axes.iter_mut().enumerate() {
            if self.by_encoder & 1 << axis == 0 {
                continue;
            }
            let pulse = sensed.index.get(axis).and_then(Option::as_ref);
            let count = sensed.encoder.get(axis).copied().unwrap_or_default();
            if watch.observe(
                pulse,
                count,
                &sensed.over(axis),
                before_is_known,
                self.clock,
            ) {
                self.queue.other |= 1 << axis;
            }
        }
    }

    /// Sorts the news of one axis, and concludes what a batch says when it was the last. Encoders are looked at in every tick, so
    /// that a machine with encoders has all its news sorted at once.
    #[inline(never)]
    pub(super) fn sort_queued(&mut self, sensed: &Sensed<'_>) {
        while let Some(axis) = self.queue.next() {
            self.sort_one(axis, sensed);
            if self.by_encoder == 0 || self.queue.batch == 0 {
                break;
            }
        }
        if self.queue.batch == 0 {
            let news = core::mem::take(&mut self.queue.news);
            let moved = core::mem::take(&mut self.queue.moved);
            if news != 0 || self.by_encoder != 0 {
                self.conclude(news, moved, sensed);
            }
        }
    }

    pub(super) const fn has_news(&self) -> bool {
        !self.queue.is_empty() || self.by_encoder != 0
    }

    fn sort_one(&mut self, axis: usize, sensed: &Sensed<'_>) {
        let own = 1 << axis;
        let Some(watch) = self.axes.get_mut(axis) else {
            return;
        };
        let is_other = self.queue.other & own != 0;
        let waiting = if is_other {
            self.queue.other &= !own;
            None
        } else {
            self.queue.waiting &= !own;
            self.queue.pulses.get_mut(axis).and_then(Option::take)
        };
        let has_news = waiting.is_none_or(|waiting| watch.hear(&waiting, self.clock));
        if has_news {
            self.queue.news |= own;
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
