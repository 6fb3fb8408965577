//! Names of the mechanisms in a scene.

use serde::{Deserialize, Serialize};

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
