//! Vibrating screen with a motor of limited power, which the resonance of the screen may capture during the run-up.
//!
//! From a thesis on a self-centring screen for railway ballast. A box of mass M on isotropic springs carries a shaft with an eccentric
//! block of static moment m r. The motor turns the shaft:
//!
//! ```text
//! M x″ + C x′ + K x = m r (φ′² cos φ + φ″ sin φ)
//! M y″ + C y′ + K y = m r (φ′² sin φ − φ″ cos φ)
//! J φ″ = T(φ′) − T_f + m r (x″ sin φ − y″ cos φ)
//! ```
//!
//! x and y are measured from the place of rest. Near the resonance, the box takes more power at a larger amplitude, and may take all the
//! power of the motor. The shaft then stays at that speed, below the speed that it should reach (**capture**, or Sommerfeld's effect). A
//! small change of the torque decides whether the shaft passes the resonance.
//!
//! Published: steady 5.00 mm at 837 turns per minute. With the torque limited to 1.05 of the rated torque, capture occurs near 187 turns
//! per minute with 28 mm. With 1.1 the screen runs up.
//!
//! Assumed: the torque is at its limit from rest on, and falls by Kloss's formula within the breakdown slip of 0.12 from the synchronous
//! speed. The weight of the block is left out: with it, a motor of the rated torque does not lift the block from level, although it swings
//! the block up from the bottom. The inertia is not that of the source. The source gives 3 kg m², "the rotor's", and with this value the
//! screen runs up at 0.9 of the rated torque. The published results require 5.9 to 7.1 kg m² in all. The model uses 6.5.

use core::f64::consts::TAU;

use crate::Equations;

/// The screen; state (x, y, φ, x′, y′, φ′), m and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Greatest torque of the motor, over its rated one.
    pub torque_over_rated: f64,
}

/// Box, stone and exciter block, kg.
const MASS_KG: f64 = 2900.0 + 166.0;
/// Static moment of the block, kg m.
const MOMENT_KG_M: f64 = 14.487;
/// Stiffness of the springs: 1310.4 kgf/cm.
const STIFFNESS_N_M: f64 = 1310.4 * 981.0;
/// Damping ratio of the box on its springs.
const ZETA: f64 = 0.07;
/// Inertia of all rotating parts, kg m².
const INERTIA_KGM2: f64 = 6.5;
/// Friction, N m.
const FRICTION_NM: f64 = 2.0;
/// Synchronous speed of the motor, 1500 turns per minute, behind pulleys of 314 and 560 mm; rad/s.
const SYNCHRONOUS_RAD_S: f64 = 1500.0 / 60.0 * TAU * 314.0 / 560.0;
/// Rated power of the motor, W.
const RATED_W: f64 = 11e3;
/// Slip at the breakdown torque, and that torque over the rated one: the rated slip follows from them.
const BREAKDOWN_SLIP: f64 = 0.12;
const BREAKDOWN: f64 = 2.2;

impl Screen {
    /// Dimension of the state.
    pub const DIMENSION: usize = 6;

    /// Breakdown torque over the rated one: the greatest torque of a motor without a limit.
    pub const UNLIMITED: f64 = BREAKDOWN;

    /// Frequency of the box on its springs, rad/s.
    pub fn omega_rad_s() -> f64 {
        (STIFFNESS_N_M / MASS_KG).sqrt()
    }

    /// Rated torque at the screen's shaft, N m; at the rated slip s Kloss's 2 / (s/s_b + s_b/s) is 1/2.2.
    pub fn rated_nm() -> f64 {
        let slip = BREAKDOWN_SLIP * (BREAKDOWN - (BREAKDOWN * BREAKDOWN - 1.0).sqrt());
        RATED_W / (SYNCHRONOUS_RAD_S * (1.0 - slip))
    }

    /// Torque of the motor at a speed, N m.
    pub fn torque_nm(&self, omega_rad_s: f64) -> f64 {
        let max_nm = self.torque_over_rated * Self::rated_nm();
        let slip = 1.0 - omega_rad_s / SYNCHRONOUS_RAD_S;
        if slip >= BREAKDOWN_SLIP {
            return max_nm;
        }
        // 2 / (s/s_b + s_b/s), without a division by a slip of 0.
        let part = slip / BREAKDOWN_SLIP;
        max_nm * 2.0 * part / (1.0 + part * part)
    }

    /// Amplitude of the box in a state, m.
    pub fn amplitude_m(state: &[f64]) -> f64 {
        state[0].hypot(state[1])
    }
}

impl Equations for Screen {
    fn dimension(&self) -> usize {
        Self::DIMENSION
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        let damping = 2.0 * ZETA * MASS_KG * Self::omega_rad_s();
        let (sin, cos) = y[2].sin_cos();
        let omega = y[5];
        let pull_n = MOMENT_KG_M * omega * omega;
        let x_n = pull_n * cos - damping * y[3] - STIFFNESS_N_M * y[0];
        let y_n = pull_n * sin - damping * y[4] - STIFFNESS_N_M * y[1];
        // With the box's accelerations inserted, the shaft's equation has φ″ as its only unknown.
        let torque_nm =
            self.torque_nm(omega) - FRICTION_NM + MOMENT_KG_M / MASS_KG * (x_n * sin - y_n * cos);
        let angular = torque_nm / (INERTIA_KGM2 - MOMENT_KG_M * MOMENT_KG_M / MASS_KG);
        rates[..3].copy_from_slice(&y[3..]);
        rates[3] = (x_n + MOMENT_KG_M * sin * angular) / MASS_KG;
        rates[4] = (y_n - MOMENT_KG_M * cos * angular) / MASS_KG;
        rates[5] = angular;
    }

    fn is_second_order(&self) -> bool {
        true
    }
}
