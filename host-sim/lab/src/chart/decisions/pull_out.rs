//! Speed up to which a stepper keeps in step.
//!
//! The machine is a shaft with two cranks and two motors whose torque falls with speed. Their fields turn at 5 rev/s at first, and
//! reach the speed of the drive on a smooth ramp of 1.024 s; they keep it for 0.256 s. The rotors follow, or fall behind by half an
//! electrical cycle or more. The torque of the platform has a period of half a turn, and excites the rotors on the springs of their
//! fields. They pull out at the resonance, far below the speed at which they lack torque.

use std::f64::consts::{PI, TAU};

use cophase_methods::{Equations, Scheme};
use host_sim::drives::PullOut;
use host_sim::drives::{Field, Motor, Stepper};
use host_sim::dynamics::{Body, Rigid};
use host_sim::mechanism::slider_crank::SliderCrank;
use host_sim::mechanism::{Load, Platform};

use super::decision::{Decision, NoOutcome};
use crate::chart::methods::Counted;

/// Torque of a motor at rest and at 60 rev/s, N·m.
const TORQUE_NM: (f64, f64) = (6.0, 3.0);
const MOTORS: usize = 2;
const CYCLES_PER_TURN: f64 = 50.0;
const DAMPING_NMS: f64 = 0.05;
const ROTOR_KGM2: f64 = 2e-3;
const FRICTION_NM: f64 = 0.5;
const LOAD_KG: f64 = 3.0;
/// Crank radius and rod length, m.
const CRANK_M: (f64, f64) = (0.010, 0.040);

/// Speed at the start of the ramp, rev/s.
const FROM_HZ: f64 = 5.0;
/// Duration of the ramp, and of the whole run, s.
const RAMP_S: f64 = 1.024;
pub const END_S: f64 = 1.28;
/// Longest step, s, which divides both, and the number of halvings.
const LONGEST_S: f64 = 8e-3;
const HALVINGS: u32 = 7;

/// Machine; the drive is the speed at the end of the ramp, rev/s.
pub struct PullsOut {
    rigid: Rigid,
    motor: Motor,
}

impl PullsOut {
    /// Creates the machine at rest.
    pub fn new() -> Self {
        let mechanism = SliderCrank::new(CRANK_M.0, CRANK_M.1).expect("a crank within its rod");
        let body = Body {
            mechanism: mechanism.into(),
            load: Load {
                mass_kg: LOAD_KG,
                gravity_mps2: 9.80665,
                platform: Platform::Above,
            },
            tilt_inertia_kgm2: 1.0,
            rotors_kgm2: vec![ROTOR_KGM2; MOTORS],
            mount_radius_m: 0.2,
            rod_n_per_m: 1e8,
            friction_nm: vec![FRICTION_NM; MOTORS],
        };
        let points = [
            (0.0, TORQUE_NM.0),
            (60.0, TORQUE_NM.1),
            (600.0, TORQUE_NM.1),
        ];
        Self {
            rigid: Rigid::new(body),
            motor: Motor::Stepper(Stepper {
                pull_out: PullOut::new(&points).expect("points in order"),
                cycles_per_turn: CYCLES_PER_TURN,
                damping_nms: DAMPING_NMS,
            }),
        }
    }

    /// Returns the machine with fields that reach a speed.
    pub fn led_to(&self, speed_hz: f64) -> Led<'_> {
        Led {
            machine: self,
            speed_hz,
        }
    }
}

/// Machine with turning fields; state `[α, ω]`.
pub struct Led<'a> {
    machine: &'a PullsOut,
    speed_hz: f64,
}

impl Led<'_> {
    /// Returns the state in step with the field, at its speed.
    pub const START: [f64; 2] = [0.0, FROM_HZ * TAU];

    /// Returns the angle of the field at a time.
    fn field(&self, t_s: f64) -> Field {
        let u = (t_s / RAMP_S).clamp(0.0, 1.0);
        // x³ (10 − 15x + 6x²), and its integral.
        let part = u.powi(3) * (10.0 + u * (6.0 * u - 15.0));
        let turns = u.powi(4) * (2.5 + u * (u - 3.0)) * RAMP_S + (t_s - RAMP_S).max(0.0);
        let by_hz = self.speed_hz - FROM_HZ;
        Field {
            alpha_rad: TAU * (FROM_HZ * t_s + by_hz * turns),
            omega_rad_s: TAU * (FROM_HZ + by_hz * part),
            torque_nm: 0.0,
        }
    }

    /// Returns true if the rotors are out of step at a time.
    pub fn is_out(&self, t_s: f64, state: &[f64]) -> bool {
        CYCLES_PER_TURN * (self.field(t_s).alpha_rad - state[0]).abs() > PI
    }
}

impl Equations for Led<'_> {
    fn dimension(&self) -> usize {
        2
    }

    fn rates(&self, t_s: f64, state: &[f64], rates: &mut [f64]) {
        let (alpha, omega) = (state[0], state[1]);
        let torque = MOTORS as f64
            * self
                .machine
                .motor
                .torque_nm(&self.field(t_s), alpha, omega, 0.0);
        // The shaft turns forward throughout, so its friction is constant.
        let net = torque - MOTORS as f64 * FRICTION_NM;
        rates[0] = omega;
        rates[1] = self.machine.rigid.acceleration_rad_s2(alpha, omega, net);
    }

    fn is_second_order(&self) -> bool {
        true
    }
}

impl Decision for PullsOut {
    fn name(&self) -> &'static str {
        "pull-out"
    }

    fn title(&self) -> &'static str {
        "speed at which a stepper pulls out"
    }

    fn reference(&self) -> f64 {
        REFERENCE_HZ
    }

    fn uncertainty(&self) -> f64 {
        UNCERTAINTY
    }

    /// Frequency of the rotors on the springs of their fields, at rest.
    fn omega_rad_s(&self) -> f64 {
        (CYCLES_PER_TURN * TORQUE_NM.0 / ROTOR_KGM2).sqrt()
    }

    fn steps_s(&self) -> Vec<f64> {
        (0..=HALVINGS)
            .map(|i| LONGEST_S / f64::from(1 << i))
            .collect()
    }

    fn beyond(&self, scheme: Scheme, step_s: f64, drive: f64) -> Result<(bool, u64), NoOutcome> {
        let led = self.led_to(drive);
        let counted = Counted::new(&led);
        let mut method = scheme
            .prepare(&counted, step_s)
            .map_err(|_| NoOutcome::Unsuited)?;
        let mut state = Led::START;
        let steps = (END_S / step_s).round() as u32;
        for step in 0..steps {
            method.step(&counted, f64::from(step) * step_s, &mut state)?;
        }
        Ok((led.is_out(END_S, &state), counted.evaluations()))
    }
}

/// Threshold by DOP853, rev/s. `super::reference` computes it again, and by another method.
pub const REFERENCE_HZ: f64 = 21.316_965_607_630_66;
/// Relative difference of the two.
pub const UNCERTAINTY: f64 = 1e-11;
