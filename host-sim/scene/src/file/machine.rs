//! `[machine]`: the mechanism and its load; `[frame]`: the frame under it.

use serde::{Deserialize, Serialize};

use crate::SceneError;

/// Platform on cranks.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Mechanism between cranks and platform.
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
    /// Lead of the screw that a crank-rocker drives, mm per turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screw_lead_mm: Option<f64>,
    /// Length of a crank-rocker's crank over that of its rocker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crank_ratio: Option<f64>,
    /// Length of a crank-rocker's coupler over that of its rocker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupler_ratio: Option<f64>,
    /// Distance of a crank-rocker's pivots over the length of its rocker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_ratio: Option<f64>,
    /// Mass on the platform, kg.
    pub load_kg: f64,
    /// Orientation of the platform.
    #[serde(default)]
    pub platform: Platform,
    /// Gravity, m/s².
    #[serde(default = "standard_gravity")]
    pub gravity_mps2: f64,
    /// Radius of the mount circle of the cranks, mm.
    #[serde(default = "default_mount_radius_mm")]
    pub mount_radius_mm: f64,
    /// True to accept offsets and trims that tilt or warp the platform beyond its limits in each turn.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub allow_commanded_tilt: bool,
    /// Inertia of platform and load about a tilt axis, kg·m². The default is that of a uniform disc with the mount's radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_inertia_kgm2: Option<f64>,
    /// Stiffness of a rod with its bearings, N/µm.
    #[serde(default = "default_rod_stiffness")]
    pub rod_n_per_um: f64,
    /// Model of the rods, on levels where each crank is a rotor.
    #[serde(default)]
    pub rods: Rods,
    /// Damping ratio of the platform's heave on elastic rods.
    #[serde(default = "default_rod_zeta")]
    pub rod_zeta: f64,
}

impl Machine {
    /// Returns the keys that only some mechanisms have, and their values.
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

    /// Returns the value of one of these keys.
    ///
    /// # Errors
    /// The key is missing.
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

/// Model of the rods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rods {
    /// Rigid. If a platform on more than three cranks loads them, they have their static deflection.
    #[default]
    QuasiStatic,
    /// Springs, on which the platform oscillates.
    Elastic,
}

/// Frame that carries the cranks, on its suspension.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Mass of the frame and of everything bolted to it, kg.
    pub mass_kg: f64,
    /// Inertia about a tilt axis, kg·m². The default is that of a uniform disc with the mount's radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_inertia_kgm2: Option<f64>,
    /// Stiffness of the whole suspension in heave, N/mm.
    pub suspension_n_per_mm: f64,
    /// Damping ratio of the suspension with everything that it carries.
    #[serde(default = "default_suspension_zeta")]
    pub suspension_zeta: f64,
    /// Foundation block under the suspension; without it, the suspension is on the ground.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foundation: Option<Foundation>,
}

/// Foundation block on the ground.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Foundation {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Inertia about a tilt axis, kg·m². The default is that of a uniform disc with the mount's radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_inertia_kgm2: Option<f64>,
    /// Stiffness of the ground under it in heave, N/mm.
    pub ground_n_per_mm: f64,
    /// Damping ratio of the ground with everything that it carries.
    #[serde(default = "default_ground_zeta")]
    pub ground_zeta: f64,
}

/// Orientation of the platform.
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

/// Passes the list of all mechanisms to a macro: type, module, name in a scene.
#[macro_export]
macro_rules! for_all_mechanisms {
    ($make:ident) => {
        $make! {
            SliderCrank, slider_crank, "slider-crank";
            ScotchYoke, scotch_yoke, "scotch-yoke";
            CrankRocker, crank_rocker, "crank-rocker";
        }
    };
}

macro_rules! names {
    ($First:ident, $first:ident, $first_name:literal; $($Name:ident, $module:ident, $name:literal;)*) => {
        /// Name of a mechanism in a scene: `machine.mechanism`. The first of the list is the default.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
        pub enum MechanismName {
            #[doc = concat!("`\"", $first_name, "\"`")]
            #[default]
            #[serde(rename = $first_name)]
            $First,
            $(
                #[doc = concat!("`\"", $name, "\"`")]
                #[serde(rename = $name)]
                $Name,
            )*
        }

        impl MechanismName {
            /// Name in a scene.
            pub const fn name(self) -> &'static str {
                match self {
                    Self::$First => $first_name,
                    $(Self::$Name => $name,)*
                }
            }
        }
    };
}

for_all_mechanisms!(names);
