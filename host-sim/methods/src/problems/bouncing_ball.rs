//! A ball that is dropped and bounces until it is at rest.
//!
//! Its bounces come at ever shorter intervals. From a height H, with restitution e, there are infinitely many, and they end at
//! √(2H/g) (1 + e) / (1 − e). The problem tests the detection of events; the flight is a parabola.

use nalgebra::DMatrix;

use crate::equations::{Equations, Linear};
use crate::event::step_to_crossing;
use crate::{NotMeasured, Scheme};

/// A ball above the ground; state (height, speed upwards).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BouncingBall {
    /// Gravity g, m/s², above 0.
    pub gravity_mps2: f64,
    /// Height from which it is dropped, m, above 0.
    pub height_m: f64,
    /// Speed after a bounce over speed before, above 0 and below 1.
    pub restitution: f64,
}

impl BouncingBall {
    /// Duration of a flight, s, below which the ball counts as at rest.
    pub const RESTING_S: f64 = 1e-12;

    /// Returns the time of the last bounce: √(2H/g) (1 + e) / (1 − e), s.
    pub fn last_bounce_s(&self) -> f64 {
        let fall_s = (2.0 * self.height_m / self.gravity_mps2).sqrt();
        fall_s * (1.0 + self.restitution) / (1.0 - self.restitution)
    }

    /// Drops the ball and simulates it in steps of `step_s`, which end early at bounces, until it is at rest. Returns the time of
    /// the last bounce and the number of bounces, or `None` if it still bounces at twice that time. Explicit Euler adds speed in
    /// each flight, so its ball never comes to rest.
    ///
    /// The neglected time after that is [`BouncingBall::RESTING_S`] / (1 − e) at most.
    pub fn play(&self, scheme: Scheme, step_s: f64) -> Result<Option<(f64, u32)>, NotMeasured> {
        let mut y = [self.height_m, 0.0];
        let (mut t_s, mut bounces) = (0.0, 0);
        while t_s < 2.0 * self.last_bounce_s() {
            let cut = step_to_crossing(scheme, self, t_s, step_s, &mut y, |y| y[0])?;
            t_s += cut.unwrap_or(step_s);
            if cut.is_some() {
                bounces += 1;
                y = [0.0, -self.restitution * y[1]];
                if 2.0 * y[1] / self.gravity_mps2 < Self::RESTING_S {
                    return Ok(Some((t_s, bounces)));
                }
            }
        }
        Ok(None)
    }
}

impl Equations for BouncingBall {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        rates[0] = y[1];
        rates[1] = -self.gravity_mps2;
    }

    fn is_second_order(&self) -> bool {
        true
    }

    fn linear(&self) -> Option<&dyn Linear> {
        Some(self)
    }
}

impl Linear for BouncingBall {
    fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0])
    }

    fn input(&self, _: f64, input: &mut [f64]) {
        input[0] = 0.0;
        input[1] = -self.gravity_mps2;
    }
}
