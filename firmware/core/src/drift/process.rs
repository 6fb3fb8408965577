//! Processing of a tick: its feedback is queued, and one piece of the queued work is done.

use super::axis_watch::AxisWatch;
use super::detection::modes::AxisSet;
use super::sensing::encoder_watch::Read;
use super::sensing::index_watch::Detection;
use super::sensing::tick_phase::{IndexPulses, TickPhase};
use super::{DriftMonitor, Finding, Sensed};
use crate::units::{MAX_AXES, Turns};

impl DriftMonitor {
    /// Processes the feedback of a tick that is over. Returns the next finding to report, if there is one.
    #[inline(never)]
    pub fn observe(&mut self, sensed: &Sensed<'_>) -> Option<Finding> {
        let before_is_known = core::mem::replace(&mut self.before_is_known, true);
        self.findings.pass(sensed.speed);
        if self.encoders() != 0 {
            self.observe_encoders(sensed);
        }
        let begun = self.queue.updated;
        let arrived = self.pulsed_by_index(sensed.index);
        if arrived != 0 {
            self.queue_arrived(arrived, sensed, before_is_known);
        }
        self.margin = self.margin.wrapping_sub(sensed.history.most());
        if self.margin < 0 {
            self.check_timeouts(sensed);
        }
        self.is_busy = !self.is_at_once() && (!self.queue.is_empty() || self.is_round_over());
        if self.is_at_once() {
            self.process_all(sensed);
        } else if self.is_busy && sensed.may_process {
            self.process_one(sensed, arrived, begun);
        }
        self.findings.next()
    }

    /// Axes without an encoder that have a pulse.
    #[inline(always)]
    pub const fn pulsed_by_index(&self, index: &IndexPulses) -> AxisSet {
        index.axes() & self.by_index
    }

    #[inline(never)]
    fn queue_arrived(&mut self, arrived: AxisSet, sensed: &Sensed<'_>, before_is_known: bool) {
        if arrived & self.queue.pulsed != 0 {
            self.make_room(arrived, sensed);
        }
        self.queue.pulsed |= arrived;
        let recent = sensed.history.recent();
        let own = recent.own();
        // Most axes make the master's turns.
        let (by_master, before_by_master) = recent.over_by_master(sensed.phase);
        let before_by_master = before_is_known.then_some(before_by_master);
        for (axis, (slot, &lead)) in self.queue.pulses.iter_mut().zip(sensed.lead).enumerate() {
            let (Some(pulse), true) = (sensed.index.of(axis), arrived & 1 << axis != 0) else {
                continue;
            };
            slot.pulse = pulse;
            slot.commanded.start = by_master.start.advanced(lead);
            slot.commanded.turns = by_master.turns;
            slot.before = before_by_master;
            if own & 1 << axis != 0 {
                let phase = sensed.phase.advanced(lead);
                slot.command_own(axis, recent, phase, before_is_known);
            }
        }
    }

    /// Processes queued pulses of axes for which another pulse arrived, as the queue has room for one per axis.
    #[inline(never)]
    fn make_room(&mut self, arrived: AxisSet, sensed: &Sensed<'_>) {
        for axis in 0..MAX_AXES {
            while arrived & self.queue.pulsed & 1 << axis != 0 {
                self.process_pulse(axis, sensed);
            }
        }
    }

    /// Checks axes by index without a pulse for a timeout, and computes the margin up to which they need no further check. All that time
    /// out in one tick are processed in it, so that cranks that moved alike are compared with each other.
    #[inline(never)]
    fn check_timeouts(&mut self, sensed: &Sensed<'_>) {
        let mut margin = Turns::MAX;
        let without_pulse = self.by_index & !self.queue.pulsed;
        let mut patience = None;
        for axis in 0..self.axes.len().min(MAX_AXES) {
            if without_pulse & 1 << axis == 0 {
                continue;
            }
            let commanded = sensed.over(axis);
            let left = |watch: &AxisWatch| watch.index.margin(&commanded);
            let mut own = self.axes.get(axis).map_or(Turns::MAX, left);
            if own < 0 {
                // All axes are checked before one of them is processed.
                let patience = *patience.get_or_insert_with(|| self.patience(sensed));
                let detection = match self.axes.get_mut(axis) {
                    Some(watch) => watch.index.check_timeout(
                        &watch.traits,
                        &commanded,
                        commanded.turns,
                        self.is_homing,
                    ),
                    None => Detection::Nothing,
                };
                if !matches!(detection, Detection::Nothing | Detection::Undetected) {
                    self.take_in(axis, detection, Read::Nothing, patience, sensed);
                }
                own = self.axes.get(axis).map_or(Turns::MAX, left);
            }
            margin = margin.min(own);
        }
        self.margin = margin;
    }

    /// Turns by which a pulse may be late, if all axes are late together.
    #[inline(never)]
    fn patience(&self, sensed: &Sensed<'_>) -> Option<Turns> {
        let mut axes = self.axes.iter().zip(&self.queue.pulses).enumerate();
        let all_late = axes.all(|(axis, (watch, queued))| {
            let commanded = if self.queue.pulsed & 1 << axis == 0 {
                sensed.over(axis)
            } else {
                // A queued pulse may have been late when it arrived.
                TickPhase::ending_at(queued.commanded.start, queued.commanded.turns)
            };
            watch.is_late(&commanded)
        });
        all_late.then_some(self.limits.common)
    }

    /// Processes a tick of the axes with encoders.
    #[inline(never)]
    fn observe_encoders(&mut self, sensed: &Sensed<'_>) {
        let share = sensed.speed.min(Turns::ONE.wrapping_sub(self.averaged));
        self.averaged = self.averaged.wrapping_add(share);
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let Some(watch) = self.axes.get_mut(axis) else {
                break;
            };
            if self.by_encoder & 1 << axis == 0 {
                continue;
            }
            let pulse = sensed.index.of(axis);
            let count = sensed.encoder.get(axis).copied().unwrap_or_default();
            let commanded = sensed.over(axis);
            let (detection, read) =
                watch.observe(pulse, count, &commanded, self.is_homing, self.clock);
            if share != 0
                && let Some(encoder) = &mut watch.encoder
            {
                encoder.average(share);
            }
            if detection != Detection::Nothing || read != Read::Nothing {
                self.take_in(axis, detection, read, None, sensed);
            } else {
                self.update(axis);
            }
        }
    }

    /// Does one piece of the pending work. The axes in `begun` were updated before this tick.
    #[inline(never)]
    fn process_one(&mut self, sensed: &Sensed<'_>, arrived: AxisSet, begun: AxisSet) {
        if self.queue.updated == 0 && self.is_round_over() {
            self.conclude_round(sensed);
        } else if let Some(axis) = self.queue.next() {
            // Reading more pulses takes as long as processing one. Only one tick of a batch can have more than half of the pulses.
            if 2 * arrived.count_ones() <= self.by_index.count_ones().max(2) {
                self.process_pulse(axis, sensed);
            }
        } else if begun != 0 {
            self.evaluate(sensed);
            // Otherwise, pulses that arrive faster than they are processed would delay the end of the round without limit.
            if self.queue.pulsed != 0 && self.is_round_over() {
                self.conclude_round(sensed);
            }
        }
    }

    /// Does all pending work: on a machine with encoders, which are read in every tick, or if the settings require it.
    #[inline(never)]
    fn process_all(&mut self, sensed: &Sensed<'_>) {
        while let Some(axis) = self.queue.next() {
            self.process_pulse(axis, sensed);
        }
        if self.queue.updated != 0 || self.encoders() != 0 {
            self.evaluate(sensed);
        }
        if self.is_round_over() {
            self.conclude_round(sensed);
        }
    }

    /// Processes the queued pulse of an axis by index.
    fn process_pulse(&mut self, axis: usize, sensed: &Sensed<'_>) {
        let slots = self.axes.get_mut(axis).zip(self.queue.pulses.get(axis));
        let Some((watch, queued)) = slots else {
            return;
        };
        self.queue.pulsed &= !(1 << axis);
        let (tick, index) = (&queued.commanded, &mut watch.index);
        let detection = index.detect(
            &watch.traits,
            queued.pulse,
            tick,
            tick.turns,
            queued.before,
            self.clock,
        );
        self.margin = self.margin.min(index.margin(&sensed.over(axis)));
        if detection != Detection::Nothing {
            self.take_in(axis, detection, Read::Nothing, None, sensed);
        }
    }
}
