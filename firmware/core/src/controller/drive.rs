//! Conversion of the master's turns to the phase, the pulses and the setpoints of each axis.
//!
//! Axes with equal followers at the same place within a step have identical edges. One of them is planned, and the others share its
//! plan ([`Sharing`](crate::pulse::Sharing)). An axis leaves its group while its phase offset moves by a fraction of a step. Offsets
//! are whole steps, so it joins the same group again.

use super::Controller;
use super::channel::Channel;
use crate::axes::Follower;
use crate::commanded::TickTurns;
use crate::phase_offset::OffsetMotion;
use crate::signals::Output;
use crate::supervisor::State;
use crate::units::{AxisSet, MAX_AXES, Turns};

/// Command of one tick to all axes.
struct TickCommand {
    /// Turns of each axis, with its phase offset.
    turns: TickTurns,
    /// Motion of the axis that its phase offset moves, and the turns that it makes by its follower alone.
    offset: Option<(OffsetMotion, Turns)>,
}

impl TickCommand {
    /// Turns and half-steps from which the planner makes the pulses of an axis. A phase offset is a whole number of half-steps; its turns
    /// are rounded.
    #[inline(always)]
    fn pulses(&self, axis: usize) -> (Turns, i64) {
        match &self.offset {
            Some((offset, followed)) if offset.axis == axis => (*followed, offset.half_steps),
            _ => (self.turns.of(axis), 0),
        }
    }
}

impl Controller {
    /// Moves the axes with the master's turns of a tick, and makes their pulses and setpoints.
    #[inline(never)]
    pub(super) fn drive(&mut self, moving: bool) {
        let offset = self.move_offset(moving);
        let master = if moving {
            self.state.motion.speed
        } else {
            Turns::ZERO
        };
        let command = self.command(master, offset);
        self.plan_all(&command);
        if cfg!(feature = "servo") && self.has_servos {
            self.set_points(&command.turns);
        }
        self.state.history.push(&command.turns);
    }

    /// Moves a phase offset. Offsets do not move while the machine is at rest, stops or is parked.
    fn move_offset(&mut self, moving: bool) -> Option<OffsetMotion> {
        let offsets_move = moving && matches!(self.supervisor.state(), State::Homing | State::Run);
        let moved = if offsets_move {
            self.offsets.advance(self.has_time())
        } else {
            None
        };
        let apart = moved.map(|moved| moved.axis).or(self.offsets.displaced());
        if self.state.apart != apart {
            self.regroup(apart);
        }
        if moved.is_some() {
            self.output.telemetry.correction = *self.offsets.now();
        }
        moved
    }

    /// Commands a tick: the turns of all axes, by their followers and with the phase offset.
    #[inline(always)] // A returned value of this size would be copied.
    fn command(&mut self, master: Turns, offset: Option<OffsetMotion>) -> TickCommand {
        let mut command = TickCommand {
            turns: TickTurns::by_master(master),
            offset: None,
        };
        let turns = &mut command.turns;
        if master != 0 && self.followers != 0 {
            self.advance_followers(master, turns);
        }
        if let Some(offset) = offset {
            let followed = turns.of(offset.axis);
            turns.set(offset.axis, followed.wrapping_add(offset.turns));
            command.offset = Some((offset, followed));
        }
        if turns.own() != 0 {
            self.advance_leads(master, turns);
        }
        command
    }

    /// Moves the axes that do not make the master's own turns. Axes that share a plan share its follower.
    #[inline(never)]
    fn advance_followers(&mut self, master: Turns, turns: &mut TickTurns) {
        let sharing = self.output.telemetry.sharing;
        let follows = |axis: usize| self.followers & 1 << axis != 0;
        for (axis, channel) in self.channels.iter_mut().enumerate() {
            if follows(axis) && sharing.first(axis) == axis {
                turns.set(axis, channel.follower.advance(master, &self.cams));
            }
        }
        for axis in (0..MAX_AXES).filter(|&axis| follows(axis)) {
            turns.set(axis, turns.of(sharing.first(axis)));
        }
    }

    /// Adds the turns of a tick by which axes gain on the master.
    #[inline(never)]
    fn advance_leads(&mut self, master: Turns, turns: &TickTurns) {
        for (axis, lead) in self.output.telemetry.lead.iter_mut().enumerate() {
            if turns.own() & 1 << axis != 0 {
                *lead = lead.wrapping_add(turns.of(axis).wrapping_sub(master));
            }
        }
    }

    /// Plans the pulses: one plan for all axes that share it.
    fn plan_all(&mut self, command: &TickCommand) {
        self.output.begin_plans();
        let axes = (1 << self.channels.len()) - 1;
        let mut left = self.output.telemetry.sharing.planned() & axes;
        let mut axis = 0;
        while left != 0 {
            if left & 1 != 0 {
                self.plan_axis(axis, command);
            }
            left >>= 1;
            axis += 1;
        }
    }

    /// Plans the pulses of an axis.
    #[inline(never)] // Inlined into a function with more variables, it would lack registers.
    fn plan_axis(&mut self, axis: usize, command: &TickCommand) {
        let (turns, offset) = command.pulses(axis);
        if let (Some(channel), Some((runs, steps))) =
            (self.channels.get_mut(axis), self.output.plan_mut(axis))
        {
            *steps += i64::from(channel.plan(turns, offset, &mut self.step_rate, runs));
        }
    }

    /// Groups all axes, none of which shares a plan.
    #[cold]
    pub(super) fn group_axes(&mut self) {
        for axis in 0..self.channels.len() {
            self.join(axis, axis);
        }
    }

    /// Takes an axis out of its group while its offset moves; the axis before joins one again.
    #[inline(never)]
    fn regroup(&mut self, apart: Option<usize>) {
        if let Some(axis) = self.state.apart {
            self.join(axis, self.channels.len());
        }
        if let Some(axis) = apart {
            self.leave(axis);
        }
        self.state.apart = apart;
    }

    /// Lets an axis share the plan of one of the axes below `end`, if one has the same motion.
    fn join(&mut self, axis: usize, end: usize) {
        let Some(channel) = self.channels.get(axis) else {
            return;
        };
        let planned = self.output.telemetry.sharing.planned();
        let same = |&(first, other): &(usize, &Channel)| {
            first != axis && planned & 1 << first != 0 && channel.has_motion_of(other)
        };
        let found = self.channels.iter().take(end).enumerate().find(same);
        if let Some((first, _)) = found {
            self.output.telemetry.share_plan(1 << axis, axis, first);
        }
    }

    /// Gives an axis a plan of its own.
    fn leave(&mut self, axis: usize) {
        let telemetry = &mut self.output.telemetry;
        let first = telemetry.sharing.first(axis);
        let mut leaving = 1 << axis;
        if first == axis {
            // The others of the group leave it, with the next of them as the first.
            leaving ^= telemetry.sharing.group(axis) as AxisSet;
        }
        let Some(next) = (0..MAX_AXES).find(|axis| leaving & 1 << axis != 0) else {
            return;
        };
        telemetry.share_plan(leaving, first, next);
        self.continue_from(first, next);
    }

    /// Lets an axis continue the motion of the axis whose plan it shared.
    fn continue_from(&mut self, first: usize, axis: usize) {
        let follower_moves = self.followers & 1 << axis != 0;
        if let Ok([first, axis]) = self.channels.get_disjoint_mut([first, axis]) {
            axis.continue_as(first, follower_moves);
        }
    }

    /// Makes the setpoints of servo axes.
    #[inline(never)]
    fn set_points(&mut self, turns: &TickTurns) {
        let home_offset = self.homing.home_offset();
        let Output {
            setpoints,
            telemetry,
            ..
        } = &mut self.output;
        let phase = self.shaft.phase();
        let all = self.channels.iter().zip(setpoints).zip(&telemetry.lead);
        for (axis, ((channel, setpoint), &lead)) in all.enumerate() {
            if let Some(forward) = &channel.feed_forward {
                let coupled = self.coupling.as_ref().map(|coupling| coupling.of(axis));
                let (position, speed) = coupled.unwrap_or_default();
                let velocity = turns.of(axis);
                let motion = &self.state.motion;
                let acceleration =
                    channel
                        .follower
                        .acceleration(motion.speed, motion.acceleration, &self.cams);
                *setpoint = channel.setpoint(
                    forward,
                    phase.advanced(lead),
                    velocity,
                    acceleration,
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
