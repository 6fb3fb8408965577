//! The built-in scenes.

pub use crate::built_in::{BuiltIn, FIRST, SCENES};
use crate::{Scene, load};

impl BuiltIn {
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
