//! The list of all mechanisms, and their names in a scene.

use serde::{Deserialize, Serialize};

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
