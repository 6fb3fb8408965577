//! Rigid model: all cranks on one shaft.
//!
//! With J(α) = Σ J_rotor + m R² s(α)² the kinetic energy is ½ J ω². Lagrange's equation gives
//! J α″ + ½ J′ ω² + dV/dα = torque, where J′ = 2 m R² s h. A moving platform returns to the shaft at one angle the energy that
//! it takes at another.

use super::Body;

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

    /// Body of the machine.
    pub fn body(&self) -> &Body {
        &self.body
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

    /// Kinetic and potential energy, J. It is constant without friction and motors.
    pub fn energy_j(&self, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        0.5 * self.inertia_kgm2(alpha_rad) * omega_rad_s * omega_rad_s
            + self.body.weight_n() * self.body.crank(alpha_rad).height_m
    }
}
