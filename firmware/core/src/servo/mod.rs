//! Setpoints for servo axes: position, speed and the torque that the motion needs.
//!
//! They derive from the same phase, in the same tick, as the pulses of stepper axes.

mod coupling;
mod feed_forward;
mod part;

pub use coupling::Coupling;
pub use feed_forward::FeedForward;
pub(crate) use part::{ServoPart, servo_part};

use crate::units::{Phase, Torque, Turns};

/// Setpoint of a servo drive, sent each tick for the end of the tick.
///
/// Signs are the motor's own: for a reversed axis they are inverted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoint {
    /// Commanded phase of the crank.
    pub position: Phase,
    /// Commanded speed, turns a tick.
    pub velocity: Turns,
    /// Torque that the motion needs of this motor, N·m.
    pub torque: Torque,
}

impl Setpoint {
    /// Setpoint at phase zero, at rest, without torque.
    pub const ZERO: Self = Self {
        position: Phase::ZERO,
        velocity: Turns::ZERO,
        torque: Torque::ZERO,
    };

    /// Inverts all signs, for a motor that turns in the opposite sense.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self {
            position: Phase::ZERO.advanced(self.position.since(Phase::ZERO).wrapping_neg()),
            velocity: self.velocity.wrapping_neg(),
            torque: self.torque.wrapping_neg(),
        }
    }
}
