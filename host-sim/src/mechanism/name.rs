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
    };
}

for_all_mechanisms!(names);
