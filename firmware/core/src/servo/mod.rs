//! Setpoints for servo axes: position, speed and the torque that the motion needs.
//!
//! They are made from the same phase, in the same tick, as the pulses of stepper axes.

mod coupling;
mod feed_forward;

pub use coupling::Coupling;
pub use feed_forward::FeedForward;

use crate::units::{Phase, Torque, Turns};

/// What a servo drive is told each tick, for the tick's end.
///
/// Signs are the motor's own: for a reversed axis they are turned round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoint {
    /// Where the crank is to be.
    pub position: Phase,
    /// How fast it is to turn, turns a tick.
    pub velocity: Turns,
    /// Torque that the motion needs of this motor, N·m.
    pub torque: Torque,
}

impl Setpoint {
    /// At phase zero, at rest, without torque.
    pub const ZERO: Self = Self {
        position: Phase::ZERO,
        velocity: Turns::ZERO,
        torque: Torque::ZERO,
    };

    /// The same for a motor that is mounted the other way round.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self {
            position: Phase::ZERO.advanced(self.position.since(Phase::ZERO).wrapping_neg()),
            velocity: self.velocity.wrapping_neg(),
            torque: self.torque.wrapping_neg(),
        }
    }
}
