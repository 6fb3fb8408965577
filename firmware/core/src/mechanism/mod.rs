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

pub use crank_rocker::{
    COUPLER_RATIO, CRANK_RATIO, CrankRocker, CrankRockerSettings, GROUND_RATIO,
};
pub use kinematics::{Kinematics, Mechanism};
pub use scotch_yoke::{ScotchYoke, ScotchYokeSettings};
pub use slider_crank::{LAMBDA, SliderCrank, SliderCrankSettings};
pub use square_law::SquareLaw;

use core::hash::{Hash, Hasher};

use crate::problem::SettingsError;
use crate::units::{Amax, Turns};

/// Makes [`AnyMechanism`] and its settings from a list: text, name, settings type with its fields.
macro_rules! mechanisms {
    ($($(#[$doc:meta])* $Name:ident($Settings:ident { $($field:ident),* })),* $(,)?) => {
        /// Settings of one mechanism, beside its crank radius.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
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

            /// Settings at the ends and in the middle of their ranges, for tests of all mechanisms.
            pub fn samples() -> impl Iterator<Item = Self> {
                core::iter::empty()$(.chain($Settings::SAMPLES.iter().copied().map(Self::$Name)))*
            }

            /// Passes each number of the settings, with its name.
            pub fn visit(&mut self, mut number: impl FnMut(&'static str, &mut f64)) {
                // Unused for settings without a number.
                let _ = &mut number;
                match self { $(Self::$Name($Settings { $($field),* }) => { $(number(stringify!($field), $field);)* })* }
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
    SliderCrank(SliderCrankSettings { lambda }),
    /// Scotch yokes: the platform moves as the sine of the crank angle.
    ScotchYoke(ScotchYokeSettings {}),
    /// Crank-rockers that drive screws under one platform.
    CrankRocker(CrankRockerSettings {
        crank,
        coupler,
        ground
    }),
}

impl AnyMechanism {
    /// Placeholder for a machine that is not set up yet.
    pub const STANDSTILL: Self = Self::ScotchYoke(ScotchYoke::STANDSTILL);
}
