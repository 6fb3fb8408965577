//! From the master's turns to each axis's phase, pulses and setpoints.
//!
//! Axes at the same place within a step that make the same turns have identical edges. The first of them is planned, and the others
//! share its plan ([`Sharing`]). An axis makes *turns of its own* if it has a ratio, and while a trim or a correction moves it. All
//! other axes make the master's turns, so that equal places stay equal. Groups can change only when the set of axes with turns of
//! their own does; the places are then compared anew.

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
        let trimming = matches!(self.supervisor.state(), State::Homing | State::Run);
        // A machine that stops is not to be moved by its trims, nor one that is parked.
        let correcting = moving && trimming && self.correction.advance();
        let own = if moving && (correcting || self.trimming != 0) {
            self.axes_with_own_turns(correcting)
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
        let with_own_turns = own | self.geared;
        if moving && with_own_turns != 0 {
            self.make_own_turns(with_own_turns, correcting, master);
        }
        self.plan_all();
        if self.has_servos {
            self.set_points();
        }
    }

    /// Plans the pulses: one plan for all axes that share it.
    #[inline(never)] // Within a function with more variables, the loop would lack registers.
    fn plan_all(&mut self) {
        let sharing = self.output.sharing;
        let mut steps_of: PerAxis<i32> = [0; MAX_AXES];
        let plans = self.output.plans.iter_mut().zip(&mut steps_of);
        for (axis, (channel, (runs, steps))) in self.channels.iter_mut().zip(plans).enumerate() {
            if sharing.first(axis) == axis {
                *steps = channel.plan(self.history.planned(axis), &mut self.step_rate, runs);
            }
        }
        for (axis, steps) in self.output.telemetry.steps.iter_mut().enumerate() {
            // Axes that are not there make no steps.
            if let Some(&made) = steps_of.get(sharing.first(axis)) {
                *steps += i64::from(made);
            }
        }
    }

    /// Axes that a trim or a correction moves in this tick.
    #[inline(never)]
    fn axes_with_own_turns(&mut self, correcting: bool) -> AxisSet {
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

    /// Moves the axes with turns of their own.
    #[inline(never)]
    fn make_own_turns(&mut self, axes: AxisSet, correcting: bool, master: Turns) {
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
                // The phase contains the master's turns already.
                *phase = phase.advanced(turns.wrapping_sub(master));
            }
        }
    }

    /// Groups the axes that share a plan, for a new set of axes with turns of their own.
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
            // The place of an axis that shared a plan was kept by the first axis of its group.
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
        let home_offset = self.homing.home_offset();
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
                *setpoint = channel.setpoint(
                    forward,
                    phase,
                    velocity,
                    self.motion.acceleration,
                    home_offset,
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
