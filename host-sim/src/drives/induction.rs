//! Induction motor on a frequency converter that takes pulses and closes a position loop.

use std::f64::consts::TAU;

use super::{DriveKey, DriveModel, Field, Motor, TorqueLaw};

pub(super) const MODEL: DriveModel = DriveModel {
    keys: &[DriveKey {
        key: "axes.induction",
        is_of_torque: true,
        is_given: |axes| axes.induction.is_some(),
        unused: "describes induction motors, and no axis here has drive = \"induction\"; leave it out",
    }],
    needs: (
        "axes.induction",
        "the motors as [axes.induction] with rated_nm, rated_slip_hz, breakdown_ratio and position_gain_per_s",
    ),
    torque_key: "axes.induction",
    window_deg: |axes| axes.induction?.following_error_deg,
    motor: |axes, at_crank| {
        let motor = axes.induction?;
        let turns = at_crank.motor_turns;
        Some(Motor::Induction(Induction::new(
            motor.rated_nm * turns,
            motor.rated_slip_hz / turns * TAU,
            motor.breakdown_ratio,
            motor.position_gain_per_s,
        )))
    },
};

/// An induction motor on a converter with constant flux. Its torque depends on its slip: synchronous speed minus rotor speed.
///
/// The converter's synchronous speed is φ′ + g (φ − α). Kloss's formula gives the torque at a slip s, with the breakdown
/// torque T_b at the slip s_b: 2 T_b / (s / s_b + s_b / s). Beyond s_b more slip gives less torque, so a load above T_b
/// stalls the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Induction {
    /// Breakdown torque, T_b, N·m.
    pub breakdown_nm: f64,
    /// Slip at the breakdown torque, s_b, rad/s.
    pub breakdown_slip_rad_s: f64,
    /// Position gain g: frequency correction per position error, 1/s.
    pub position_gain_per_s: f64,
}

impl Induction {
    /// Creates a motor with a rated torque, N·m, at a rated slip, rad/s. The breakdown torque is `ratio` times the rated
    /// torque, and `ratio` is at least 1. Kloss's formula gives the rated torque at the rated slip if
    /// s_b = s_rated (ratio + √(ratio² − 1)).
    pub fn new(rated_nm: f64, rated_slip_rad_s: f64, ratio: f64, position_gain_per_s: f64) -> Self {
        Self {
            breakdown_nm: ratio * rated_nm,
            breakdown_slip_rad_s: rated_slip_rad_s * (ratio + (ratio * ratio - 1.0).sqrt()),
            position_gain_per_s,
        }
    }
}

impl TorqueLaw for Induction {
    fn is_linear(&self) -> bool {
        false
    }

    #[inline]
    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64, _: f64) -> f64 {
        let synchronous_rad_s =
            field.omega_rad_s + self.position_gain_per_s * (field.alpha_rad - alpha_rad);
        let slip = (synchronous_rad_s - omega_rad_s) / self.breakdown_slip_rad_s;
        2.0 * self.breakdown_nm * slip / (slip * slip + 1.0)
    }

    /// The largest slope of the curve, which is that at small slip.
    fn damping_nms(&self) -> f64 {
        2.0 * self.breakdown_nm / self.breakdown_slip_rad_s
    }

    fn stiffness_nm(&self, _: f64) -> (f64, f64) {
        let stiffness = self.damping_nms() * self.position_gain_per_s;
        (stiffness, stiffness)
    }

    fn max_nm(&self, _: f64) -> f64 {
        self.breakdown_nm
    }
}
