//! Enum over all mechanisms, for the one that a scene names.

use cophase_core::mechanism::MechanismSettings;
use cophase_scene::SceneError;
use cophase_scene::file::Machine;
use cophase_scene::file::MechanismName;
use cophase_scene::for_all_mechanisms;

use super::{AtAngle, Configured, Mechanism, Mount};

macro_rules! any {
    ($($Name:ident, $module:ident, $name:literal;)*) => {
        $(use super::$module::$Name;)*

        /// One of the mechanisms.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyMechanism {
            $(
                #[doc = concat!("`\"", $name, "\"`")]
                $Name($Name),
            )*
        }

        $(
            impl From<$Name> for AnyMechanism {
                fn from(mechanism: $Name) -> Self {
                    Self::$Name(mechanism)
                }
            }
        )*

        impl Configured for AnyMechanism {
            type Settings = MechanismSettings;

            const KEYS: &'static [&'static str] = &[];

            fn radius_m(machine: &Machine) -> Result<f64, SceneError> {
                match machine.mechanism {
                    $(MechanismName::$Name => $Name::radius_m(machine),)*
                }
            }

            fn settings(machine: &Machine) -> Result<MechanismSettings, SceneError> {
                let keys = match machine.mechanism {
                    $(MechanismName::$Name => $Name::KEYS,)*
                };
                let given = machine.geometry().into_iter().filter(|(_, value)| value.is_some());
                if let Some((key, _)) = given.into_iter().find(|(key, _)| !keys.contains(key)) {
                    let has_it = [$(($name, $Name::KEYS),)*];
                    let has_it = has_it.iter().filter(|(_, keys)| keys.contains(&key));
                    let others: Vec<_> = has_it.map(|(name, _)| format!("\"{name}\"")).collect();
                    let own: Vec<_> = keys.iter().map(|key| key.trim_start_matches("machine.")).collect();
                    return Err(SceneError::for_key(
                        key,
                        format!(
                            "is no dimension of machine.mechanism = \"{}\", which has {}; leave it out, or let machine.mechanism be {}",
                            machine.mechanism.name(),
                            own.join(", "),
                            others.join(" or ")
                        ),
                    ));
                }
                Ok(match machine.mechanism {
                    $(MechanismName::$Name => MechanismSettings::$Name($Name::settings(machine)?),)*
                })
            }

            fn from_settings(settings: &MechanismSettings, crank_radius_m: f64) -> Self {
                match settings {
                    $(MechanismSettings::$Name(settings) => Self::$Name($Name::from_settings(settings, crank_radius_m)),)*
                }
            }
        }

        impl Mechanism for AnyMechanism {
            fn crank_radius_m(&self) -> f64 {
                match self { $(Self::$Name(mechanism) => mechanism.crank_radius_m(),)* }
            }

            #[inline(always)] // the equations of motion call it in each evaluation
            fn at_each<const N: usize>(&self, alpha_rad: &[f64; N]) -> [AtAngle; N] {
                match self { $(Self::$Name(mechanism) => mechanism.at_each(alpha_rad),)* }
            }

            fn x_m(&self, alpha_rad: f64) -> f64 {
                match self { $(Self::$Name(mechanism) => mechanism.x_m(alpha_rad),)* }
            }

            fn s(&self, alpha_rad: f64) -> f64 {
                match self { $(Self::$Name(mechanism) => mechanism.s(alpha_rad),)* }
            }

            fn h(&self, alpha_rad: f64) -> f64 {
                match self { $(Self::$Name(mechanism) => mechanism.h(alpha_rad),)* }
            }

            fn s_and_h(&self, alpha_rad: f64) -> (f64, f64) {
                match self { $(Self::$Name(mechanism) => mechanism.s_and_h(alpha_rad),)* }
            }

            fn max_s(&self) -> f64 {
                match self { $(Self::$Name(mechanism) => mechanism.max_s(),)* }
            }

            fn max_h(&self) -> f64 {
                match self { $(Self::$Name(mechanism) => mechanism.max_h(),)* }
            }

            fn peak_sharpness(&self) -> f64 {
                match self { $(Self::$Name(mechanism) => mechanism.peak_sharpness(),)* }
            }

            fn links(&self) -> &'static str {
                match self { $(Self::$Name(mechanism) => mechanism.links(),)* }
            }

            fn draw(&self, mount: &Mount) -> String {
                match self { $(Self::$Name(mechanism) => mechanism.draw(mount),)* }
            }
        }
    };
}

for_all_mechanisms!(any);
