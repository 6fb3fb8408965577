//! Mechanisms: what stands between a crank shaft and the platform.
//!
//! A mechanism converts an amplitude to the speed that gives it, and back. It also knows how the platform moves over the crank angle:
//! the torque of servos and the limit on tilt follow from that.
//!
//! To add a mechanism, write its file here, with its settings as they are in [`MechanismSettings`], and add one line to
//! [`mechanisms!`]. The tests in `conformance` then hold for it, too. What stands before (the program) and behind (the master shaft)
//! does not change.

#[cfg(test)]
mod conformance;
mod scotch_yoke;
mod slider_crank;
mod square_law;

pub use scotch_yoke::ScotchYoke;
pub use slider_crank::SliderCrank;
pub use square_law::SquareLaw;

use crate::settings::SettingsError;
use crate::units::{Amax, Turns};

/// How the platform moves over the crank angle, per unit crank radius, with 30 fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinematics {
    /// Travel of the platform per radian of the crank, −2 to 2.
    pub slope: i32,
    /// Change of that per radian, −2 to 2: acceleration at constant speed, per squared speed.
    pub curvature: i32,
}

/// What the controller needs to know of a mechanism.
pub trait Mechanism: Copy {
    /// The steady speed, turns a tick, that gives an acceleration amplitude.
    fn speed(&self, amax: Amax) -> Turns;

    /// The acceleration amplitude at a steady speed, turns a tick, of either sign.
    fn amax(&self, speed: Turns) -> Amax;

    /// The platform's motion at a crank angle, 2³² to the turn; the error is below 1e-6.
    fn kinematics(&self, angle: u32) -> Kinematics;

    /// The greatest slope over a turn: how far the platform's edge moves for a phase error of a crank. The error is below 1e-4.
    #[cold]
    fn greatest_slope(&self) -> f64 {
        // Smooth, with one maximum in each half turn: half a degree is fine enough.
        let angles = (0..720_u64).map(|half_degree| ((half_degree << 32) / 720) as u32);
        let slopes = angles.map(|angle| self.kinematics(angle).slope.unsigned_abs());
        f64::from(slopes.max().unwrap_or(0)) / f64::from(1 << 30)
    }
}

/// Makes [`AnyMechanism`] and its settings from a list: name, text, settings type.
macro_rules! mechanisms {
    ($($(#[$doc:meta])* $Name:ident($Settings:ty)),* $(,)?) => {
        /// The settings of one mechanism, beside its crank radius.
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
            /// The first that is wrong.
            #[cold]
            pub fn check(&self) -> Result<(), SettingsError> {
                match self { $(Self::$Name(settings) => settings.check(),)* }
            }

            /// The mechanism for a crank radius (m) and a tick rate (Hz), all of which have been checked.
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
}

pub use scotch_yoke::ScotchYokeSettings;
pub use slider_crank::SliderCrankSettings;

impl AnyMechanism {
    /// A mechanism for where there is no machine yet.
    pub const STANDSTILL: Self = Self::ScotchYoke(ScotchYoke::STANDSTILL);
}
