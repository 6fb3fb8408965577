//! `[machine]`: the mechanism and its load; `[frame]`: the frame under it.

use cophase_core::mechanism::{COUPLER_RATIO, CRANK_RATIO, GROUND_RATIO, LAMBDA};
use cophase_core::settings::key::{Key, Kind, Value, needed, optional, or, or_value};
use cophase_core::settings::rows::{CRANK_RADIUS_MM, GRAVITY_MPS2, LOAD_KG, MOUNT_RADIUS_MM};
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

/// Rod lengths for which λ is in its range.
const ROD_LENGTH_MM: Key = optional("60")
    .from(
        CRANK_RADIUS_MM.low / LAMBDA.high,
        CRANK_RADIUS_MM.high / LAMBDA.low,
    )
    .at_least(1.0 / LAMBDA.high, &[("machine.crank_radius_mm", 1)])
    .at_most(1.0 / LAMBDA.low, &[("machine.crank_radius_mm", 1)])
    .because("1.67 to 10 crank radii");

/// Leads whose travel per radian the core accepts as a crank radius, rounded inwards.
const SCREW_LEAD_MM: Key = optional("30").from(0.63, 3000.0);

keys! {
    /// Platform on cranks.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Machine {
        /// Mechanism between cranks and platform.
        mechanism: MechanismName = or_value("slider-crank"),
        /// Crank radius of a slider-crank or a Scotch yoke, mm.
        crank_radius_mm: Option<f64> = CRANK_RADIUS_MM,
        /// Crank radius over rod length of a slider-crank; give this or `rod_length_mm`.
        lambda: Option<f64> = LAMBDA,
        /// Rod length of a slider-crank, mm; give this or `lambda`.
        rod_length_mm: Option<f64> = ROD_LENGTH_MM,
        /// Lead of the screw that a crank-rocker drives, mm per turn.
        screw_lead_mm: Option<f64> = SCREW_LEAD_MM,
        /// Length of a crank-rocker's crank over that of its rocker.
        crank_ratio: Option<f64> = CRANK_RATIO,
        /// Length of a crank-rocker's coupler over that of its rocker.
        coupler_ratio: Option<f64> = COUPLER_RATIO,
        /// Distance of a crank-rocker's pivots over the length of its rocker.
        ground_ratio: Option<f64> = GROUND_RATIO,
        /// Mass on the platform, kg.
        load_kg: f64 = LOAD_KG,
        /// Orientation of the platform.
        platform: Platform = or_value("above"),
        /// Gravity, m/s².
        gravity_mps2: f64 = GRAVITY_MPS2,
        /// Radius of the mount circle of the cranks, mm.
        mount_radius_mm: f64 = MOUNT_RADIUS_MM,
        /// True to accept offsets and trims that tilt or warp the platform beyond its limits in each turn.
        allow_commanded_tilt: bool = or_value("false"),
        /// Inertia of platform and load about a tilt axis, kg·m². The default is that of a uniform disc with the mount's radius.
        tilt_inertia_kgm2: Option<f64> = optional("0.1").from(1e-6, 1000.0),
        /// Stiffness of a rod with its bearings, N/µm.
        rod_n_per_um: f64 = or(50.0).from(0.01, 10_000.0),
        /// Model of the rods, on levels where each crank is a rotor.
        rods: Rods = or_value("quasi-static"),
        /// Damping ratio of the platform's heave on elastic rods.
        rod_zeta: f64 = or(0.02).from(0.0, 2.0),
    }
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
}

words! {
    /// Model of the rods.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Rods {
        /// Rigid. If a platform on more than three cranks loads them, they have their static deflection.
        QuasiStatic = "quasi-static",
        /// Springs, on which the platform oscillates.
        Elastic = "elastic",
    }
}

keys! {
    /// Frame that carries the cranks, on its suspension.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Frame {
        /// Mass of the frame and of everything bolted to it, kg.
        mass_kg: f64 = needed("55").from(0.01, 1e6),
        /// Inertia about a tilt axis, kg·m². The default is that of a uniform disc with the mount's radius.
        tilt_inertia_kgm2: Option<f64> = optional("0.6").from(1e-6, 1e7),
        /// Stiffness of the whole suspension in heave, N/mm.
        suspension_n_per_mm: f64 = needed("60").from(1e-3, 1e9),
        /// Damping ratio of the suspension with everything that it carries.
        suspension_zeta: f64 = or(0.05).from(0.0, 2.0),
        /// Foundation block under the suspension; without it, the suspension is on the ground.
        foundation: Option<Foundation> = optional(""),
    }
}

keys! {
    /// Foundation block on the ground.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Foundation {
        /// Mass, kg.
        mass_kg: f64 = needed("200").from(0.01, 1e6),
        /// Inertia about a tilt axis, kg·m². The default is that of a uniform disc with the mount's radius.
        tilt_inertia_kgm2: Option<f64> = optional("3").from(1e-6, 1e7),
        /// Stiffness of the ground under it in heave, N/mm.
        ground_n_per_mm: f64 = needed("20000").from(1e-3, 1e9),
        /// Damping ratio of the ground with everything that it carries.
        ground_zeta: f64 = or(0.1).from(0.0, 2.0),
    }
}

words! {
    /// Orientation of the platform.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Platform {
        /// Above the cranks.
        Above = "above",
        /// Below the cranks.
        Below = "below",
    }
}

impl From<Platform> for cophase_core::settings::Platform {
    fn from(platform: Platform) -> Self {
        match platform {
            Platform::Above => Self::Above,
            Platform::Below => Self::Below,
        }
    }
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
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
        pub enum MechanismName {
            #[doc = concat!("`\"", $first_name, "\"`")]
            #[serde(rename = $first_name)]
            $First,
            $(
                #[doc = concat!("`\"", $name, "\"`")]
                #[serde(rename = $name)]
                $Name,
            )*
        }

        impl Value for MechanismName {
            const KIND: Kind = Kind::Word(&[$first_name, $($name),*]);
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
