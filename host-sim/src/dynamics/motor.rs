//! What a motor makes of what its drive tells it: torque.

use crate::machine::PullOut;

/// Where a drive would have its rotor, in crank angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Field {
    /// Angle, rad.
    pub alpha_rad: f64,
    /// Speed, rad/s.
    pub omega_rad_s: f64,
    /// Torque that a servo is told to add, N·m.
    pub torque_nm: f64,
}

/// A motor with its drive.
#[derive(Clone, Debug, PartialEq)]
pub enum Motor {
    /// Open loop.
    Stepper(Stepper),
    /// Closed loop.
    Servo(Servo),
}

/// A micro-stepped motor: its field is a spring that repeats every electrical cycle.
///
/// Torque is T(ω) sin(p (φ − α)) + d (φ′ − ω), p electrical cycles a turn. Past a quarter of a cycle the spring gives
/// less instead of more; the rotor then slips until it is caught, whole cycles off.
#[derive(Clone, Debug, PartialEq)]
pub struct Stepper {
    /// Greatest torque against speed.
    pub pull_out: PullOut,
    /// Electrical cycles to a turn: a quarter of the full steps.
    pub cycles_per_turn: f64,
    /// What current control and eddies damp, N·m·s.
    pub damping_nms: f64,
}

/// A drive that holds position, with velocity and torque told ahead, up to its current limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// Torque to an error of position, N·m/rad.
    pub stiffness_nm: f64,
    /// Torque to an error of speed, N·m·s.
    pub damping_nms: f64,
    /// Greatest torque, N·m.
    pub limit_nm: f64,
}

impl Motor {
    /// Torque on the rotor, N·m.
    pub fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper.torque_nm(field, alpha_rad, omega_rad_s),
            Self::Servo(servo) => servo.torque_nm(field, alpha_rad, omega_rad_s),
        }
    }

    /// Torque to an error of speed, N·m·s.
    pub fn damping_nms(&self) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper.damping_nms,
            Self::Servo(servo) => servo.damping_nms,
        }
    }

    /// Stiffness at rest with no load, N·m/rad.
    pub fn stiffness_nm(&self) -> f64 {
        self.stiffness_at_nm(0.0)
    }

    /// Stiffness at a speed with no load, N·m/rad.
    pub fn stiffness_at_nm(&self, omega_rad_s: f64) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper.cycles_per_turn * self.most_nm(omega_rad_s),
            Self::Servo(servo) => servo.stiffness_nm,
        }
    }

    /// Greatest torque at a speed, N·m.
    pub fn most_nm(&self, omega_rad_s: f64) -> f64 {
        match self {
            Self::Stepper(stepper) => stepper
                .pull_out
                .torque_nm(omega_rad_s.abs() / std::f64::consts::TAU),
            Self::Servo(servo) => servo.limit_nm,
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
    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        let asked = self.stiffness_nm * (field.alpha_rad - alpha_rad)
            + self.damping_nms * (field.omega_rad_s - omega_rad_s)
            + field.torque_nm;
        asked.clamp(-self.limit_nm, self.limit_nm)
    }
}
