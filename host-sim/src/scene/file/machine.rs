//! `[machine]`: the mechanism and what it carries.

use serde::{Deserialize, Serialize};

/// The slider-crank platform.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Crank radius, mm.
    pub crank_radius_mm: f64,
    /// Crank radius over rod length; give this or `rod_length_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lambda: Option<f64>,
    /// Rod length, mm; give this or `lambda`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rod_length_mm: Option<f64>,
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
