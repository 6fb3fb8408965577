//! Scenes from files and texts, checked.

use std::path::Path;

use cophase_scene::load::{read_file, read_text};
use cophase_scene::{Scene, SceneError};

use crate::checked::Checked;

/// Reads a scene from a file and checks its values.
///
/// # Errors
/// The file cannot be read, is too large, is not TOML, has keys that no scene has, values with which no machine can run, or a tick rate that
/// no board keeps. The error names the file, and the line if there is one. For text that is not TOML, it is the first error. Of wrong keys
/// and values, it lists up to ten.
pub fn checked_from_file(path: &Path) -> Result<Checked, SceneError> {
    read_file(path, checked)
}

/// Reads a scene from text and checks its values. Files of cam tables are relative to `folder`; without one they are refused.
///
/// # Errors
/// Those of [`checked_from_file`], without an origin.
pub fn checked_from_text(text: &str, folder: Option<&Path>) -> Result<Checked, SceneError> {
    read_text(text, folder, checked)
}

fn checked(scene: Scene) -> Result<Checked, SceneError> {
    let checked = Checked::new(scene)?;
    checked.check_rate()?;
    Ok(checked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::library::SCENES;

    #[test]
    fn built_in_scenes_are_valid_and_named_as_listed() {
        for built_in in SCENES {
            let scene = built_in.scene();
            assert_eq!(scene.name, built_in.name);
            assert!(!scene.description.is_empty());
            Checked::new(scene).unwrap();
        }
    }
}
