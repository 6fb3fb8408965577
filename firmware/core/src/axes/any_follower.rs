//! Registry of the followers.
//!
//! To add a follower, write its file here, with its settings as they are in [`FollowerSettings`], and add one line to the list
//! `followers!`. The tests in `conformance` then cover it, too. See `docs/recipes/add-a-follower.md`.

use core::hash::{Hash, Hasher};

use super::bounds::Bounds;
use super::cam_table::{CamSettings, CamTable, CamTableSettings};
use super::cams::Cams;
use super::follower::Follower;
use super::gear::{Gear, GearSettings};
use crate::problem::SettingsError;
use crate::units::Turns;

/// Makes [`AnyFollower`] and its settings from a list: name, text, settings type.
macro_rules! followers {
    ($($(#[$doc:meta])* $Name:ident($Settings:ty)),* $(,)?) => {
        /// Settings of the follower of one axis.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
        pub enum FollowerSettings {
            $($(#[$doc])* $Name($Settings),)*
        }

        /// Any of the followers.
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub enum AnyFollower {
            $($(#[$doc])* $Name($Name),)*
        }

        impl FollowerSettings {
            /// Checks every number, also against the cam tables of the machine.
            ///
            /// # Errors
            /// The first number that is wrong.
            #[cold]
            pub fn check(&self, cams: &[CamSettings]) -> Result<(), SettingsError> {
                match self { $(Self::$Name(own) => own.check(cams),)* }
            }

            /// Creates the follower of checked settings, at the master's phase 0.
            #[cold]
            pub fn follower(&self, cams: &Cams) -> AnyFollower {
                match self { $(Self::$Name(own) => AnyFollower::$Name($Name::new(own, cams)),)* }
            }

            /// Error of an axis that would be too fast, at the key that is to be changed. `speed_hz` is the greatest speed of the axis, and
            /// `master_hz` that of the master, rev/s.
            #[cold]
            pub fn too_fast(&self, error: SettingsError, master_hz: f64, speed_hz: f64) -> SettingsError {
                match self { $(Self::$Name(own) => own.too_fast(error, master_hz, speed_hz),)* }
            }

            /// Upper bound on the turns of the axis per turn of the master. It needs little memory, and may be some percent too high.
            #[cold]
            pub fn max_ratio(&self, cams: &[CamSettings]) -> f64 {
                match self { $(Self::$Name(own) => own.max_ratio(cams),)* }
            }
        }

        impl Follower for AnyFollower {
            fn advance(&mut self, master: Turns, cams: &Cams) -> Turns {
                match self { $(Self::$Name(follower) => follower.advance(master, cams),)* }
            }

            fn acceleration(&self, speed: Turns, acceleration: Turns, cams: &Cams) -> Turns {
                match self { $(Self::$Name(follower) => follower.acceleration(speed, acceleration, cams),)* }
            }

            fn hash_constants(&self, hasher: &mut impl Hasher) {
                core::mem::discriminant(self).hash(hasher);
                match self { $(Self::$Name(follower) => follower.hash_constants(hasher),)* }
            }

            fn is_direct(&self) -> bool {
                match self { $(Self::$Name(follower) => follower.is_direct(),)* }
            }

            #[cold]
            fn start(&self) -> Turns {
                match self { $(Self::$Name(follower) => follower.start(),)* }
            }

            #[cold]
            fn bounds(&self, master: &Bounds, cams: &Cams) -> Bounds {
                match self { $(Self::$Name(follower) => follower.bounds(master, cams),)* }
            }

            #[cold]
            fn allows_index(&self, cams: &Cams) -> bool {
                match self { $(Self::$Name(follower) => follower.allows_index(cams),)* }
            }
        }
    };
}

followers! {
    /// Electronic gear with an exact ratio.
    Gear(GearSettings),
    /// Cam table: position over one turn of the master.
    CamTable(CamTableSettings),
}

impl FollowerSettings {
    /// Gear that makes the master's own turns.
    pub const DIRECT: Self = Self::gear((1, 1));

    /// Gear of a ratio, numerator and denominator.
    pub const fn gear((numerator, denominator): (u32, u32)) -> Self {
        Self::Gear(GearSettings {
            numerator,
            denominator,
        })
    }

    /// Phase of the axis's table at the master's phase 0, turns; zero without a table.
    pub const fn shift_turns(&self) -> f64 {
        match self {
            Self::Gear(_) => 0.0,
            Self::CamTable(cam) => cam.shift_turns,
        }
    }

    /// Key that makes the axis turn otherwise than the master, if one does.
    pub const fn key_of_own_turns(&self) -> Option<&'static str> {
        match self {
            Self::Gear(gear) if gear.numerator == gear.denominator => None,
            Self::Gear(_) => Some("axes.ratio"),
            Self::CamTable(_) => Some("axes.cam"),
        }
    }

    /// Turns of the axis per turn of the master, if that is the same at every phase.
    pub fn constant_ratio(&self) -> Option<f64> {
        match self {
            Self::Gear(gear) => Some(gear.ratio()),
            Self::CamTable(_) => None,
        }
    }
}
