//! Interface of a mechanism.

use core::hash::Hasher;

use crate::units::{Amax, Turns};

/// Motion of the platform over the crank angle, per unit crank radius, with 30 fraction bits. It is counted towards the cranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinematics {
    /// Travel of the platform per radian of the crank, −2 to 2.
    pub slope: i32,
    /// Change of the slope per radian, −2 to 2: acceleration at constant speed, per squared speed.
    pub curvature: i32,
}

/// Interface of a mechanism to the controller.
pub trait Mechanism: Copy {
    /// Steady speed, turns a tick, that gives an acceleration amplitude.
    fn speed(&self, amax: Amax) -> Turns;

    /// Acceleration amplitude at a steady speed, turns a tick, of either sign.
    fn amax(&self, speed: Turns) -> Amax;

    /// Motion of the platform at a crank angle, 2³² to the turn; the error is below 1e-6.
    fn kinematics(&self, angle: u32) -> Kinematics;

    /// Hashes one half of the coefficients, six words at most.
    fn hash_half(&self, second: bool, hasher: &mut impl Hasher);

    /// Greatest slope over a turn: the travel of the platform's edge per phase error of a crank. The error is below 1e-4.
    #[cold]
    fn max_slope(&self) -> f64 {
        // The slope is smooth, with one maximum in each half turn, so half a degree is fine enough.
        let angles = (0..720_u64).map(|half_degree| ((half_degree << 32) / 720) as u32);
        let slopes = angles.map(|angle| self.kinematics(angle).slope.unsigned_abs());
        f64::from(slopes.max().unwrap_or(0)) / f64::from(1 << 30)
    }
}
