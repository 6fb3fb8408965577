//! Crank torque by the source's formula, with its two-term acceleration.
//!
//! In the source, F = m (g + a), with a largest in the stretched-out dead centre. This is a platform *hanging below* its
//! cranks ([`Platform::Below`](crate::mechanism::Platform::Below)).

use super::SliderCrank;
use crate::mechanism::{Load, Mechanism};

impl SliderCrank {
    /// Torque of the source's formula, N·m: exact leverage, with the two-term acceleration at constant speed, M = m R s (R
    /// ω² (cos α + λ cos 2α) + σ g) (step I).
    pub fn torque_two_term_nm(&self, load: &Load, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        let a = self.a_two_term_mps2(alpha_rad, omega_rad_s);
        self.torque_for_a_nm(load, alpha_rad, a)
    }
}
