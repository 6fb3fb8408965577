//! Rigid model: all cranks on one shaft.
//!
//! With J(α) = Σ J_rotor + m R² s(α)² the kinetic energy is ½ J ω². Lagrange's equation gives
//! J α″ + ½ J′ ω² + dV/dα = torque, where J′ = 2 m R² s h. A moving platform returns to the shaft at one angle the energy that
//! it takes at another.

use super::corners::MAX;
use super::modes::Bound;
use super::{Body, Dynamics};

/// A machine with one angle. The state is `[α, ω]`.
#[derive(Clone, Debug)]
pub struct Rigid {
    body: Body,
    rotors_kgm2: f64,
}

impl Rigid {
    /// Creates a machine of a body, whose rotors turn as one.
    pub fn new(body: Body) -> Self {
        let rotors_kgm2 = body.rotors_kgm2.iter().sum();
        Self { body, rotors_kgm2 }
    }

    /// Equivalent inertia at an angle, kg·m².
    pub fn inertia_kgm2(&self, alpha_rad: f64) -> f64 {
        let lever = self.body.crank(alpha_rad).lever_m;
        self.rotors_kgm2 + self.body.load.mass_kg * lever * lever
    }

    /// Acceleration α″, rad/s², under the total torque of all motors and of friction, N·m.
    pub fn acceleration_rad_s2(&self, alpha_rad: f64, omega_rad_s: f64, torque_nm: f64) -> f64 {
        let body = &self.body;
        let crank = body.crank(alpha_rad);
        let inertia = self.rotors_kgm2 + body.load.mass_kg * crank.lever_m * crank.lever_m;
        let push_n =
            body.load.mass_kg * crank.lever_rate_m * omega_rad_s * omega_rad_s + body.weight_n();
        (torque_nm - crank.lever_m * push_n) / inertia
    }
}

impl Dynamics for Rigid {
    fn rotors_kgm2(&self) -> &[f64] {
        &self.body.rotors_kgm2
    }

    /// All friction acts on the one shaft.
    fn friction_nm(&self, _: usize) -> f64 {
        self.body.friction_nm.iter().sum()
    }

    fn body(&self) -> Option<&Body> {
        Some(&self.body)
    }

    fn positions(&self) -> usize {
        1
    }

    fn angle(&self, _: usize) -> usize {
        0
    }

    fn angles(&self) -> usize {
        1
    }

    fn accelerations(
        &self,
        q: &[f64],
        v: &[f64],
        torques_nm: &[f64],
        held: &[bool; MAX],
        a: &mut [f64],
    ) {
        a[0] = if held[0] {
            0.0
        } else {
            self.acceleration_rad_s2(q[0], v[0], torques_nm.iter().sum())
        };
    }

    fn fastest_mode(&self, rotors: Bound) -> Bound {
        rotors
    }

    fn energy_j(&self, q: &[f64], v: &[f64]) -> f64 {
        0.5 * self.inertia_kgm2(q[0]) * v[0] * v[0]
            + self.body.weight_n() * self.body.crank(q[0]).height_m
    }
}
