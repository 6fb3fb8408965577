//! Reasons why a simulated machine could not be advanced further.

use cophase_methods::StepError;

/// Reason why a machine could not be advanced further.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Broken {
    /// The method could not make a step.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A crank exceeds the speed limit of its machine.
    #[error(
        "crank {axis} turns at {speed_hz:.0} rev/s at t = {t_s:.4} s, which is beyond any speed of this machine: {cause}"
    )]
    RanAway {
        /// Time, s.
        t_s: f64,
        /// Number of the crank.
        axis: usize,
        /// Speed of the crank, rev/s.
        speed_hz: f64,
        /// Cause of the speed.
        cause: Cause,
    },
}

/// Cause of a crank that exceeds the speed limit of its machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Cause {
    /// Shorter steps give another speed.
    #[error(
        "the step is too long for this method on motors whose torque is no straight line; take more method.steps_per_tick, or RK4"
    )]
    Step,
    /// Shorter steps give the same speed.
    #[error(
        "shorter steps give the same speed, so the torque on this crank is that large; look at its drive (axes.servo.limit_nm \
         limits its torque), at its load, and at cranks that stand apart and bend rods (offset_deg, start_deg, machine.rod_n_per_um)"
    )]
    Torque,
}
