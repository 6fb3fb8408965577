//! From the master's turns to each axis's phase, pulses and setpoints.
//!
//! Axes that are in the same place of their step and make the same turns have identical edges. The first of them plans, and the
//! others only count ([`Sharing`]). An axis makes *turns of its own* if it has a ratio, or while a trim or correction moves it; the
//! rest make the master's. Who shares with whom can change only when the set of axes that move by themselves does: then their places
//! are compared.

use super::Controller;
use crate::drift::AxisSet;
use crate::pulse::Sharing;
use crate::signals::Output;
use crate::supervisor::State;
use crate::units::{MAX_AXES, PerAxis, Turns};

impl Controller {
    /// Moves the axes and makes their pulses and setpoints. While the machine is to stand, trims stand
    /// too: drives that are off would not follow them.
    #[inline(never)]
    pub(super) fn drive(&mut self, moving: bool) {
        let trimming = matches!(self.supervisor.state(), State::Align | State::Run);
        // A machine that stops is not to be moved by its trims, nor one that is parked.
        let correcting = moving && trimming && self.correction.advance();
        let own = if moving && (correcting || self.trimming != 0) {
            self.moved_by_themselves(correcting)
        } else {
            0
        };
        if self.own != Some(own) {
            self.group_axes(own);
        }
        let master = if moving {
            self.motion.speed
        } else {
            Turns::ZERO
        };
        self.history.plan(master);
        let count = self.channels.len();
        for phase in self.output.telemetry.axis_phase.iter_mut().take(count) {
            *phase = phase.advanced(master);
        }
        let by_themselves = own | self.geared;
        if moving && by_themselves != 0 {
            self.move_by_themselves(by_themselves, correcting, master);
        }
        self.plan_all();
        if self.has_servos {
            self.set_points();
        }
    }

    /// Plans the pulses: one plan for all axes that share it.
    #[inline(never)] // of its own, as a loop within a function that has more to keep lacks registers
    fn plan_all(&mut self) {
        let sharing = self.output.sharing;
        let mut steps_of: PerAxis<i32> = [0; MAX_AXES];
        let plans = self.output.plans.iter_mut().zip(&mut steps_of);
        for (axis, (channel, (runs, steps))) in self.channels.iter_mut().zip(plans).enumerate() {
            if sharing.first(axis) == axis {
                *steps = channel.plan(self.history.planned(axis), &mut self.pace, runs);
            }
        }
        for (axis, steps) in self.output.telemetry.steps.iter_mut().enumerate() {
            // Axes that are not there make none.
            if let Some(&made) = steps_of.get(sharing.first(axis)) {
                *steps += i64::from(made);
            }
        }
    }

    /// Axes that trims or corrections move in this tick.
    #[inline(never)]
    fn moved_by_themselves(&mut self, correcting: bool) -> AxisSet {
        let (mut own, mut axis) = (0, 1);
        for (channel, change) in self.channels.iter().zip(self.correction.change()) {
            if channel.axis.trim().is_moving() {
                own |= axis;
            } else {
                self.trimming &= !axis;
            }
            if correcting && *change != 0 {
                own |= axis;
            }
            axis <<= 1;
        }
        own
    }

    /// Moves axes that make other turns than the master.
    #[inline(never)]
    fn move_by_themselves(&mut self, axes: AxisSet, correcting: bool, master: Turns) {
        let telemetry = &mut self.output.telemetry;
        if correcting {
            telemetry.correction = *self.correction.now();
        }
        let changes = self.correction.change().iter();
        let all = self
            .channels
            .iter_mut()
            .zip(changes.zip(&mut telemetry.axis_phase));
        for (axis, (channel, (change, phase))) in all.enumerate() {
            if axes & 1 << axis != 0 {
                let correction = if correcting { *change } else { Turns::ZERO };
                let turns = channel.axis.advance(master, correction);
                self.history.plan_own(axis, turns);
                // The master's turns are in it already.
                *phase = phase.advanced(turns.wrapping_sub(master));
            }
        }
    }

    /// Finds out which axes share a plan, now that other axes move by themselves.
    #[inline(never)]
    fn group_axes(&mut self, own: AxisSet) {
        let before = self.output.sharing;
        let mut sharing = Sharing::NONE;
        self.geared = 0;
        for axis in 0..self.channels.len().min(MAX_AXES) {
            let (earlier, rest) = self.channels.split_at_mut(axis);
            let Some(channel) = rest.first_mut() else {
                break;
            };
            // One that followed has not kept its place.
            if let Some(followed) = earlier.get(before.first(axis)) {
                channel.planner.continue_from(*followed.planner.place());
            }
            self.geared |= AxisSet::from(!channel.axis.gear().is_direct()) << axis;
            if own & 1 << axis != 0 || !channel.may_share() {
                continue;
            }
            let like = |(first, other): &(usize, &super::Channel)| {
                sharing.first(*first) == *first
                    && own & 1 << first == 0
                    && other.may_share()
                    && other.planner.place() == channel.planner.place()
            };
            if let Some((first, _)) = earlier.iter().enumerate().find(like) {
                sharing = sharing.with(axis, first);
            }
        }
        self.output.sharing = sharing;
        self.own = Some(own);
    }

    /// Makes the setpoints of servo axes.
    #[inline(never)]
    fn set_points(&mut self) {
        let datum = self.align.datum();
        let Output {
            setpoints,
            telemetry,
            ..
        } = &mut self.output;
        let all = self
            .channels
            .iter()
            .zip(setpoints)
            .zip(&telemetry.axis_phase);
        for (axis, ((channel, setpoint), &phase)) in all.enumerate() {
            if let Some(forward) = &channel.feed_forward {
                let coupled = self.coupling.as_ref().map(|coupling| coupling.of(axis));
                let (position, speed) = coupled.unwrap_or_default();
                let velocity = self.history.planned(axis);
                *setpoint =
                    channel.setpoint(forward, phase, velocity, self.motion.acceleration, datum);
                setpoint.position = setpoint.position.advanced(position);
                setpoint.velocity = setpoint.velocity.wrapping_add(speed);
                if channel.reversed {
                    *setpoint = setpoint.reversed();
                }
            }
        }
    }
}
