//! Lines of keys in a scene file.
//!
//! A *key path* has the form `limits.band[0].from_hz`, with entries counted from 0.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::SceneError;

/// Returns the line of a byte, counted from 1.
pub(super) fn line_at(text: &str, byte: usize) -> usize {
    line_of(text.as_bytes(), byte)
}

/// Returns the line of a byte in what may not be text, counted from 1.
pub(super) fn line_of(bytes: &[u8], byte: usize) -> usize {
    let before = &bytes[..byte.min(bytes.len())];
    before.iter().filter(|&&byte| byte == b'\n').count() + 1
}

/// Returns errors with their lines, sorted by them; see [`placed`].
pub(super) fn all_placed(error: SceneError, text: &str, document: &DeTable) -> SceneError {
    let mut error = placed(error, text, document);
    let others = std::mem::take(&mut error.others).into_iter();
    let mut all: Vec<_> = others.map(|other| placed(other, text, document)).collect();
    all.insert(0, error);
    all.sort_by_key(|error| error.line.unwrap_or(usize::MAX));
    let mut first = all.remove(0);
    first.others = all;
    first
}

/// Returns an error with the line of its key and the axis of its `[[axis]]` entry. For a missing key, the line is that of the innermost
/// table around it.
pub(super) fn placed(mut error: SceneError, text: &str, document: &DeTable) -> SceneError {
    let found = values_on(document, &error.key);
    error.line = error
        .line
        .or_else(|| Some(line_at(text, found.last()?.span().start)));
    if error.key.starts_with("axis[") {
        let number = found.get(1).and_then(|entry| entry.get_ref().get("number"));
        error.axis = number.and_then(|number| source_of(text, number).parse().ok());
    }
    error
}

fn source_of<'a>(text: &'a str, value: &Spanned<DeValue>) -> &'a str {
    text.get(value.span()).unwrap_or_default()
}

/// Returns the values on a key path, from the outermost one on, as far as they are given.
fn values_on<'a, 'i>(document: &'a DeTable<'i>, path: &str) -> Vec<&'a Spanned<DeValue<'i>>> {
    let mut found: Vec<&Spanned<DeValue>> = Vec::new();
    for step in path.split(['.', '[']) {
        let next = match (found.last(), step.strip_suffix(']')) {
            (None, _) => document.get(step),
            (Some(value), None) => value.get_ref().get(step),
            (Some(value), Some(entry)) => {
                let entry: Result<usize, _> = entry.parse();
                entry.ok().and_then(|entry| value.get_ref().get(entry))
            }
        };
        match next {
            Some(next) => found.push(next),
            None => break,
        }
    }
    found
}

/// Returns the key path of a line in text that is not TOML, from the key and the heading above it, if they can be recognised.
pub(super) fn key_on_line(text: &str, line: usize) -> String {
    let mut headings: Vec<String> = Vec::new();
    let mut table = String::new();
    // The key of a list that goes on over several lines.
    let mut list = String::new();
    for (number, line_text) in (1..=line).zip(text.lines()) {
        let line_text = line_text.trim_start_matches('\u{feff}').trim();
        if let Some(list) = between(line_text, "[[", "]]").filter(|name| bare(name)) {
            let entry = headings.iter().filter(|name| *name == list).count();
            headings.push(list.to_owned());
            table = format!("{list}[{entry}]");
        } else if let Some(name) = between(line_text, "[", "]").filter(|name| bare(name)) {
            table = name.to_owned();
        } else if number == line {
            let key = key_before(line_text).unwrap_or(&list);
            return match (key.is_empty(), table.is_empty()) {
                (true, _) => table,
                (false, true) => key.to_owned(),
                (false, false) => format!("{table}.{key}"),
            };
        } else if line_text.ends_with('[') {
            key_before(line_text)
                .unwrap_or_default()
                .clone_into(&mut list);
        } else if line_text.starts_with(']') {
            list.clear();
        }
    }
    table
}

/// Returns the key with which a line begins.
fn key_before(line: &str) -> Option<&str> {
    let is_end = |c: char| c == '=' || c == ':' || c.is_whitespace();
    line.split(is_end).next().filter(|key| bare(key))
}

fn between<'a>(line: &'a str, open: &str, close: &str) -> Option<&'a str> {
    let inner = line.strip_prefix(open)?;
    inner.split_once(close).map(|(name, _)| name.trim())
}

/// Returns true if the text looks like a key.
pub(super) fn bare(key: &str) -> bool {
    (1..=64).contains(&key.len())
        && key
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"x\"\n\n[limits]\nspeed_hz = 3\nband = [\n  { from_hz = 1 },\n  \
                        { from_hz = 2 },\n]\n[[axis]]\nnumber = 0\n[[axis]]\nnumber = 1\n";

    #[test]
    fn keys_are_located_and_missing_keys_at_their_table() {
        for (path, line) in [
            ("name", Some(1)),
            ("limits", Some(3)),
            ("limits.speed_hz", Some(4)),
            ("limits.band[1].from_hz", Some(7)),
            ("limits.band[1].to_hz", Some(7)),
            ("limits.homing_speed_hz", Some(3)),
            ("axis[1].number", Some(12)),
            ("machine.lambda", None),
            ("", None),
        ] {
            let document = DeTable::parse(TEXT).unwrap();
            let placed = placed(SceneError::for_key(path, ""), TEXT, document.get_ref());
            assert_eq!(placed.line, line, "{path}");
        }
    }

    #[test]
    fn a_broken_line_still_names_its_key() {
        let broken = TEXT.replace("speed_hz = 3", "speed_hz 3");
        assert_eq!(key_on_line(&broken, 1), "name");
        assert_eq!(key_on_line(&broken, 4), "limits.speed_hz");
        assert_eq!(key_on_line(&broken, 12), "axis[1].number");
        assert_eq!(key_on_line(&broken, 6), "limits.band");
        assert_eq!(key_on_line("{\"a\": 1}", 1), "");
    }
}
