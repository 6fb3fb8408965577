//! A machine that torque moves, at an instant within a control tick.

use crate::dynamics::{Driven, FrameMotion};
use crate::pose::Pose;

/// The machine before one step of a tick. Its commands are those of that tick, even at the beginning.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Equations of motion under the commands of the tick.
    pub driven: &'a Driven,
    /// Time since the beginning of the tick, s.
    pub t_s: f64,
    /// State of the equations.
    pub state: &'a [f64],
}

/// Torque and acceleration at an [`Instant`].
#[derive(Clone, Debug)]
pub struct Forces {
    /// Largest torque of any motor, N·m, without sign.
    pub torque_nm: f64,
    /// Pose of the part that the shafts move. `None` if it follows from the shafts' angles.
    pub pose: Option<Pose>,
    /// Mean speed and acceleration of the cranks, rad/s and rad/s².
    pub cranks: (f64, f64),
}

impl Instant<'_> {
    /// Angle of crank `i`, turns.
    pub fn turns(&self, i: usize) -> f64 {
        self.driven.alpha_rad(self.state, i) / std::f64::consts::TAU
    }

    /// Returns the torques, and the accelerations that they cause.
    pub fn forces(&self) -> Forces {
        let torques_nm = self.driven.torques_nm(self.t_s, self.state);
        let mut rates = vec![0.0; self.state.len()];
        self.driven
            .rates_under(&torques_nm, self.t_s, self.state, &mut rates);
        Forces {
            torque_nm: torques_nm.iter().copied().map(f64::abs).fold(0.0, f64::max),
            pose: self.driven.pose(self.state, &rates),
            cranks: self.driven.mean_motion(self.state, &rates),
        }
    }

    /// Motion of the frame, if it moves.
    pub fn frame(&self) -> Option<FrameMotion> {
        self.driven.frame_motion(self.state)
    }
}
