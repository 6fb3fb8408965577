//! One axis of the loop: from the master's turns to its pulses or setpoints.

use core::hash::{Hash, Hasher};

use crate::axes::{AnyFollower, Follower};
use crate::pulse::{Planner, Runs, StepRates};
use crate::servo::{FeedForward, ServoPart, Setpoint};
use crate::units::{Phase, Turns};

/// One axis, from the master's turns to the command of its drive.
#[derive(Clone, Debug)]
#[repr(C)] // The planner comes first: instructions reach 32 bytes, or 128 by words.
pub(super) struct Channel {
    pub(super) planner: Planner,
    /// Feed-forward of a servo axis; none for a stepper.
    pub(super) feed_forward: Option<ServoPart<FeedForward>>,
    pub(super) reversed: bool,
    pub(super) follower: AnyFollower,
}

impl Channel {
    /// Hashes one of four slices of what no tick changes.
    #[inline(always)]
    pub(super) fn hash_slice(&self, slice: usize, hasher: &mut impl Hasher) {
        let Self {
            planner,
            feed_forward,
            reversed,
            follower,
        } = self;
        match slice {
            0 | 1 => planner.hash_half(slice == 1, hasher),
            2 => follower.hash_constants(hasher),
            _ => {
                reversed.hash(hasher);
                if let Some(forward) = feed_forward {
                    forward.hash_constants(hasher);
                }
            }
        }
    }

    /// True if the axis makes the same edges as another from now on, as long as neither's phase offset moves.
    pub(super) fn has_motion_of(&self, other: &Self) -> bool {
        self.feed_forward.is_none()
            && other.feed_forward.is_none()
            && self.planner.place() == other.planner.place()
            && self.follower == other.follower
    }

    /// Continues the motion of another axis with an equal follower, from its place within a step. `follower_moves` is false if the follower
    /// makes the master's own turns, and so does not change.
    #[inline(never)] // The two references then cannot overlap, and the copies need no `memmove`.
    pub(super) fn continue_as(&mut self, other: &Self, follower_moves: bool) {
        if follower_moves {
            self.follower = other.follower.clone();
        }
        self.planner.continue_from(other.planner.place());
    }

    /// Plans a tick in which the axis makes `turns`, and `offset` half-steps of 2⁻⁴⁸ of its phase offset. Returns the number of whole
    /// steps.
    #[inline(always)] // Passing its arguments takes as long as a fifth of the plan.
    pub(super) fn plan(
        &mut self,
        turns: Turns,
        offset: i64,
        step_rate: &mut StepRates,
        runs: &mut Runs,
    ) -> i32 {
        if self.feed_forward.is_none() {
            self.planner.plan(turns, offset, step_rate, runs)
        } else {
            self.planner.count(turns, offset, step_rate, runs)
        }
    }

    /// Returns the setpoint of a servo at the end of a tick in which it accelerated, in the axis's own sense. The crank is `home_offset`
    /// ahead of `position`, its commanded phase.
    #[inline(never)]
    pub(super) fn setpoint(
        &self,
        forward: &FeedForward,
        position: Phase,
        velocity: Turns,
        acceleration: Turns,
        home_offset: Turns,
    ) -> Setpoint {
        Setpoint {
            position,
            velocity,
            torque: forward.torque(position.advanced(home_offset), velocity, acceleration),
        }
    }
}
