//! Servo: a position loop around a velocity loop. One takes setpoints, the other pulses.

use super::{DriveKey, DriveModel, Field, Motor, TorqueLaw};

/// Both kinds of servos: only the input differs, which the core knows.
pub(super) const MODEL: DriveModel = DriveModel {
    keys: &[DriveKey {
        key: "axes.servo",
        is_of_torque: true,
        is_given: |axes| axes.servo.is_some(),
        unused: "is the position loop of a servo, and no axis here is one; leave it out, or give drive = \"servo\" or \"pulse-servo\"",
    }],
    needs: (
        "axes.servo",
        "the drives' gains as [axes.servo] with position_gain_per_s and velocity_gain_nms",
    ),
    torque_key: "axes.servo.limit_nm",
    window_deg: |axes| axes.servo?.following_error_deg,
    motor: |axes, at_crank| {
        let servo = axes.servo?;
        let turns = at_crank.motor_turns;
        Some(Motor::Servo(Servo {
            position_gain_per_s: servo.position_gain_per_s,
            velocity_gain_nms: servo.velocity_gain_nms * (turns * turns),
            integral_s: servo.integral_s,
            limit_nm: servo
                .limit_nm
                .map_or(f64::INFINITY, |limit_nm| limit_nm * turns),
            velocity_feed_forward: servo.velocity_feed_forward,
        }))
    },
};

/// A drive with a position loop around a velocity loop, each with feed-forward, and a current limit.
///
/// The position loop commands the velocity f φ′ + g (φ − α), with a share f of velocity feed-forward. The velocity loop
/// answers a velocity error e with the torque k e + z, to which the feed-forward torque is added. The current limit clamps
/// the sum. The integral obeys z′ = k e / Tᵢ, less the clamped excess over Tᵢ (*back-calculation*). Altogether,
/// z′ = (torque − feed-forward − z) / Tᵢ. So z + feed-forward follows the actual torque and cannot wind up beyond it. The
/// current loop is much faster than all this, and is not modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// Position gain g: velocity per position error, 1/s.
    pub position_gain_per_s: f64,
    /// Velocity gain k: torque per velocity error, N·m·s.
    pub velocity_gain_nms: f64,
    /// Integral time Tᵢ of the velocity loop, s. `None` if the loop has no integral z.
    pub integral_s: Option<f64>,
    /// Torque limit, N·m.
    pub limit_nm: f64,
    /// Share f of velocity feed-forward.
    pub velocity_feed_forward: f64,
}

impl TorqueLaw for Servo {
    #[inline]
    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64, integral_nm: f64) -> f64 {
        let requested_rad_s = self.velocity_feed_forward * field.omega_rad_s
            + self.position_gain_per_s * (field.alpha_rad - alpha_rad);
        let torque_nm = self.velocity_gain_nms * (requested_rad_s - omega_rad_s);
        (torque_nm + integral_nm + field.torque_nm).clamp(-self.limit_nm, self.limit_nm)
    }

    fn integral_s(&self) -> Option<f64> {
        self.integral_s
    }

    fn limit_nm(&self) -> Option<f64> {
        Some(self.limit_nm).filter(|limit_nm| limit_nm.is_finite())
    }

    fn damping_nms(&self) -> f64 {
        self.velocity_gain_nms
    }

    /// The softest value applies to slow and fast motion. In between, an integral adds to it.
    fn stiffness_nm(&self, _: f64) -> (f64, f64) {
        let proportional = self.velocity_gain_nms * self.position_gain_per_s;
        let integral_per_s = self.integral_s.map_or(0.0, f64::recip);
        let added = self.velocity_gain_nms * integral_per_s;
        (proportional, proportional + added)
    }

    /// The velocity that is not fed forward, over the position gain.
    fn following_error_rad(&self, omega_rad_s: f64) -> f64 {
        (1.0 - self.velocity_feed_forward) * omega_rad_s / self.position_gain_per_s
    }

    fn max_nm(&self, _: f64) -> f64 {
        self.limit_nm
    }
}
