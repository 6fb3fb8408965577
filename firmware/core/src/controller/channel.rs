//! One axis of the loop: its phase, its pulses or setpoints, and what it was told in the last two ticks.

use crate::axes::Axis;
use crate::drift::TickPhase;
use crate::pulse::{Paces, Planner, Runs};
use crate::servo::{FeedForward, Setpoint};
use crate::units::Turns;

/// One axis, from the master's turns to what its drive is told.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) axis: Axis,
    pub(super) planner: Planner,
    pub(super) reversed: bool,
    /// Of a servo axis; one without is a stepper.
    pub(super) feed_forward: Option<FeedForward>,
    /// Phases of the last two outputs: the one being played, and the one before.
    pub(super) playing: TickPhase,
    pub(super) played: TickPhase,
}

impl Channel {
    /// Moves on with the master, if it is to move, and fills `runs`.
    #[inline(never)]
    pub(super) fn advance(
        &mut self,
        master: Option<&Turns>,
        trim: Turns,
        pace: &mut Paces,
        runs: &mut Runs,
    ) {
        self.played = self.playing;
        self.playing.start = self.axis.phase();
        let turns = match master {
            Some(&speed) => self.axis.advance(speed, trim),
            None => Turns::ZERO,
        };
        self.playing.turns = turns;
        if self.feed_forward.is_none() {
            self.planner.plan(turns, pace, runs);
        } else {
            self.planner.count(turns, pace, runs);
        }
    }

    /// What a servo is told at the end of a tick in which the master accelerated, in the axis's own sense. Its crank stands
    /// `datum` further than its phase says.
    #[inline(never)]
    pub(super) fn setpoint(
        &self,
        forward: &FeedForward,
        acceleration: Turns,
        datum: Turns,
    ) -> Setpoint {
        let (position, velocity) = (self.axis.phase(), self.playing.turns);
        let acceleration = self.axis.gear().share(acceleration);
        Setpoint {
            position,
            velocity,
            torque: forward.torque(position.advanced(datum), velocity, acceleration),
        }
    }
}
