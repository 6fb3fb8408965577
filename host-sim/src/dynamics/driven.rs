//! A machine with its motors, as equations that a method can advance.
//!
//! What the drives tell the motors goes on evenly within a control tick: a field at an angle, turning at a speed.
//! Microsteps, which are smaller than anything here resolves, are not modelled.

use cophase_methods::Equations;

use super::corners::MOST;
use super::{Body, Field, Motor, Phased, Rigid};

/// How much freedom the cranks have.
#[derive(Clone, Debug)]
pub enum Freedom {
    /// All on one shaft: the state is `[α, ω]`.
    Rigid(Rigid),
    /// Each its own rotor: the state is N angles, then N speeds.
    Phased(Box<Phased>),
}

/// An oscillation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Frequency without damping, rad/s.
    pub omega_rad_s: f64,
    /// Damping ratio.
    pub zeta: f64,
}

/// Motors on a machine. Time counts from the control tick's beginning.
#[derive(Clone, Debug)]
pub struct Driven {
    freedom: Freedom,
    motors: Vec<Motor>,
    /// Where each field is at the tick's beginning, and its speed through the tick.
    pub fields: Vec<Field>,
    /// Whether the drives are on; without them only friction and the load act.
    pub energised: bool,
}

impl Driven {
    /// A machine with one motor an axis, drives off.
    pub fn new(freedom: Freedom, motors: Vec<Motor>) -> Self {
        let driven = Self {
            fields: vec![Field::default(); motors.len()],
            freedom,
            motors,
            energised: false,
        };
        assert_eq!(driven.body().axes(), driven.motors.len(), "a motor an axis");
        driven
    }

    /// The machine.
    pub fn body(&self) -> &Body {
        match &self.freedom {
            Freedom::Rigid(rigid) => rigid.body(),
            Freedom::Phased(phased) => phased.body(),
        }
    }

    /// A motor an axis.
    pub fn motors(&self) -> &[Motor] {
        &self.motors
    }

    /// How many angles its state has.
    pub fn angles(&self) -> usize {
        match self.freedom {
            Freedom::Rigid(_) => 1,
            Freedom::Phased(_) => self.motors.len(),
        }
    }

    /// Angle of crank `i`, rad, in a state.
    pub fn alpha_rad(&self, state: &[f64], i: usize) -> f64 {
        match self.freedom {
            Freedom::Rigid(_) => state[0],
            Freedom::Phased(_) => state[i],
        }
    }

    /// A bound on the fastest mode: the rotor that is fastest by itself, between its motor's spring and damper and, where
    /// the platform is over-constrained, its rod. All that hangs on a rotor makes it slower.
    pub fn fastest_mode(&self) -> Mode {
        let body = self.body();
        let over_constrained = matches!(self.freedom, Freedom::Phased(_)) && body.axes() > 3;
        let rod_nm = if over_constrained {
            // |s| is at most 1 + λ: at λ ≤ 0.8 its maximum is below that.
            let lever = body.mechanism.crank_radius_m() * (1.0 + body.mechanism.lambda());
            body.rod_n_per_m * lever * lever
        } else {
            0.0
        };
        let rotors = self.motors.iter().zip(&body.rotors_kgm2);
        let modes = rotors.map(|(motor, rotor)| {
            let omega_rad_s = ((motor.stiffness_nm() + rod_nm) / rotor).sqrt();
            Mode {
                omega_rad_s,
                zeta: motor.damping_nms() / (2.0 * rotor * omega_rad_s),
            }
        });
        // What is damped strongly decays at up to 2 ζ ω.
        let rate = |mode: &Mode| mode.omega_rad_s * (1.0 + 2.0 * mode.zeta);
        modes
            .max_by(|a, b| rate(a).total_cmp(&rate(b)))
            .unwrap_or_default()
    }

    fn torque_nm(&self, i: usize, t_s: f64, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        if !self.energised {
            return 0.0;
        }
        let field = Field {
            alpha_rad: self.fields[i].alpha_rad + self.fields[i].omega_rad_s * t_s,
            ..self.fields[i]
        };
        self.motors[i].torque_nm(&field, alpha_rad, omega_rad_s)
    }
}

impl Equations for Driven {
    fn dimension(&self) -> usize {
        2 * self.angles()
    }

    fn rates(&self, t_s: f64, state: &[f64], rates: &mut [f64]) {
        let (alpha, omega) = state.split_at(self.angles());
        let (speeds, accelerations) = rates.split_at_mut(self.angles());
        speeds.copy_from_slice(omega);
        match &self.freedom {
            Freedom::Rigid(rigid) => {
                let torque = (0..self.motors.len())
                    .map(|i| self.torque_nm(i, t_s, alpha[0], omega[0]))
                    .sum();
                accelerations[0] = rigid.acceleration_rad_s2(alpha[0], omega[0], torque);
            }
            Freedom::Phased(phased) => {
                let mut torques = [0.0; MOST];
                for (i, torque) in torques.iter_mut().enumerate().take(self.motors.len()) {
                    *torque = self.torque_nm(i, t_s, alpha[i], omega[i]);
                }
                phased.accelerations(alpha, omega, &torques, accelerations);
            }
        }
    }

    fn is_second_order(&self) -> bool {
        true
    }
}
