//! The pendulum q″ = −sin q − c q′ + F cos νt, in units of its own small-swing time 1/ω₀.
//!
//! It is smooth and nonlinear. Free (c = F = 0), it conserves its energy; damped and driven, it is like a general machine.

use nalgebra::DMatrix;

use crate::equations::{Differences, Equations};

/// A pendulum; state (q, v), angle in rad and rad per unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum {
    /// Damping c.
    pub damping: f64,
    /// Amplitude F of the driving torque.
    pub torque: f64,
    /// Frequency ν of the driving torque.
    pub drive: f64,
}

impl Pendulum {
    /// Returns a pendulum without damping and without a driving torque.
    pub const FREE: Self = Self {
        damping: 0.0,
        torque: 0.0,
        drive: 0.0,
    };

    /// Returns a damped and driven pendulum, far from linear at a start such as (2, 0).
    pub const DRIVEN: Self = Self {
        damping: 0.2,
        torque: 0.5,
        drive: 2.0 / 3.0,
    };

    /// Returns the energy ½ v² + 1 − cos q.
    pub fn energy(&self, y: &[f64]) -> f64 {
        0.5 * y[1] * y[1] + 1.0 - y[0].cos()
    }
}

impl Equations for Pendulum {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        rates[0] = y[1];
        rates[1] = self.torque * (self.drive * t_s).cos() - y[0].sin() - self.damping * y[1];
    }

    fn is_second_order(&self) -> bool {
        true
    }

    fn jacobian(&self, _: f64, y: &[f64], _: &mut Differences, jacobian: &mut DMatrix<f64>) {
        jacobian.copy_from_slice(&[0.0, -y[0].cos(), 1.0, -self.damping]);
    }
}
