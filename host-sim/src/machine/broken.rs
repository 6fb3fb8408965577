//! Why a simulated machine went no further.

use cophase_methods::StepError;

/// Why a machine went no further.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Broken {
    /// A step was not made.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A crank turns faster than any of its machine is to.
    #[error(
        "crank {axis} turns at {speed_hz:.0} rev/s at t = {t_s:.4} s, which is beyond any speed of this machine: {cause}"
    )]
    RanAway {
        /// When, s.
        t_s: f64,
        /// Which crank.
        axis: usize,
        /// Its speed.
        speed_hz: f64,
        /// Why.
        cause: Cause,
    },
}

/// Why a crank turns faster than any of its machine is to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Cause {
    /// With shorter steps it turns at another speed.
    #[error(
        "the step is too long for this method on motors whose torque is no straight line; take more method.steps_per_tick, or RK4"
    )]
    Step,
    /// With shorter steps it turns at the same speed.
    #[error(
        "shorter steps give the same speed, so the torque on this crank is that large; look at its drive (axes.servo.limit_nm \
         limits its torque), at its load, and at cranks that stand apart and bend rods (offset_deg, start_deg, machine.rod_n_per_um)"
    )]
    Torque,
}
