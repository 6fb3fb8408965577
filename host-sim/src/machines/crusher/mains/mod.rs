//! Jaw crusher on an induction motor: one shaft whose equivalent inertia changes over the turn.
//!
//! From a Chinese paper on the dynamic design of a flywheel for a crusher with an opening of 250 × 400 mm. An eccentric turns the upper end
//! of the jaw. A toggle plate guides its lower end. Let φ be the angle of the eccentric from the line to the toggle's fixed pivot, and
//! ω = φ′:
//!
//! ```text
//! Je ω′ = Md(ω) − Mr(φ) − ω²/2 dJe/dφ
//! Je(φ) = JF + m (v/ω)² + J (Ω/ω)²          flywheel; jaw with v at its centre of mass, and Ω
//! Md(ω) = j (a (j ω)² + b (j ω) + c)        motor's parabola behind a belt of ratio j
//! Mr(φ) = F(φ) u/ω                          force of the rock; u is the jaw's speed towards the rock
//! ```
//!
//! The rock acts only while the jaw closes, u > 0.
//!
//! The source prints the motor, the belt, the flywheel and the range of Je. It does not print the mechanism. These values are assumed: the
//! eccentric (10 mm), the jaw (800 mm), the toggle plate (250 mm) and the place of the force (650 mm below the eccentric). These are
//! calibrated:
//!
//! - the distance of the fixed pivots, [`Linkage::ground_m`], for the least deviation from the six speeds of the periodic regime that
//!   were computed independently of this project. Distances from 0.78 to 0.90 m, both closing directions, and three places of the force
//!   were compared. The speeds agree within 0.0083 rad/s. A change of 5 mm in either direction reaches the tolerance of 0.01. So these
//!   speeds are not predictions;
//! - mass and centre of mass of the jaw, from the published range of Je, 40.828 to 40.940 kg m². The jaw has the inertia of a uniform
//!   rod.

mod linkage;
mod load;
mod turn;

use cophase_methods::Equations;

pub use linkage::{Jaw, Linkage};
pub use load::{Load, Shape};
pub use turn::{Diverged, Speeds, TurnEquations};

/// OnMains with its motor and flywheel; state (φ, ω), rad and rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnMains {
    /// Coefficients a, b, c of the motor's torque over the motor's speed, N m and rad/s.
    pub torque_curve: [f64; 3],
    /// Speed of the motor over that of the shaft.
    pub belt_ratio: f64,
    /// Inertia of shaft and flywheel, kg m².
    pub flywheel_kgm2: f64,
    /// Geometry.
    pub linkage: Linkage,
    /// Jaw.
    pub jaw: Jaw,
    /// Rock.
    pub load: Load,
}

impl OnMains {
    /// Dimension of the state.
    pub const DIMENSION: usize = 2;

    /// The source's crusher, without rock. The motor's parabola passes through no load at 1000 rpm, 15 kW at 970 rpm, and twice the
    /// rated torque at Kloss's breakdown slip.
    pub const SOURCE: Self = Self {
        torque_curve: [
            -2.541_835_607_262_57,
            477.367_257_370_096,
            -22_115.435_742_513_1,
        ],
        belt_ratio: 3.7,
        flywheel_kgm2: 40.79,
        linkage: Linkage::SOURCE,
        jaw: Jaw::SOURCE,
        load: Load::NONE,
    };

    /// Torque of the motor on the shaft, N m.
    #[must_use]
    pub fn motor_nm(&self, omega_rad_s: f64) -> f64 {
        let [a, b, c] = self.torque_curve;
        let motor_rad_s = self.belt_ratio * omega_rad_s;
        self.belt_ratio * ((a * motor_rad_s + b) * motor_rad_s + c)
    }

    /// Equivalent inertia Je, kg m², and dJe/dφ.
    #[must_use]
    pub fn inertia_kgm2(&self, phi_rad: f64) -> (f64, f64) {
        let (jaw, slope) = self.jaw.inertia_kgm2(&self.linkage, phi_rad);
        (self.flywheel_kgm2 + jaw, slope)
    }

    /// Torque of the rock on the shaft, N m; it brakes.
    #[must_use]
    pub fn rock_nm(&self, phi_rad: f64) -> f64 {
        self.load.torque_nm(&self.linkage, phi_rad)
    }

    /// Torque that the flywheel effect of the changing inertia takes, ω²/2 dJe/dφ, N m.
    #[must_use]
    pub fn inertia_torque_nm(&self, phi_rad: f64, omega_rad_s: f64) -> f64 {
        0.5 * omega_rad_s * omega_rad_s * self.inertia_kgm2(phi_rad).1
    }

    /// Kinetic energy, J.
    #[must_use]
    pub fn energy_j(&self, phi_rad: f64, omega_rad_s: f64) -> f64 {
        0.5 * self.inertia_kgm2(phi_rad).0 * omega_rad_s * omega_rad_s
    }
}

impl Equations for OnMains {
    fn dimension(&self) -> usize {
        Self::DIMENSION
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        let (phi, omega) = (y[0], y[1]);
        let (inertia, slope) = self.inertia_kgm2(phi);
        let torque_nm = self.motor_nm(omega) - self.rock_nm(phi);
        rates[0] = omega;
        rates[1] = (torque_nm - 0.5 * omega * omega * slope) / inertia;
    }

    fn is_second_order(&self) -> bool {
        true
    }
}
