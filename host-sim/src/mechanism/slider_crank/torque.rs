//! Crank torque that a load on the platform asks for (inverse dynamics), all cranks together.
//!
//! Energy balance, no friction: τ ω = d/dt (kinetic + potential energy of the load). Rods, cranks and
//! the platform itself carry no mass here; the source covers them with its safety factor.
//!
//! Which way gravity acts is a choice of build, not a sign to be looked up. The source's F = m (g + a),
//! with a at its largest in the stretched-out dead centre, is a platform *hanging below* its cranks.

pub use cophase_core::settings::Platform;

use super::SliderCrank;

/// What the cranks have to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Mass on the platform, kg.
    pub mass_kg: f64,
    /// Gravity, m/s², a magnitude.
    pub gravity_mps2: f64,
    /// Where the platform is.
    pub platform: Platform,
}

impl SliderCrank {
    /// Torque of all cranks together, N·m, positive where they drive and negative where the load drives
    /// them: τ = m R s (R (h ω² + s α″) + σ g).
    ///
    /// Exact for the load alone; crank speed ω in rad/s, angular acceleration α″ in rad/s². At constant
    /// speed it is odd in α, so its mean is 0 and its minimum is minus its maximum.
    pub fn torque_nm(
        &self,
        load: &Load,
        alpha_rad: f64,
        omega_rad_s: f64,
        alpha_ddot_rad_s2: f64,
    ) -> f64 {
        let a = self.a_exact_mps2(alpha_rad, omega_rad_s, alpha_ddot_rad_s2);
        self.torque_for_a_nm(load, alpha_rad, a)
    }

    /// The source's torque, N·m: the same leverage, with the two-term acceleration at constant speed,
    /// M = m R s (R ω² (cos α + λ cos 2α) + σ g) (step I; its own sign is [`Platform::Below`]).
    pub fn torque_two_term_nm(&self, load: &Load, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        let a = self.a_two_term_mps2(alpha_rad, omega_rad_s);
        self.torque_for_a_nm(load, alpha_rad, a)
    }

    fn torque_for_a_nm(&self, load: &Load, alpha_rad: f64, a_mps2: f64) -> f64 {
        let force_n = load.mass_kg * (a_mps2 + load.platform.gravity_sign() * load.gravity_mps2);
        force_n * self.crank_radius_m() * self.s(alpha_rad)
    }
}
