//! Reasons why a simulated machine could not be advanced further.

use cophase_methods::StepError;

/// Reason why a machine could not be advanced further.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Broken {
    /// The method could not make a step.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A shaft exceeds the speed limit of its machine.
    #[error(
        "{noun} {axis} turns at {speed_hz:.0} rev/s at t = {t_s:.4} s, which is beyond any speed of this machine: {cause}"
    )]
    RanAway {
        /// Time, s.
        t_s: f64,
        /// Part that the axis turns, in a word.
        noun: &'static str,
        /// Number of the axis.
        axis: usize,
        /// Speed of the shaft, rev/s.
        speed_hz: f64,
        /// Cause of the speed.
        cause: Cause,
    },
}

/// Cause of a shaft that exceeds the speed limit of its machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Cause {
    /// Shorter steps give another speed.
    #[error(
        "the step is too long for this method on motors whose torque is no straight line; take more method.steps_per_tick, or RK4"
    )]
    Step,
    /// Shorter steps give the same speed.
    #[error(
        "shorter steps give the same speed, so the torque on this {noun} is that large; look at its drive (axes.servo.limit_nm \
         limits its torque), {others}"
    )]
    Torque {
        /// Part that the axis turns, in a word.
        noun: &'static str,
        /// Other causes of a large torque, in words.
        others: &'static str,
    },
}
