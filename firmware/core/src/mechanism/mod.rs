//! Mechanisms between crank shaft and platform.
//!
//! A mechanism converts an amplitude to the speed that gives it, and back. It also gives the motion of the platform over
//! the crank angle, from which the torque of servos and the limit on tilt follow.
//!
//! To add a mechanism, write its file here, with its settings as they are in [`MechanismSettings`], and add one line to
//! the list `mechanisms!`. The tests in `conformance` then cover it, too. The program before it and the master shaft behind it do
//! not change.

#[cfg(test)]
mod conformance;
mod crank_rocker;
mod kinematics;
mod scotch_yoke;
mod slider_crank;
mod square_law;

pub use crank_rocker::CrankRocker;
pub use kinematics::{Kinematics, Mechanism};
pub use scotch_yoke::ScotchYoke;
pub use slider_crank::SliderCrank;
pub use square_law::SquareLaw;

use core::hash::{Hash, Hasher};

use crate::problem::SettingsError;
use crate::units::{Amax, Turns};

/// Makes [`AnyMechanism`] and its settings from a list: name, text, settings type.
macro_rules! mechanisms {
    ($($(#[$doc:meta])* $Name:ident($Settings:ty)),* $(,)?) => {
        /// Settings of one mechanism, beside its crank radius.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum MechanismSettings {
            $($(#[$doc])* $Name($Settings),)*
        }

        /// Any of the mechanisms, for one crank radius and tick rate.
        #[derive(Clone, Copy, Debug)]
        pub enum AnyMechanism {
            $($(#[$doc])* $Name($Name),)*
        }

        impl MechanismSettings {
            /// Checks every number.
            ///
            /// # Errors
            /// The first number that is wrong.
            #[cold]
            pub fn check(&self) -> Result<(), SettingsError> {
                match self { $(Self::$Name(settings) => settings.check(),)* }
            }

            /// Mechanism for a crank radius (m) and a tick rate (Hz), all of which must have been checked.
            #[cold]
            pub fn mechanism(&self, crank_radius_m: f64, tick_hz: u32) -> AnyMechanism {
                match self {
                    $(Self::$Name(settings) => AnyMechanism::$Name($Name::new(settings, crank_radius_m, tick_hz)),)*
                }
            }
        }

        impl Mechanism for AnyMechanism {
            fn speed(&self, amax: Amax) -> Turns {
                match self { $(Self::$Name(mechanism) => mechanism.speed(amax),)* }
            }

            fn amax(&self, speed: Turns) -> Amax {
                match self { $(Self::$Name(mechanism) => mechanism.amax(speed),)* }
            }

            #[inline(always)]
            fn hash_half(&self, second: bool, hasher: &mut impl Hasher) {
                if !second {
                    core::mem::discriminant(self).hash(hasher);
                }
                match self { $(Self::$Name(mechanism) => mechanism.hash_half(second, hasher),)* }
            }

            #[cfg_attr(not(feature = "servo"), cold)] // Without setpoints it is for set-up alone.
            fn kinematics(&self, angle: u32) -> Kinematics {
                match self { $(Self::$Name(mechanism) => mechanism.kinematics(angle),)* }
            }
        }
    };
}

mechanisms! {
    /// In-line slider-cranks under one platform.
    SliderCrank(slider_crank::SliderCrankSettings),
    /// Scotch yokes: the platform moves as the sine of the crank angle.
    ScotchYoke(scotch_yoke::ScotchYokeSettings),
    /// Crank-rockers that drive screws under one platform.
    CrankRocker(crank_rocker::CrankRockerSettings),
}

pub use crank_rocker::CrankRockerSettings;
pub use scotch_yoke::ScotchYokeSettings;
pub use slider_crank::SliderCrankSettings;

impl AnyMechanism {
    /// Placeholder for a machine that is not set up yet.
    pub const STANDSTILL: Self = Self::ScotchYoke(ScotchYoke::STANDSTILL);
}
