//! Jaw crusher: one shaft with a flywheel, whose eccentric swings a jaw. The source is a Chinese paper on the dynamic
//! design of its flywheel.
//!
//! Equations and linkage are those of [`mains`], which is verified against the source's
//! figures. With the shaft angle φ, the inertia J of flywheel and rotor, and that of the jaw Je(φ):
//!
//! ```text
//! (J + Je) φ″ + φ′²/2 dJe/dφ = torque − friction − rock(φ)
//! ```
//!
//! Rock is fed between two turns of the shaft, counted from power-up, because a crusher starts and stops empty. Rock brakes
//! a shaft that turns forward, and does not push one back. So it acts as dry friction does, in one direction: against a shaft at
//! rest it has no more than the applied torque.
//!
//! The length that the controller gets is max |z″(φ)|, where z is the displacement of the jaw
//! at the point of the rock's force. So the program's amax is the largest acceleration of the jaw at that point.
//!
//! Not modelled: the motor's electrical transients, slip of the belt, the weight of the jaw, and a rock force that depends
//! on the jaw's speed.

mod drawing;
pub mod mains;
mod record;
mod table;

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use cophase_core::settings::AxisSettings;
use cophase_scene::file::Fidelity;

use crate::dynamics::PlaneMotion;
use crate::dynamics::plant::{Plant, Record, Shafts};
use crate::machines::{Machine, Shown};
use crate::mechanism::SquareLaw;
use crate::pose::Pose;
use mains::{Jaw, Linkage, Load};
use record::CrusherRecord;

/// Name with its article.
const NAME: &str = "a jaw crusher";

/// Shaft with flywheel, jaw and rock.
#[derive(Clone, Debug, PartialEq)]
pub struct Crusher {
    /// Geometry.
    pub linkage: Linkage,
    /// Jaw.
    pub jaw: Jaw,
    /// Load by the rock, in a turn in which it is fed.
    pub load: Load,
    /// Range of the shaft's angle since power-up in which rock is fed, rad.
    pub fed_rad: Range<f64>,
    /// Inertia of flywheel and rotor, kg·m².
    pub flywheel_kgm2: f64,
    /// Largest torque of the motor, N·m. `None` if the scene gives none.
    pub motor_nm: Option<f64>,
}

/// Number of angles at which a turn is sampled.
const SAMPLES: u32 = 720;

impl Crusher {
    /// Displacement of the jaw towards the rock at the point of the force, m, and its first and second derivative by the
    /// shaft's angle. The direction is perpendicular to the line of the jaw at angle 0.
    fn jaw_m(&self, phi_rad: f64) -> [f64; 3] {
        let (e, f) = (self.linkage.eccentric_m, self.linkage.force_m);
        let across = self.linkage.at(0.0).jaw_rad;
        let angles = self.linkage.at(phi_rad);
        let (shaft, jaw) = (phi_rad - across, angles.jaw_rad - across);
        let (slope, curvature) = (angles.jaw_slope, angles.jaw_curvature);
        [
            e * shaft.sin() + f * jaw.sin(),
            e * shaft.cos() + f * slope * jaw.cos(),
            -e * shaft.sin() + f * (curvature * jaw.cos() - slope * slope * jaw.sin()),
        ]
    }

    /// Largest acceleration of the jaw over the squared speed of the shaft, m.
    #[must_use]
    pub fn amplitude_m(&self) -> f64 {
        samples()
            .map(|phi_rad| self.jaw_m(phi_rad)[2].abs())
            .fold(0.0, f64::max)
    }

    /// Largest torque of the rock on the shaft, N·m.
    #[must_use]
    pub fn rock_nm(&self) -> f64 {
        samples()
            .map(|phi_rad| self.load.torque_nm(&self.linkage, phi_rad))
            .fold(0.0, f64::max)
    }

    /// Work to break rock in one turn, J.
    #[must_use]
    pub fn work_j(&self) -> f64 {
        let torques = samples().map(|phi_rad| self.load.torque_nm(&self.linkage, phi_rad));
        torques.sum::<f64>() * TAU / f64::from(SAMPLES)
    }
}

/// Angles over a turn, rad: the midpoints of [`SAMPLES`] intervals.
fn samples() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(|i| TAU * (f64::from(i) + 0.5) / f64::from(SAMPLES))
}

impl Machine for Crusher {
    fn name(&self) -> &'static str {
        NAME
    }

    fn law(&self) -> SquareLaw {
        SquareLaw::of_length(self.amplitude_m())
    }

    fn shown(&self) -> Shown {
        Shown::Displacement("jaw")
    }

    fn about_amax(&self, _: Option<f64>) -> Option<String> {
        Some(
            "Here amax is one component of the acceleration of the jaw where the rock's force acts: that across the jaw, at a constant speed."
                .to_owned(),
        )
    }

    fn draw(&self, _: &str, _: &[AxisSettings]) -> String {
        drawing::draw(self)
    }

    fn motion(&self, level: Fidelity) -> &'static str {
        match level {
            Fidelity::Phased => "torque moves the shaft",
            _ => "only a fault moves the shaft off its command",
        }
    }

    fn left_out(&self, level: Fidelity) -> String {
        match level {
            Fidelity::Phased => {
                "electrical transients of the motor, slip of the belt, and the jaw's weight"
            }
            _ => "torque, rock, and how the speed varies over a turn: the shaft is where commanded",
        }
        .to_owned()
    }

    fn plant(self: Arc<Self>) -> Option<Arc<dyn Plant>> {
        Some(self)
    }
}

impl Plant for Crusher {
    fn pose(&self, turns: &[f64], omega_rad_s: f64, acceleration_rad_s2: f64) -> Pose {
        let [z_m, slope, curvature] = self.jaw_m(turns[0] * TAU);
        Pose {
            z_m,
            accel_mps2: curvature * omega_rad_s * omega_rad_s + slope * acceleration_rad_s2,
            ..Pose::default()
        }
    }

    fn positions(&self) -> usize {
        1
    }

    fn rest(&self, _: &mut [f64]) {}

    fn accelerations(&self, shafts: &Shafts<'_>, q: &[f64], v: &[f64], a: &mut [f64]) {
        if shafts.held[0] {
            a[0] = 0.0;
            return;
        }
        let (jaw_kgm2, slope) = self.jaw.inertia_kgm2(&self.linkage, q[0]);
        a[0] =
            (shafts.torques_nm[0] - 0.5 * v[0] * v[0] * slope) / (shafts.rotors_kgm2[0] + jaw_kgm2);
    }

    fn moved(&self, q: &[f64], v: &[f64], a: &[f64]) -> PlaneMotion {
        let [z_m, slope, curvature] = self.jaw_m(q[0]);
        PlaneMotion {
            place: [z_m, 0.0, 0.0],
            rate: [slope * v[0], 0.0, 0.0],
            acceleration: [curvature * v[0] * v[0] + slope * a[0], 0.0, 0.0],
        }
    }

    fn energy_j(&self, rotors_kgm2: &[f64], q: &[f64], v: &[f64]) -> f64 {
        let (jaw_kgm2, _) = self.jaw.inertia_kgm2(&self.linkage, q[0]);
        0.5 * (rotors_kgm2[0] + jaw_kgm2) * v[0] * v[0]
    }

    fn resistance_nm(&self, _: usize, q: &[f64]) -> Option<f64> {
        Some(if self.fed_rad.contains(&q[0]) {
            self.load.torque_nm(&self.linkage, q[0])
        } else {
            0.0
        })
    }

    fn record(&self) -> Box<dyn Record> {
        Box::new(CrusherRecord::new(self))
    }
}

#[cfg(test)]
mod tests;
