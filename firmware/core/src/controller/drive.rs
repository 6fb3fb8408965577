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
        let corrections = if moving && trimming {
            self.correction.advance().copied()
        } else {
            None
        };
        let own = self.moved_by_themselves(moving, corrections.as_ref());
        if self.own != Some(own) {
            self.group_axes(own);
        }
        if corrections.is_some() {
            self.output.telemetry.correction = *self.correction.now();
        }
        let (master, by_themselves) = if moving {
            (self.motion.speed, own | self.geared)
        } else {
            (Turns::ZERO, 0)
        };
        self.history.plan(master);
        let Output {
            plans,
            sharing,
            telemetry,
            ..
        } = &mut self.output;
        let mut steps_of: PerAxis<i32> = [0; MAX_AXES];
        let told = telemetry.axis_phase.iter_mut().zip(&mut telemetry.steps);
        for (axis, (channel, (told_phase, told_steps))) in
            self.channels.iter_mut().zip(told).enumerate()
        {
            let mut turns = master;
            if by_themselves & 1 << axis != 0 {
                let correction = corrections.as_ref().and_then(|all| all.get(axis)).copied();
                turns = channel.axis.advance(master, correction.unwrap_or_default());
                self.history.plan_own(axis, turns);
            } else {
                channel.axis.follow(master);
            }
            let first = sharing.first(axis);
            if first == axis {
                if let (Some(runs), Some(steps)) = (plans.get_mut(axis), steps_of.get_mut(axis)) {
                    *steps = channel.plan(turns, &mut self.pace, runs);
                }
            } else {
                channel
                    .planner
                    .follow(steps_of.get(first).copied().unwrap_or(0));
            }
            *told_phase = channel.axis.phase();
            *told_steps = channel.planner.steps();
        }
        if self.has_servos {
            self.set_points();
        }
    }

    /// Axes that trims or corrections move in this tick.
    #[inline(always)]
    fn moved_by_themselves(
        &mut self,
        moving: bool,
        corrections: Option<&PerAxis<Turns>>,
    ) -> AxisSet {
        if self.trimming == 0 && corrections.is_none() || !moving {
            return 0;
        }
        let mut own = 0;
        for (axis, channel) in self.channels.iter().enumerate() {
            let is_trimming = channel.axis.trim().is_moving();
            let correction = corrections.and_then(|all| all.get(axis)).copied();
            own |= AxisSet::from(is_trimming || correction.is_some_and(|turns| turns != 0)) << axis;
            if !is_trimming {
                self.trimming &= !(1 << axis);
            }
        }
        own
    }

    /// Finds out which axes share a plan, now that other axes move by themselves.
    #[cold]
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
                channel.planner.part(*followed.planner.place());
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
        let setpoints = &mut self.output.setpoints;
        let channels = self.channels.iter().zip(setpoints);
        for (axis, (channel, setpoint)) in channels.enumerate() {
            if let Some(forward) = &channel.feed_forward {
                let coupled = self.coupling.as_ref().map(|coupling| coupling.of(axis));
                let (position, speed) = coupled.unwrap_or_default();
                *setpoint = channel.setpoint(
                    forward,
                    self.history.planned(axis),
                    self.motion.acceleration,
                    datum,
                );
                setpoint.position = setpoint.position.advanced(position);
                setpoint.velocity = setpoint.velocity.wrapping_add(speed);
                if channel.reversed {
                    *setpoint = setpoint.reversed();
                }
            }
        }
    }
}
