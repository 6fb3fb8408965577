//! Text of the scene whose program the editor shows first.

use std::path::Path;

use cophase_link::message::Identity;
use cophase_scene::file_kind::FileKind;
use cophase_scene::input_file;
use cophase_scene::{library, load};

use super::ScopeArgs;

/// Reads the scene of `--scene`, that of `--to sim:SCENE`, or the built-in one that has the name of the controller's settings.
/// There is no text for a controller with other settings.
pub(super) fn text(args: &ScopeArgs, identity: &Identity) -> Result<String, String> {
    let to = args.to.as_deref().unwrap_or_default();
    let named = args.scene.as_deref().or_else(|| to.strip_prefix("sim:"));
    let Some(name) = named else {
        let built_in = library::find(&identity.settings);
        return Ok(built_in.map_or_else(String::new, |scene| scene.text.to_owned()));
    };
    match library::find(name) {
        Some(built_in) if !Path::new(name).exists() => Ok(built_in.text.to_owned()),
        _ => match FileKind::from_path(Path::new(name)) {
            None | Some(FileKind::Scene) => input_file::read_text(Path::new(name), load::MAX_BYTES)
                .map_err(|e| format!("{name}: {e}; give a scene file")),
            Some(kind) => Err(format!(
                "{name}: is {kind} and no scene; give a scene file (.toml), or the name of a built-in scene"
            )),
        },
    }
}
