//! Lines of keys in a scene file, and the tables to which keys belong.
//!
//! A *key path* has the form `limits.band[0].from_hz`, with entries counted from 0.

use std::collections::BTreeSet;
use std::ops::Range;

use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use crate::built_in::SCENES;
use crate::keys;

/// Returns the line of a byte, counted from 1.
pub(super) fn line_at(text: &str, byte: usize) -> usize {
    line_of(text.as_bytes(), byte)
}

/// Returns the line of a byte in what may not be text, counted from 1.
pub(super) fn line_of(bytes: &[u8], byte: usize) -> usize {
    let before = &bytes[..byte.min(bytes.len())];
    before.iter().filter(|&&byte| byte == b'\n').count() + 1
}

/// Returns the line of a key. For a missing key, it is the line of the innermost table around it.
pub(super) fn line_of_key(text: &str, path: &str) -> Option<usize> {
    let mut value = DeValue::Table(DeTable::parse(text).ok()?.into_inner());
    let mut found = None;
    for step in steps(path) {
        let next = match step {
            Step::Name(name) => value.get(name),
            Step::Entry(entry) => value.get(entry),
        };
        let Some(next) = next else { break };
        found = Some(next.span().start);
        value = next.get_ref().clone();
    }
    found.map(|byte| line_at(text, byte))
}

/// Returns the axis number of an `[[axis]]` entry on a key path.
pub(super) fn axis_of(table: &Table, path: &str) -> Option<u8> {
    let mut steps = steps(path);
    let (Some(Step::Name("axis")), Some(Step::Entry(entry))) = (steps.next(), steps.next()) else {
        return None;
    };
    let number = table.get("axis")?.get(entry)?.get("number")?;
    number.as_integer()?.try_into().ok()
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

/// Returns the form of a key path, with the default of its row, or as in the built-in scenes: `load_kg = 8`, `[limits]`, `[[program]]`.
pub(super) fn example(path: &str) -> Option<String> {
    if let Some(row) = keys::row(path) {
        return Some(format!("{} = {}", row.name(), row.default));
    }
    SCENES.iter().find_map(|scene| {
        let whole = DeValue::Table(DeTable::parse(scene.text).ok()?.into_inner());
        let path_steps: Vec<_> = steps(path).collect();
        let (value, span) = first_at(&whole, 0..0, &path_steps)?;
        let root = path.split('[').next().unwrap_or(path);
        match (value.is_table(), steps(path).last()?) {
            _ if path == root && value.is_array() && !root.contains('.') => {
                Some(format!("[[{root}]]"))
            }
            (true, _) if path == root && !root.contains('.') => Some(format!("[{root}]")),
            (true, Step::Entry(_)) if !path.contains('.') => Some(format!("[[{root}]]")),
            (_, Step::Name(name)) => Some(format!("{name} = {}", scene.text.get(span)?)),
            (_, Step::Entry(_)) => Some(scene.text.get(span)?.to_owned()),
        }
    })
}

/// Returns the first value at a path, and its place. Any entry of a list serves.
fn first_at<'a>(
    value: &DeValue<'a>,
    span: Range<usize>,
    path: &[Step],
) -> Option<(DeValue<'a>, Range<usize>)> {
    let Some((step, rest)) = path.split_first() else {
        return Some((value.clone(), span));
    };
    match (step, value) {
        (Step::Name(name), value) => {
            let next = value.get(*name)?;
            first_at(next.get_ref(), next.span(), rest)
        }
        (Step::Entry(_), DeValue::Array(entries)) => entries
            .iter()
            .find_map(|entry| first_at(entry.get_ref(), entry.span(), rest)),
        _ => None,
    }
}

/// Returns the place of a key, if scenes have it: the top level, or headings.
pub(super) fn home_of(key: &str) -> Option<String> {
    let homes = homes_of(key);
    match homes.first() {
        Some(home) if home.starts_with('[') => Some(format!("under {}", homes.join(" or "))),
        home => home.cloned(),
    }
}

/// Returns the places of a key in scenes: the top level, in words, or headings.
pub(super) fn homes_of(key: &str) -> Vec<String> {
    let scenes: Vec<Table> = SCENES
        .iter()
        .filter_map(|built_in| Table::try_from(super::parse(built_in.text).ok()?).ok())
        .collect();
    let is_at_top = |scene: &Table| {
        scene
            .get(key)
            .is_some_and(|value| !value.is_table() && !value.is_array())
    };
    if scenes.iter().any(is_at_top) {
        return vec!["at the top, above the first [table]".to_owned()];
    }
    let homes = scenes
        .into_iter()
        .flatten()
        .filter_map(|(name, value)| match value {
            Value::Table(table) if table.contains_key(key) => Some(format!("[{name}]")),
            Value::Array(entries) if entries.iter().any(|e| e.get(key).is_some()) => {
                Some(format!("[[{name}]]"))
            }
            _ => None,
        });
    homes.collect::<BTreeSet<_>>().into_iter().collect()
}

/// Returns the default of a key's row, or a plain value of a built-in scene at a key path.
pub(super) fn example_value(path: &str) -> Option<Value> {
    if let Some(row) = keys::row(path) {
        return Some(match row.is_whole {
            true => Value::Integer(row.default as i64),
            false => Value::Float(row.default),
        });
    }
    SCENES.iter().find_map(|scene| {
        let mut value = Value::Table(toml::from_str(scene.text).ok()?);
        for step in steps(path) {
            value = match step {
                Step::Name(name) => value.get(name)?.clone(),
                // Any entry serves as the example.
                Step::Entry(_) => value.get(0)?.clone(),
            };
        }
        Some(value).filter(|value| !value.is_table() && !value.is_array())
    })
}

#[derive(Clone, Copy)]
pub(super) enum Step<'a> {
    Name(&'a str),
    Entry(usize),
}

pub(super) fn steps(path: &str) -> impl Iterator<Item = Step<'_>> {
    path.split('.').flat_map(|part| {
        let (name, entries) = part.split_once('[').unwrap_or((part, ""));
        let entries = entries
            .split(['[', ']'])
            .filter_map(|digits| digits.parse().ok());
        std::iter::once(Step::Name(name)).chain(entries.map(Step::Entry))
    })
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
            assert_eq!(line_of_key(TEXT, path), line, "{path}");
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

    #[test]
    fn examples_come_from_the_built_in_scenes() {
        for (path, written) in [
            ("machine.load_kg", Some("load_kg = 2")),
            ("machine", Some("[machine]")),
            ("program", Some("[[program]]")),
            ("axis[7].number", Some("number = 1")),
            ("limits.band[3]", Some("{ from_hz = 10, to_hz = 12 }")),
            ("colour", None),
        ] {
            assert_eq!(example(path).as_deref(), written, "{path}");
        }
        assert_eq!(home_of("load_kg").as_deref(), Some("under [machine]"));
        assert_eq!(home_of("amax_g").as_deref(), Some("under [[program]]"));
        assert!(home_of("fidelity").unwrap().starts_with("at the top"));
        assert_eq!(home_of("colour"), None);
    }
}
