//! Machine that the axes move: cranks under one platform, or shafts with a length.
//!
//! Only a platform tilts and warps, and has a mechanism and a load. For shafts without one, the controller knows how their amplitude
//! follows from their speed, and that they are to keep their phases to each other.

use cophase_motion::settings::inside;

use super::rows::{CRANK_RADIUS_MM, GRAVITY_MPS2, LOAD_KG, MOUNT_RADIUS_MM};
use crate::mechanism::{AnyMechanism, Mechanism, MechanismSettings, ScotchYokeSettings};
use crate::problem::SettingsError;

/// Side of the cranks on which the platform is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub enum Platform {
    /// Below the cranks: at phase 0 gravity adds to the greatest acceleration, as in the patent.
    Below,
    /// Above the cranks.
    Above,
}

impl Platform {
    /// Sign of gravity relative to the platform's acceleration in the force on the rods: +1 below, −1 above.
    pub const fn gravity_sign(self) -> f64 {
        match self {
            Self::Below => 1.0,
            Self::Above => -1.0,
        }
    }
}

/// Machine that the axes move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub enum MachineSettings {
    /// Cranks under one platform, which tilts when they are apart.
    Platform(PlatformSettings),
    /// Shafts without a platform, which keep their phases to each other.
    Shafts(ShaftSettings),
}

/// Shafts without a platform: those of a screen, a crusher, an arm, or a cam.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct ShaftSettings {
    /// Amplitude amax over the squared speed of the shafts, metres, 0.1 mm to 1 m.
    pub length_m: f64,
}

/// Platform on cranks: mechanism, load and place of the cranks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct PlatformSettings {
    /// Crank radius, metres, 0.1 mm to 0.5 m.
    pub crank_radius_m: f64,
    /// Mechanism between crank and platform.
    pub mechanism: MechanismSettings,
    /// Mass on the platform, kg, above 0, up to 50.
    pub load_kg: f64,
    /// Side of the platform.
    pub platform: Platform,
    /// Gravity, m/s², 0 to 20.
    pub gravity_mps2: f64,
    /// Radius of the circle on which the cranks stand, metres, 10 mm to 5 m.
    pub mount_radius_m: f64,
    /// True to accept commanded phases that tilt or warp the platform beyond its limits.
    pub allow_commanded_tilt: bool,
}

impl MachineSettings {
    /// Mechanism of the machine, for a tick rate. Shafts have the amplitude of a Scotch yoke.
    #[cold]
    pub fn mechanism(&self, tick_hz: u32) -> AnyMechanism {
        match self {
            Self::Platform(platform) => platform
                .mechanism
                .mechanism(platform.crank_radius_m, tick_hz),
            Self::Shafts(ShaftSettings { length_m }) => {
                MechanismSettings::ScotchYoke(ScotchYokeSettings {}).mechanism(*length_m, tick_hz)
            }
        }
    }

    /// The platform, if there is one.
    pub const fn platform(&self) -> Option<&PlatformSettings> {
        match self {
            Self::Platform(platform) => Some(platform),
            Self::Shafts(_) => None,
        }
    }

    /// Tilt of the platform, at the worst crank angle, per turn by which its cranks are apart in the first mode: s(α) R/ρ, with the
    /// mechanism's slope s, the crank radius R and the mount radius ρ, mrad. Zero without a platform.
    #[cold]
    pub fn tilt_mrad_per_turn(&self, tick_hz: u32) -> f64 {
        self.platform().map_or(0.0, |platform| {
            1e3 * core::f64::consts::TAU
                * platform.crank_radius_m
                * self.mechanism(tick_hz).max_slope()
                / platform.mount_radius_m
        })
    }

    /// Checks every number.
    ///
    /// # Errors
    /// The first number that is wrong.
    #[cold]
    pub fn check(&self) -> Result<(), SettingsError> {
        match self {
            Self::Platform(platform) => platform.check(),
            Self::Shafts(ShaftSettings { length_m }) => {
                inside("machine.length_mm", length_m * 1e3, 0.1, 1000.0)?;
                Ok(())
            }
        }
    }
}

impl PlatformSettings {
    #[cold]
    fn check(&self) -> Result<(), SettingsError> {
        CRANK_RADIUS_MM.check("machine.crank_radius_mm", self.crank_radius_m * 1e3)?;
        self.mechanism.check()?;
        LOAD_KG.check("machine.load_kg", self.load_kg)?;
        GRAVITY_MPS2.check("machine.gravity_mps2", self.gravity_mps2)?;
        MOUNT_RADIUS_MM.check("machine.mount_radius_mm", self.mount_radius_m * 1e3)?;
        Ok(())
    }
}
