//! Reading a scene file, and saying what is wrong with its form.

use std::io::Read;
use std::path::Path;

use super::{Scene, SceneError};

/// No scene needs more; what is larger is not a scene.
const MOST_BYTES: u64 = 1 << 20;

/// Reads a scene from a file.
///
/// # Errors
/// The file cannot be read, is too large, is not TOML, or its keys are not those of a scene.
pub fn from_file(path: &Path) -> Result<Scene, SceneError> {
    let origin = path.display().to_string();
    from_path(path)
        .and_then(|text| parse(&text))
        .map_err(|error| error.in_file(&origin))
}

fn from_path(path: &Path) -> Result<String, SceneError> {
    let whole = |problem: String| SceneError::at("", problem);
    if path.is_dir() {
        return Err(whole(
            "is a directory; give a scene file (TOML) inside it".to_owned(),
        ));
    }
    let file = std::fs::File::open(path).map_err(|error| {
        whole(format!(
            "cannot be opened: {error}; `cophase scenes` lists the built-in scenes, and \
             `cophase scenes default > my.toml` writes one to start from"
        ))
    })?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| whole(format!("cannot be read: {error}")))?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(whole(
            "is larger than 1 MiB; a scene is a few kilobytes of TOML".to_owned(),
        ));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        whole(format!(
            "is not text: byte {at} is not UTF-8; a scene is a TOML file"
        ))
    })
}

/// Reads a scene from text.
///
/// # Errors
/// The text is not TOML, or its keys are not those of a scene.
pub fn parse(text: &str) -> Result<Scene, SceneError> {
    let line_of = |span: Option<std::ops::Range<usize>>| {
        span.map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1)
    };
    let deserializer = toml::Deserializer::parse(text).map_err(|error| SceneError {
        line: line_of(error.span()),
        ..SceneError::at("", format!("is not TOML: {}", one_line(error.message())))
    })?;
    serde_path_to_error::deserialize(deserializer).map_err(|error| {
        let path = error.path().to_string();
        let inner = error.into_inner();
        let (key, problem) = explain(if path == "." { "" } else { &path }, inner.message());
        SceneError {
            line: line_of(inner.span()),
            ..SceneError::at(key, problem)
        }
    })
}

/// Key and sentence for one of serde's messages.
///
/// serde hands the known keys on inside the message only, quoted with backticks; its form is that of
/// `serde::de::Error::unknown_field`, `unknown_variant` and `missing_field`.
fn explain(path: &str, message: &str) -> (String, String) {
    let message = one_line(message);
    let mut quoted = message.split('`').skip(1).step_by(2);
    let join = |key: &str| {
        if path.is_empty() || path == key || path.ends_with(&format!(".{key}")) {
            if path.is_empty() {
                key.to_owned()
            } else {
                path.to_owned()
            }
        } else {
            format!("{path}.{key}")
        }
    };
    if message.starts_with("unknown field") {
        let unknown = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        return (
            join(unknown),
            format!("unknown key; {}", nearest(unknown, &known)),
        );
    }
    if message.starts_with("unknown variant") {
        let unknown = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        return (
            path.to_owned(),
            format!(
                "\"{unknown}\" is none of its values; {}",
                nearest(unknown, &known)
            ),
        );
    }
    if message.starts_with("missing field") {
        let missing = quoted.next().unwrap_or_default();
        let problem =
            "missing; it has no default, so give it (`cophase scenes default` shows a whole scene)";
        return (join(missing), problem.to_owned());
    }
    let message = message
        .replace("expected f64", "expected a number")
        .replace("expected usize", "expected a whole number, not negative")
        .replace("expected u32", "expected a whole number, not negative")
        .replace(
            "expected a sequence",
            "expected a list, as [[…]] or [ … ] makes one",
        )
        .replace("expected struct", "expected a table of kind");
    (path.to_owned(), message)
}

/// Names the likeliest of the known keys, and the others if they are few.
fn nearest(unknown: &str, known: &[&str]) -> String {
    let likeliest = known.iter().max_by(|a, b| {
        strsim::jaro_winkler(unknown, a).total_cmp(&strsim::jaro_winkler(unknown, b))
    });
    match likeliest {
        Some(key) if known.len() > 1 => {
            format!("did you mean `{key}`? known here: {}", known.join(", "))
        }
        Some(key) => format!("did you mean `{key}`?"),
        None => "none is known here".to_owned(),
    }
}

fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
