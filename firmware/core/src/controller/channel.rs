//! One axis of the loop: its phase, its pulses or setpoints, and its commands of the last two ticks.

use crate::axes::Axis;
use crate::pulse::{Planner, Runs, StepRates};
use crate::servo::{FeedForward, Setpoint};
use crate::units::{Phase, Turns};

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
    /// Whether it may share a plan: one that plays no pulses, or has a ratio, makes edges of its own.
    pub(super) const fn may_share(&self) -> bool {
        self.feed_forward.is_none() && self.axis.gear().is_direct()
    }

    /// Plans a tick in which the axis makes `turns`; the whole steps that these are.
    #[inline(never)]
    pub(super) fn plan(&mut self, turns: Turns, step_rate: &mut StepRates, runs: &mut Runs) -> i32 {
        if self.feed_forward.is_none() {
            self.planner.plan(turns, step_rate, runs)
        } else {
            self.planner.count(turns, step_rate, runs)
        }
    }

    /// Setpoint of a servo at the end of a tick in which the master accelerated, in the axis's own sense. Its crank stands
    /// `home_offset` further than `position`, its commanded phase.
    #[inline(never)]
    pub(super) fn setpoint(
        &self,
        forward: &FeedForward,
        position: Phase,
        velocity: Turns,
        acceleration: Turns,
        home_offset: Turns,
    ) -> Setpoint {
        let acceleration = self.axis.gear().share(acceleration);
        Setpoint {
            position,
            velocity,
            torque: forward.torque(position.advanced(home_offset), velocity, acceleration),
        }
    }
}
