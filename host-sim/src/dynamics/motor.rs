//! Torque that a motor generates from its drive's command.

use crate::drives::PullOut;

/// Command of a drive to its rotor, in crank angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Field {
    /// Angle, rad.
    pub alpha_rad: f64,
    /// Speed, rad/s.
    pub omega_rad_s: f64,
    /// Torque feed-forward of a servo, N·m.
    pub torque_nm: f64,
}

/// Motor with its drive, by kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Motor {
    /// Stepper motor, open loop.
    Stepper(Stepper),
    /// Servo motor, closed loop.
    Servo(Servo),
    /// Induction motor on a frequency converter with a position loop.
    Induction(Induction),
}

/// A micro-stepped motor. Its field acts as a spring that repeats every electrical cycle.
///
/// Torque is T(ω) sin(p (φ − α)) + d (φ′ − ω), with p electrical cycles per turn. Beyond a quarter of a cycle the torque
/// falls again. The rotor then slips until the field catches it, a whole number of cycles away.
#[derive(Clone, Debug, PartialEq)]
pub struct Stepper {
    /// Pull-out torque against speed.
    pub pull_out: PullOut,
    /// Electrical cycles per turn: a quarter of the full steps.
    pub cycles_per_turn: f64,
    /// Damping by current control and eddy currents, N·m·s.
    pub damping_nms: f64,
}

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

impl Motor {
    /// Torque on the rotor, N·m. `integral_nm` is z, and 0 if the motor has none.
    #[inline]
    pub fn torque_nm(
        &self,
        field: &Field,
        alpha_rad: f64,
        omega_rad_s: f64,
        integral_nm: f64,
    ) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper.torque_nm(field, alpha_rad, omega_rad_s),
            Self::Servo(servo) => servo.torque_nm(field, alpha_rad, omega_rad_s, integral_nm),
            Self::Induction(motor) => motor.torque_nm(field, alpha_rad, omega_rad_s),
        }
    }

    /// Integral time of the velocity loop, s, if there is one.
    pub fn integral_s(&self) -> Option<f64> {
        match self {
            Self::Servo(servo) => servo.integral_s,
            Self::Stepper(_) | Self::Induction(_) => None,
        }
    }

    /// Torque limit of a servo's drive, N·m, if it has one.
    pub fn limit_nm(&self) -> Option<f64> {
        match self {
            Self::Servo(servo) => Some(servo.limit_nm).filter(|limit_nm| limit_nm.is_finite()),
            Self::Stepper(_) | Self::Induction(_) => None,
        }
    }

    /// Torque per speed error, N·m·s.
    pub fn damping_nms(&self) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper.damping_nms,
            Self::Servo(servo) => servo.velocity_gain_nms,
            Self::Induction(motor) => motor.slope_nms(),
        }
    }

    /// Softest and stiffest stiffness at a speed without load, N·m/rad. For a servo the softest value applies to slow and
    /// fast motion. In between, an integral adds to it.
    pub fn stiffness_nm(&self, omega_rad_s: f64) -> (f64, f64) {
        match self {
            Self::Stepper(stepper) => {
                let stiffness = stepper.cycles_per_turn * self.most_nm(omega_rad_s);
                (stiffness, stiffness)
            }
            Self::Servo(servo) => {
                let proportional = servo.velocity_gain_nms * servo.position_gain_per_s;
                let integral_per_s = servo.integral_s.map_or(0.0, f64::recip);
                let added = servo.velocity_gain_nms * integral_per_s;
                (proportional, proportional + added)
            }
            Self::Induction(motor) => {
                let stiffness = motor.slope_nms() * motor.position_gain_per_s;
                (stiffness, stiffness)
            }
        }
    }

    /// Largest stiffness over all speeds, N·m/rad.
    pub fn stiffest_nm(&self) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper.cycles_per_turn * stepper.pull_out.greatest_nm(),
            Self::Servo(_) | Self::Induction(_) => self.stiffness_nm(0.0).1,
        }
    }

    /// Following error at constant speed without load, rad: the velocity that is not fed forward, over the position gain.
    pub fn following_error_rad(&self, omega_rad_s: f64) -> f64 {
        match self {
            Self::Stepper(_) | Self::Induction(_) => 0.0,
            Self::Servo(servo) => {
                (1.0 - servo.velocity_feed_forward) * omega_rad_s / servo.position_gain_per_s
            }
        }
    }

    /// Largest torque at a speed, N·m.
    pub fn most_nm(&self, omega_rad_s: f64) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper
                .pull_out
                .torque_nm(omega_rad_s.abs() / std::f64::consts::TAU),
            Self::Servo(servo) => servo.limit_nm,
            Self::Induction(motor) => motor.breakdown_nm,
        }
    }
}

impl Stepper {
    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        let most_nm = self
            .pull_out
            .torque_nm(omega_rad_s.abs() / std::f64::consts::TAU);
        let ahead_rad = self.cycles_per_turn * (field.alpha_rad - alpha_rad);
        most_nm * ahead_rad.sin() + self.damping_nms * (field.omega_rad_s - omega_rad_s)
    }
}

impl Servo {
    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64, integral_nm: f64) -> f64 {
        let requested_rad_s = self.velocity_feed_forward * field.omega_rad_s
            + self.position_gain_per_s * (field.alpha_rad - alpha_rad);
        let torque_nm = self.velocity_gain_nms * (requested_rad_s - omega_rad_s);
        (torque_nm + integral_nm + field.torque_nm).clamp(-self.limit_nm, self.limit_nm)
    }
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

    /// Torque per slip at small slip, N·m·s: the largest slope of the curve.
    fn slope_nms(&self) -> f64 {
        2.0 * self.breakdown_nm / self.breakdown_slip_rad_s
    }

    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        let synchronous_rad_s =
            field.omega_rad_s + self.position_gain_per_s * (field.alpha_rad - alpha_rad);
        let slip = (synchronous_rad_s - omega_rad_s) / self.breakdown_slip_rad_s;
        2.0 * self.breakdown_nm * slip / (slip * slip + 1.0)
    }
}
