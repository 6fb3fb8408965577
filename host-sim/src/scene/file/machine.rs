//! `[machine]`: the mechanism and what it carries; `[frame]`: what it stands on.

use serde::{Deserialize, Serialize};

use crate::mechanism::MechanismName;
use crate::scene::SceneError;

/// A platform on cranks.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// What is between cranks and platform.
    #[serde(default)]
    pub mechanism: MechanismName,
    /// Crank radius of a slider-crank or a Scotch yoke, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crank_radius_mm: Option<f64>,
    /// Crank radius over rod length of a slider-crank; give this or `rod_length_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lambda: Option<f64>,
    /// Rod length of a slider-crank, mm; give this or `lambda`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rod_length_mm: Option<f64>,
    /// Lead of the screw that a crank-rocker drives, mm a turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screw_lead_mm: Option<f64>,
    /// Length of the crank of a crank-rocker over its rocker's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crank_ratio: Option<f64>,
    /// Length of its coupler over its rocker's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupler_ratio: Option<f64>,
    /// Distance of its two pivots over its rocker's length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_ratio: Option<f64>,
    /// Mass on the platform, kg.
    pub load_kg: f64,
    /// Which way up.
    #[serde(default)]
    pub platform: Platform,
    /// Gravity, m/s².
    #[serde(default = "standard_gravity")]
    pub gravity_mps2: f64,
    /// Radius of the circle on which the cranks stand, mm.
    #[serde(default = "default_mount_radius_mm")]
    pub mount_radius_mm: f64,
    /// Inertia of platform and load about a tilt axis, kg·m²; by default that of an even disc as wide as the mount.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_inertia_kgm2: Option<f64>,
    /// Stiffness of a rod with its bearings, N/µm.
    #[serde(default = "default_rod_stiffness")]
    pub rod_n_per_um: f64,
    /// What becomes of rods that are pushed and pulled, where each crank is its own rotor.
    #[serde(default)]
    pub rods: Rods,
    /// Damping of elastic rods, as a part of what is critical for the platform's heave on them.
    #[serde(default = "default_rod_zeta")]
    pub rod_zeta: f64,
}

impl Machine {
    /// Keys that not all mechanisms have, and their values.
    pub fn geometry(&self) -> [(&'static str, Option<f64>); 7] {
        [
            ("machine.crank_radius_mm", self.crank_radius_mm),
            ("machine.lambda", self.lambda),
            ("machine.rod_length_mm", self.rod_length_mm),
            ("machine.screw_lead_mm", self.screw_lead_mm),
            ("machine.crank_ratio", self.crank_ratio),
            ("machine.coupler_ratio", self.coupler_ratio),
            ("machine.ground_ratio", self.ground_ratio),
        ]
    }

    /// Value of one of these keys.
    ///
    /// # Errors
    /// It is missing.
    pub fn needed(&self, key: &str) -> Result<f64, SceneError> {
        let found = self.geometry().into_iter().find(|(known, _)| *known == key);
        found.and_then(|(_, value)| value).ok_or_else(|| {
            let problem = format!(
                "missing; machine.mechanism = \"{}\" needs it, so give it",
                self.mechanism.name()
            );
            SceneError::at(key, problem)
        })
    }
}

/// What becomes of rods that are pushed and pulled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rods {
    /// They are rigid; where a platform on more than three asks them to give, they have given.
    #[default]
    QuasiStatic,
    /// They are springs, on which the platform oscillates.
    Elastic,
}

/// The frame that carries the cranks, on its suspension.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Mass of the frame with all that is bolted to it, kg.
    pub mass_kg: f64,
    /// Its inertia about a tilt axis, kg·m²; by default that of an even disc as wide as the mount.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_inertia_kgm2: Option<f64>,
    /// Stiffness of the whole suspension in heave, N/mm.
    pub suspension_n_per_mm: f64,
    /// Its damping, as a part of what is critical for all that it carries.
    #[serde(default = "default_suspension_zeta")]
    pub suspension_zeta: f64,
    /// The block under the suspension; without it the suspension stands on the ground.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foundation: Option<Foundation>,
}

/// A foundation block on the ground.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Foundation {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Its inertia about a tilt axis, kg·m²; by default that of an even disc as wide as the mount.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_inertia_kgm2: Option<f64>,
    /// Stiffness of the ground under it in heave, N/mm.
    pub ground_n_per_mm: f64,
    /// Damping of the ground, as a part of what is critical for all that it carries.
    #[serde(default = "default_ground_zeta")]
    pub ground_zeta: f64,
}

/// Which way up the platform is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Platform {
    /// Above the cranks.
    #[default]
    Above,
    /// Below the cranks.
    Below,
}

impl From<Platform> for cophase_core::settings::Platform {
    fn from(platform: Platform) -> Self {
        match platform {
            Platform::Above => Self::Above,
            Platform::Below => Self::Below,
        }
    }
}

const fn standard_gravity() -> f64 {
    9.80665
}
const fn default_mount_radius_mm() -> f64 {
    250.0
}
const fn default_rod_stiffness() -> f64 {
    50.0
}
const fn default_rod_zeta() -> f64 {
    0.02
}
const fn default_suspension_zeta() -> f64 {
    0.05
}
const fn default_ground_zeta() -> f64 {
    0.1
}
