//! Models of the drives that a scene can name.

use cophase_scene::SceneError;
use cophase_scene::file::{Axes, Scene};

use super::{AtCrank, Motor};

/// Key of a scene that acts on some drives only.
#[derive(Clone, Copy, Debug)]
pub struct DriveKey {
    /// Path of the key.
    pub key: &'static str,
    /// True if only the simulation uses it, where torque moves the cranks.
    pub is_of_torque: bool,
    /// True if a scene gives it.
    pub is_given: fn(&Axes) -> bool,
    /// Problem and fix where no axis has such a drive.
    pub unused: &'static str,
}

/// Model of a drive: its keys, its motor and its alarm. The core has its command and whether it loses steps: `Drive::kind`.
#[derive(Clone, Copy, Debug)]
pub struct DriveModel {
    /// Keys that act on it, and not on all drives.
    pub keys: &'static [DriveKey],
    /// Key without which it has no motor, and what to give there.
    pub needs: (&'static str, &'static str),
    /// Key that sets the greatest torque of its motor.
    pub torque_key: &'static str,
    /// Following-error window, degrees of the crank; none if it raises no alarm.
    pub window_deg: fn(&Axes) -> Option<f64>,
    /// Motor at its crank, if the scene has its keys.
    pub motor: fn(&Axes, &AtCrank) -> Option<Motor>,
}

impl DriveModel {
    /// True if a key acts on the drive, and not on all drives.
    pub fn uses(&self, key: &str) -> bool {
        self.keys.iter().any(|own| own.key == key)
    }
}

/// Returns the keys of drives that a scene gives, and that only the simulation uses.
pub fn keys_of_torque(axes: &Axes) -> Vec<&'static str> {
    let keys = DriveModel::ALL.iter().flat_map(|model| model.keys);
    let given = keys.filter(|key| key.is_of_torque && (key.is_given)(axes));
    let mut given: Vec<_> = given.map(|key| key.key).collect();
    given.sort_unstable();
    given.dedup();
    given
}

/// Makes the models from the list of all drives, each with its module.
macro_rules! drives {
    ($($Drive:ident => $module:ident),* $(,)?) => {
        impl DriveModel {
            const ALL: &'static [Self] = &[$($module::MODEL),*];

            /// All drives.
            pub const DRIVES: &'static [cophase_scene::file::Drive] = &[$(cophase_scene::file::Drive::$Drive),*];

            /// Model of a drive.
            pub const fn for_drive(drive: cophase_scene::file::Drive) -> &'static Self {
                match drive { $(cophase_scene::file::Drive::$Drive => &$module::MODEL,)* }
            }
        }
    };
}

pub(super) use drives;

/// Checks that every key of a drive acts on an axis.
///
/// # Errors
/// The first key that acts on none.
pub fn check_keys(scene: &Scene) -> Result<(), SceneError> {
    let acts = |key| {
        (0..scene.axes.count).any(|i| DriveModel::for_drive(scene.resolved(i).drive).uses(key))
    };
    let keys = DriveModel::ALL.iter().flat_map(|model| model.keys);
    let mut given = keys.filter(|key| (key.is_given)(&scene.axes));
    match given.find(|key| !acts(key.key)) {
        Some(key) => Err(SceneError::for_key(key.key, key.unused)),
        None => Ok(()),
    }
}
