//! Reader of scene files. It reports errors of the form with their places.

mod cam_file;
mod explain;
mod nearest;
mod place;
mod ranges;
mod read;
mod repair;
#[cfg(test)]
mod sweep;

use std::path::Path;

use toml::Spanned;
use toml::de::DeTable;

use super::library::{BuiltIn, SCENES};
use super::{Scene, SceneError};
use crate::file_kind::FileKind;
use crate::input_file::{self, Unreadable};
pub use cam_file::meant_net_turns;
use explain::not_toml;
pub use nearest::nearest;

/// Largest size of a scene file, bytes.
pub const MAX_BYTES: u64 = 1 << 20;

/// Most NUL bytes in a file that is text otherwise.
const MAX_NULS: usize = 8;
const START_FROM: &str = "`cophase scenes default > my.toml` writes a scene to start from";

/// Reads a scene from a file, and passes it to `check`.
///
/// # Errors
/// The file cannot be read, is too large, is not TOML, or has keys that no scene has; and those of `check`. The error names the file, and the
/// line if there is one. It lists up to ten; of what only a combination of tables makes wrong, the first.
pub fn read_file<T>(
    path: &Path,
    check: impl FnOnce(Scene) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    let origin = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = from_path(path).and_then(|text| read_text(&text, Some(folder), check));
    read.map_err(|error| error.in_file(&origin))
}

/// Reads a scene from text, and passes it to `check`. Files of cam tables are relative to `folder`; without one they are refused.
///
/// # Errors
/// Those of [`read_file`], without an origin.
pub fn read_text<T>(
    text: &str,
    folder: Option<&Path>,
    check: impl FnOnce(Scene) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    scene(text, |mut scene| {
        cam_file::read_all(&mut scene, folder)?;
        check(scene)
    })
}

fn from_path(path: &Path) -> Result<String, SceneError> {
    let whole = |problem: String| SceneError::for_key("", problem);
    if let Some(kind) = FileKind::from_path(path).filter(|kind| *kind != FileKind::Scene) {
        return Err(whole(format!(
            "is {kind} and no scene; a scene is a TOML file: {START_FROM}"
        )));
    }
    let bytes = input_file::read(path, MAX_BYTES).map_err(|error| {
        let fix = match &error {
            Unreadable::Open(_) => instead(path),
            Unreadable::Directory => "give a scene file (TOML) inside it".to_owned(),
            Unreadable::TooLarge(_) => {
                format!("a scene is a few kilobytes of TOML: {START_FROM}")
            }
            Unreadable::NotPlain => "save the scene to a file, and give its name".to_owned(),
            Unreadable::Read(_) => START_FROM.to_owned(),
        };
        whole(format!("{error}; {fix}"))
    })?;
    if matches!(bytes[..], [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) {
        return Err(whole(
            "is UTF-16 text; a scene is a TOML file, so save it as UTF-8".to_owned(),
        ));
    }
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        let are_few = std::str::from_utf8(&bytes).is_ok()
            && bytes.iter().filter(|&&byte| byte == 0).count() <= MAX_NULS;
        return Err(SceneError {
            line: Some(place::line_of(&bytes, at)),
            ..whole(match are_few {
                true => format!(
                    "byte {at} is NUL (U+0000), which no text has and most editors do not show; delete it"
                ),
                false => {
                    format!("is not text: byte {at} is NUL; a scene is a TOML file: {START_FROM}")
                }
            })
        });
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = place::line_of(error.as_bytes(), valid);
        // In the encoding that Western programs had before Unicode, each byte is the character of that number.
        let byte = error.as_bytes()[valid];
        let latin_1: String = error
            .as_bytes()
            .iter()
            .map(|&byte| char::from(byte))
            .collect();
        let c = char::from(byte);
        let what = match c.is_control() {
            true => format!("byte {valid}, {byte:02X}, is not UTF-8"),
            false => format!("byte {valid}, {byte:02X}, is not UTF-8; in Latin-1 it is `{c}`"),
        };
        SceneError {
            line: Some(line),
            ..SceneError::for_key(
                place::key_on_line(&latin_1, line),
                format!("is not text: {what}; a scene is a TOML file, so save it as UTF-8"),
            )
        }
    })
}

/// Returns the fix for a file that cannot be opened.
fn instead(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let names: Vec<_> = SCENES.iter().map(|scene| scene.name).collect();
    match nearest(&stem, &names) {
        Some(name) => format!("did you mean the built-in scene `{name}`? {START_FROM}"),
        None => format!("`cophase scenes` lists the built-in scenes, and {START_FROM}"),
    }
}

impl BuiltIn {
    /// Returns the scene.
    ///
    /// # Panics
    /// Never: a test reads every built-in scene.
    pub fn scene(&self) -> Scene {
        parse(self.text).expect("built-in scenes are tested to be well-formed")
    }
}

/// Reads a scene from text.
///
/// # Errors
/// The text is not TOML, or has keys or values that no scene has.
pub fn parse(text: &str) -> Result<Scene, SceneError> {
    scene(text, Ok)
}

fn scene<T>(
    text: &str,
    then: impl FnOnce(Scene) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    let document = document(text)?;
    let document = document.get_ref();
    if document.is_empty() {
        return Err(SceneError::for_key("", format!("is empty; {START_FROM}")));
    }
    read::scene(text, document)
        .and_then(then)
        .map_err(|error| place::all_placed(error, text, document))
}

/// Reads TOML.
fn document(text: &str) -> Result<Spanned<DeTable<'_>>, SceneError> {
    DeTable::parse(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start.min(text.len()));
        let repaired = repair::repair(text, at);
        let at = repaired.as_ref().map_or(at, |repaired| repaired.begin);
        let line = place::line_at(text, at);
        let source = text.lines().nth(line - 1).unwrap_or_default();
        // A key is recognised in what was meant.
        let meant = repaired
            .as_ref()
            .and_then(|repaired| Some((repaired.begin, repaired.line.as_deref()?)));
        let key = match meant {
            Some((begin, meant)) => place::key_on_line(&format!("{}{meant}", &text[..begin]), line),
            None => place::key_on_line(text, line),
        };
        let at = error.span().and_then(|span| text.get(span));
        let problem = not_toml(
            &key,
            error.message(),
            at.unwrap_or_default(),
            source,
            repaired,
        );
        SceneError {
            line: Some(line),
            ..SceneError::for_key(key, problem)
        }
    })
}
