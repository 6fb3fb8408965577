//! One axis of the loop: its phase, its pulses or setpoints, and its commands of the last two ticks.

use crate::axes::Axis;
use crate::drift::TickPhase;
use crate::pulse::{Planner, Runs, StepRates};
use crate::servo::{FeedForward, Setpoint};
use crate::units::Turns;

/// One axis, from the master's turns to the command of its drive.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) axis: Axis,
    pub(super) planner: Planner,
    pub(super) reversed: bool,
    /// Of a servo axis; one without is a stepper.
    pub(super) feed_forward: Option<FeedForward>,
}

impl Channel {
    /// Moves on with the master, if it is to move, and fills `runs`; the phase over the tick.
    #[inline(never)]
    pub(super) fn advance(
        &mut self,
        master: Option<&Turns>,
        trim: Turns,
        step_rate: &mut StepRates,
        phase: &mut TickPhase,
        runs: &mut Runs,
    ) {
        phase.start = self.axis.phase();
        let turns = match master {
            Some(&speed) => self.axis.advance(speed, trim),
            None => Turns::ZERO,
        };
        phase.turns = turns;
        if self.feed_forward.is_none() {
            self.planner.plan(turns, step_rate, runs);
        } else {
            self.planner.count(turns, step_rate, runs);
        }
    }

    /// Setpoint of a servo at the end of a tick in which the master accelerated, in the axis's own sense. Its crank stands
    /// `home_offset` further than its phase says.
    #[inline(never)]
    pub(super) fn setpoint(
        &self,
        forward: &FeedForward,
        velocity: Turns,
        acceleration: Turns,
        home_offset: Turns,
    ) -> Setpoint {
        let position = self.axis.phase();
        let acceleration = self.axis.gear().share(acceleration);
        Setpoint {
            position,
            velocity,
            torque: forward.torque(position.advanced(home_offset), velocity, acceleration),
        }
    }
}
