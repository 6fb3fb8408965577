//! The built-in scenes.

pub use crate::built_in::{BuiltIn, FIRST, SCENES};
use crate::{Scene, load};

impl BuiltIn {
    /// Machine of the scene, for lists.
    pub fn machine(&self) -> &'static str {
        let scene = self.scene();
        match (&scene.machine, &scene.cam, scene.other_machine()) {
            (Some(machine), ..) => machine.mechanism.name(),
            (_, Some(cam), _) if cam.screw_lead_mm.is_some() => "electronic cam",
            (_, Some(_), _) => "cam shaft",
            (.., Some(key)) => key,
            (None, None, None) => "no machine",
        }
    }

    /// Returns the scene.
    ///
    /// # Panics
    /// Never: a test reads every built-in scene.
    pub fn scene(&self) -> Scene {
        load::parse(self.text).expect("built-in scenes are tested to be well-formed")
    }
}

/// Returns the built-in scene with a name.
pub fn find(name: &str) -> Option<&'static BuiltIn> {
    SCENES.iter().find(|scene| scene.name == name)
}
