//! Processing of a tick: its feedback is queued, and one piece of the queued work is done.

use super::detection::modes::AxisSet;
use super::{DriftMonitor, Finding, Sensed};
use crate::units::{MAX_AXES, Turns};

impl DriftMonitor {
    /// Processes the feedback of a tick that is over. Returns the next finding to report, if there is one.
    #[inline(never)]
    pub fn observe(&mut self, sensed: &Sensed<'_>) -> Option<Finding> {
        let before_is_known = core::mem::replace(&mut self.before_is_known, true);
        self.findings.pass(sensed.speed);
        if self.encoders() != 0 {
            self.observe_encoders(sensed, before_is_known);
        }
        let arrived = self.queue_pulses(sensed, before_is_known);
        self.margin = self.margin.wrapping_sub(sensed.history.most());
        if self.margin < 0 {
            self.check_timeouts(sensed);
        }
        let has_updates = self.has_updates() && (sensed.may_process || self.is_at_once());
        if has_updates {
            self.process_queue(sensed, arrived);
        }
        self.is_busy = has_updates && !self.is_at_once();
        self.findings.next()
    }

    fn has_updates(&self) -> bool {
        !self.queue.is_empty() || self.encoders() != 0
    }

    /// Queues the pulses of a tick; returns their number.
    #[inline(always)]
    fn queue_pulses(&mut self, sensed: &Sensed<'_>, before_is_known: bool) -> usize {
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

    /// Processes queued pulses of axes for which another pulse arrived, as the queue has room for one per axis.
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
    fn check_timeouts(&mut self, sensed: &Sensed<'_>) {
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
    fn observe_encoders(&mut self, sensed: &Sensed<'_>, before_is_known: bool) {
        let share = sensed.speed.min(Turns::ONE.wrapping_sub(self.averaged));
        self.averaged = self.averaged.wrapping_add(share);
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let Some(watch) = self.axes.get_mut(axis) else {
                break;
            };
            if self.by_encoder & 1 << axis == 0 {
                continue;
            }
            let pulse = sensed.index.get(axis).and_then(Option::as_ref);
            let count = sensed.encoder.get(axis).copied().unwrap_or_default();
            let commanded = sensed.over(axis);
            if watch.observe(pulse, count, &commanded, before_is_known, self.clock) {
                self.queue.other |= 1 << axis;
            }
            if share != 0 {
                watch.average(share);
            }
            self.update(axis);
        }
    }

    /// Does one piece of the pending work. On a machine with encoders, which are read in every tick, or where the
    /// settings ask for it, does all of it.
    #[inline(never)]
    fn process_queue(&mut self, sensed: &Sensed<'_>, arrived: usize) {
        if self.is_at_once() {
            while let Some(axis) = self.queue.next() {
                self.process_axis(axis, sensed);
            }
            if self.queue.updated != 0 || self.encoders() != 0 {
                self.evaluate(sensed);
                while !self.queue.is_evaluated() {
                    self.evaluate(sensed);
                }
            }
        } else if self.queue.is_processed() {
            self.evaluate(sensed);
        } else if self.queue.other != 0 || arrived <= 1 {
            // A timeout is processed at once, as the machine may have to be stopped. A pulse waits if several arrived: reading them took
            // the time of processing one.
            if let Some(axis) = self.queue.next() {
                self.process_axis(axis, sensed);
            }
        }
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
            self.update(axis);
        }
        if let Some(watch) = self.axes.get(axis)
            && self.by_index & own != 0
        {
            self.margin = self.margin.min(watch.margin(&sensed.over(axis)));
        }
    }
}
