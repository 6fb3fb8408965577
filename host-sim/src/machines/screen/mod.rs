//! Vibrating screen: a box on springs, which unbalanced shafts shake. The source is a Chinese thesis on a self-centring screen.
//!
//! The box moves along (x) and across (z), and pitches (θ, small). Shaft i is at p_i along the box and carries a block of
//! mass G at a distance R from its axis. P is the mass of the box, M = P + N G, I the pitch inertia about the centre, and J
//! a rotor's inertia. K and C are stiffness and damping of all springs together, and K_θ and C_θ those in pitch. Positions
//! are relative to rest under the weight of the box. Lagrange's equations for φ_i, x, z and θ are:
//!
//! ```text
//! (J + G R²) φ″ − G R sin φ x″ + G R cos φ (z″ + p θ″) = torque − G g R cos φ
//! M x″ + C x′ + K x = Σ G R (sin φ φ″ + cos φ φ′²)
//! M z″ + Σ G p θ″ + C z′ + K z = −Σ G R (cos φ φ″ − sin φ φ′²)
//! (I + Σ G p²) θ″ + Σ G p z″ + C_θ θ′ + K_θ θ = −Σ G R p (cos φ φ″ − sin φ φ′²)
//! ```
//!
//! The length that the controller gets is the *throw* G R N / M. Far above its resonance
//! the box moves by the throw, opposite to the blocks, so that its amplitude is throw · ω². Near the resonance it is
//! larger. There the forbidden band prevents a constant speed.
//!
//! Not modelled: stones that leave the deck, belts, and pitch beyond small angles.

mod drawing;
mod record;
mod resonance;
mod table;

use std::sync::Arc;

use cophase_core::settings::AxisSettings;
use cophase_scene::file::Fidelity;
use nalgebra::{Matrix3, Vector3};

use crate::dynamics::plant::{Plant, Record, Shafts};
use crate::dynamics::{Mode, PlaneMotion};
use crate::machines::{Machine, Shown};
use crate::mechanism::SquareLaw;
use crate::pose::Pose;
use record::ScreenRecord;

/// Name with its article.
const NAME: &str = "a screen";
pub use resonance::{AMPLIFICATION, Resonance, Steady};

/// Box on springs with unbalanced shafts.
#[derive(Clone, Debug, PartialEq)]
pub struct Screen {
    /// Mass of the box with its contents, without the exciter blocks, kg.
    pub box_kg: f64,
    /// Pitch inertia of the box about its centre, kg·m².
    pub pitch_kgm2: f64,
    /// Mass of each exciter block, kg.
    pub block_kg: f64,
    /// Distance of a block's centre of mass from its shaft's axis, m.
    pub eccentricity_m: f64,
    /// Position of each shaft along the box, relative to its centre, m.
    pub places_m: Vec<f64>,
    /// Total stiffness of all springs, along and across, N/m.
    pub stiffness_n_per_m: f64,
    /// Damping of the box on its springs, as a fraction of critical damping.
    pub zeta: f64,
    /// Distance of the springs from the centre, m.
    pub springs_m: f64,
    /// Gravity, m/s².
    pub gravity_mps2: f64,
    /// Phase of each shaft in steady rotation, turns.
    pub phases_turns: Vec<f64>,
    /// Largest speed of the shafts, rev/s.
    pub top_hz: f64,
    /// Limit of the controller on a lag of all shafts, turns.
    pub common_limit_turns: f64,
    /// Torque at the resonances.
    pub sufficient: Sufficient,
}

/// Torque that is enough at the resonance with the smallest reserve, and the motors' own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sufficient {
    /// Torque of each motor that is enough to turn steadily there, N·m.
    pub enough_nm: f64,
    /// Largest torque of a motor at that speed, N·m. `None` if the scene gives none.
    pub motor_nm: Option<f64>,
}

impl Sufficient {
    /// Torque of a motor over the sufficient one.
    #[must_use]
    pub fn reserve(&self) -> Option<f64> {
        self.motor_nm.map(|motor_nm| motor_nm / self.enough_nm)
    }
}

impl Screen {
    /// Total vibrating mass, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.box_kg + self.places_m.len() as f64 * self.block_kg
    }

    /// Static moment of one block, kg·m.
    fn moment_kgm(&self) -> f64 {
        self.block_kg * self.eccentricity_m
    }

    /// Amplitude of the box far above its resonance, m.
    #[must_use]
    pub fn throw_m(&self) -> f64 {
        self.places_m.len() as f64 * self.moment_kgm() / self.mass_kg()
    }

    /// Natural frequency of the box on its springs without damping, rad/s.
    #[must_use]
    pub fn natural_rad_s(&self) -> f64 {
        (self.stiffness_n_per_m / self.mass_kg()).sqrt()
    }

    fn damping_ns_per_m(&self) -> f64 {
        2.0 * self.zeta * self.mass_kg() * self.natural_rad_s()
    }
}

impl Machine for Screen {
    fn name(&self) -> &'static str {
        NAME
    }

    fn law(&self) -> SquareLaw {
        SquareLaw::of_length(self.throw_m())
    }

    fn shown(&self) -> Shown {
        Shown::Displacement("box")
    }

    fn about_amax(&self, _: Option<f64>) -> Option<String> {
        Some(
            "Here amax is the throw times the squared speed, the acceleration of the box far above its resonances."
                .to_owned(),
        )
    }

    fn draw(&self, _: &str, _: &[AxisSettings]) -> String {
        drawing::draw(self)
    }

    fn motion(&self, level: Fidelity) -> &'static str {
        match level {
            Fidelity::Phased => {
                "torque moves each shaft on its own, and the box moves on its springs"
            }
            _ => "only a fault moves a shaft off its command",
        }
    }

    fn left_out(&self, level: Fidelity) -> String {
        match level {
            Fidelity::Phased => "stones that leave the deck, belts, and large pitch angles",
            _ => {
                "torque, and the transient motion of the box: shafts are at their commanded phases"
            }
        }
        .to_owned()
    }

    fn pitches(&self) -> bool {
        true
    }

    fn plant(self: Arc<Self>) -> Option<Arc<dyn Plant>> {
        Some(self)
    }
}

impl Plant for Screen {
    fn pose(&self, turns: &[f64], omega_rad_s: f64, _: f64) -> Pose {
        let steady = self.steady(turns, omega_rad_s);
        let z_m = steady.across.im;
        Pose {
            z_m,
            accel_mps2: -omega_rad_s * omega_rad_s * z_m,
            pitch_mrad: 1e3 * steady.pitch.im,
            ..Pose::default()
        }
    }

    fn positions(&self) -> usize {
        self.places_m.len() + 3
    }

    fn rest(&self, positions: &mut [f64]) {
        positions[self.places_m.len()..].fill(0.0);
    }

    fn accelerations(&self, shafts: &Shafts<'_>, q: &[f64], v: &[f64], a: &mut [f64]) {
        let n = self.places_m.len();
        let (moment, block) = (self.moment_kgm(), self.block_kg);
        let damping = self.damping_ns_per_m();
        let square = self.springs_m * self.springs_m;
        let mut mass = Matrix3::from_diagonal(&Vector3::new(
            self.mass_kg(),
            self.mass_kg(),
            self.pitch_kgm2,
        ));
        let mut force = Vector3::new(
            -self.stiffness_n_per_m * q[n] - damping * v[n],
            -self.stiffness_n_per_m * q[n + 1] - damping * v[n + 1],
            -square * (self.stiffness_n_per_m * q[n + 2] + damping * v[n + 2]),
        );
        // Each shaft pulls the box along the direction in which φ″ moves its block. An unlocked shaft yields to it.
        let mut directions = [(Vector3::zeros(), 0.0); crate::dynamics::MAX];
        for (i, &place) in self.places_m.iter().enumerate() {
            let (sine, cosine) = q[i].sin_cos();
            mass[(1, 2)] += block * place;
            mass[(2, 1)] += block * place;
            mass[(2, 2)] += block * place * place;
            let central = moment * v[i] * v[i];
            force += central * Vector3::new(cosine, sine, sine * place);
            let along = moment * Vector3::new(-sine, cosine, cosine * place);
            let inertia = shafts.rotors_kgm2[i] + block * self.eccentricity_m * self.eccentricity_m;
            let free = if shafts.held[i] {
                0.0
            } else {
                (shafts.torques_nm[i] - moment * self.gravity_mps2 * cosine) / inertia
            };
            force -= along * free;
            if !shafts.held[i] {
                mass -= along * along.transpose() / inertia;
            }
            directions[i] = (along / inertia, free);
        }
        let moved = mass.lu().solve(&force).unwrap_or_else(Vector3::zeros);
        for (i, (direction, free)) in directions[..n].iter().enumerate() {
            a[i] = if shafts.held[i] {
                0.0
            } else {
                free - direction.dot(&moved)
            };
        }
        a[n..n + 3].copy_from_slice(moved.as_slice());
    }

    fn moved(&self, q: &[f64], v: &[f64], a: &[f64]) -> PlaneMotion {
        let n = self.places_m.len();
        let of = |values: &[f64]| [values[n + 1], values[n + 2], 0.0];
        PlaneMotion {
            place: of(q),
            rate: of(v),
            acceleration: of(a),
        }
    }

    fn energy_j(&self, rotors_kgm2: &[f64], q: &[f64], v: &[f64]) -> f64 {
        let n = self.places_m.len();
        let (moving, turning) = (v[n] * v[n] + v[n + 1] * v[n + 1], v[n + 2] * v[n + 2]);
        let mut energy = 0.5 * (self.box_kg * moving + self.pitch_kgm2 * turning);
        let springs = q[n] * q[n]
            + q[n + 1] * q[n + 1]
            + self.springs_m * self.springs_m * q[n + 2] * q[n + 2];
        energy += 0.5 * self.stiffness_n_per_m * springs;
        for (i, &place) in self.places_m.iter().enumerate() {
            let (sine, cosine) = q[i].sin_cos();
            let along = v[n] - self.eccentricity_m * sine * v[i];
            let across = v[n + 1] + place * v[n + 2] + self.eccentricity_m * cosine * v[i];
            energy += 0.5 * self.block_kg * (along * along + across * across)
                + 0.5 * rotors_kgm2[i] * v[i] * v[i]
                + self.moment_kgm() * self.gravity_mps2 * sine;
        }
        energy
    }

    fn fastest_mode(&self) -> Mode {
        // Where blocks yield, they reduce the effective inertia of the box. The reduction is less than half, because their
        // mass is a part of it.
        let pitch = self.stiffness_n_per_m * self.springs_m * self.springs_m / self.pitch_kgm2;
        let omega_rad_s = (2.0 * pitch.max(self.stiffness_n_per_m / self.box_kg)).sqrt();
        Mode {
            omega_rad_s,
            zeta: self.zeta,
        }
    }

    fn record(&self) -> Box<dyn Record> {
        Box::new(ScreenRecord::new(self))
    }
}

#[cfg(test)]
mod tests;
