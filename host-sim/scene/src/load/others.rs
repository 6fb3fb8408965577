//! Further errors in the keys and values of a scene, after the first one.
//!
//! Checks end at the first error. To find the next one, the wrong value is *replaced*: it is left out, so that its default holds, or
//! taken from a built-in scene. Then the scene is checked again. An error that a replaced value may have caused is not reported.

use std::collections::{BTreeMap, BTreeSet};

use toml::{Table, Value};

use super::explain::UNKNOWN_KEY;
use super::place::{Step, axis_of, example_value, homes_of, line_of_key, steps};
use crate::SceneError;

/// Limit of errors that are reported together. With more, it is probably the wrong file.
const MOST: usize = 10;
/// Limit of checks of a scene.
const MOST_CHECKS: usize = 40;

/// Returns the first error of a scene's text, with the others in the order of their lines.
pub(super) fn find<T>(
    text: &str,
    first: SceneError,
    check: impl Fn(&str) -> Result<T, SceneError>,
) -> SceneError {
    let Ok(original) = toml::from_str::<Table>(text) else {
        return first;
    };
    let mut table = original.clone();
    let mut found = vec![first.clone()];
    let mut replaced = Replaced::default();
    let mut last = first;
    for _ in 0..MOST_CHECKS {
        let Some(better) = replaced.replace(&table, &last.key) else {
            break;
        };
        table = better;
        // As text, like the file: a reader of TOML values would be compiled for every key once more.
        let Err(error) = check(&table.to_string()) else {
            break;
        };
        if replaced.is_not_the_cause_of(&error) && !found.iter().any(|other| is_one(&error, other))
        {
            // The line belongs to the changed text.
            let line = None;
            found.push(SceneError {
                line,
                ..error.clone()
            });
        }
        if found.len() == MOST {
            break;
        }
        last = error;
    }
    let in_its_place = |error: SceneError| SceneError {
        line: error.line.or_else(|| line_of_key(text, &error.key)),
        axis: axis_of(&original, &error.key),
        ..error
    };
    let mut found: Vec<_> = found.into_iter().map(in_its_place).collect();
    found.sort_by_key(|error| error.line);
    SceneError::together(under_one_heading(found)).expect("the first is among them")
}

/// Joins the errors of unknown keys that one wrong or missing heading explains: two keys or more of a table all belong to another one.
fn under_one_heading(mut found: Vec<SceneError>) -> Vec<SceneError> {
    let table_of = |error: &SceneError| {
        let is_unknown = error.problem.starts_with(UNKNOWN_KEY);
        let (table, _) = error.key.rsplit_once('.').unwrap_or(("", &error.key));
        is_unknown.then(|| table.to_owned())
    };
    let tables: BTreeSet<String> = found.iter().filter_map(table_of).collect();
    for table in tables {
        let keys: Vec<String> = found
            .iter()
            .filter(|error| table_of(error).as_ref() == Some(&table))
            .map(|error| error.key.rsplit('.').next().unwrap_or_default().to_owned())
            .collect();
        // No built-in scene has some keys.
        let mut homes = keys
            .iter()
            .map(|key| homes_of(key))
            .filter(|homes| !homes.is_empty());
        let first = homes.next().unwrap_or_default();
        let shared = homes.fold(first, |shared, homes| {
            shared
                .into_iter()
                .filter(|home| homes.contains(home))
                .collect()
        });
        let heading = match &shared[..] {
            [heading] if keys.len() > 1 && heading.starts_with('[') => heading,
            // The keys that are known there are listed once.
            _ => {
                let errors = found
                    .iter_mut()
                    .filter(|error| table_of(error).as_ref() == Some(&table));
                for error in errors.skip(1) {
                    let before = error
                        .problem
                        .split("known here: ")
                        .next()
                        .unwrap_or_default();
                    error.problem = before.trim_end_matches([';', ' ']).to_owned();
                }
                continue;
            }
        };
        let mut is_first = true;
        found.retain_mut(|error| {
            if table_of(error).as_ref() != Some(&table) {
                return true;
            }
            let list = keys.join(", ");
            error.problem = match table.as_str() {
                "" => format!("the heading {heading} is missing above this line: {list} are its keys"),
                table => format!("{list} are keys of {heading}; write {heading} in the place of [{table}], or move them there"),
            };
            std::mem::replace(&mut is_first, false)
        });
    }
    found
}

/// Keys whose values are replaced, each with the number of replacements: left out first, then as in a built-in scene.
#[derive(Default)]
struct Replaced(BTreeMap<String, usize>);

impl Replaced {
    /// Returns the scene with another value at a key, or without the table around it; `None` if nothing can be replaced.
    fn replace(&mut self, table: &Table, key: &str) -> Option<Table> {
        let mut place = without_entry(key);
        while !place.is_empty() {
            let times = self.0.entry(place.to_owned()).or_insert(0);
            while *times < 2 {
                *times += 1;
                let is_value = place == without_entry(key);
                let value = match (*times, is_value) {
                    (1, _) => None,
                    // No built-in scene has this key. Most ranges contain 1.
                    (_, true) => Some(example_value(place).unwrap_or(Value::Integer(1))),
                    (_, false) => break,
                };
                let mut better = table.clone();
                if put(&mut better, place, value).is_some() {
                    return Some(better);
                }
            }
            place = without_entry(place.rsplit_once('.').map_or("", |(around, _)| around));
        }
        None
    }

    fn is_not_the_cause_of(&self, error: &SceneError) -> bool {
        let mut keys = self.0.keys();
        let is_by_itself = is_by_itself(error);
        keys.all(|replaced| {
            error.key != *replaced
                && !error.problem.contains(replaced.as_str())
                && (is_by_itself || !depends(&error.key, replaced))
        })
    }
}

/// Returns the list of an entry. Without one entry, those behind it would have other numbers.
fn without_entry(key: &str) -> &str {
    let list = key.strip_suffix(']').and_then(|open| open.rsplit_once('['));
    list.map_or(key, |(list, _)| list)
}

/// Returns true if a key or value is wrong by itself: out of its range, none of the permitted values, of another type, or unknown.
fn is_by_itself(error: &SceneError) -> bool {
    let has = |words: &str| error.problem.contains(words);
    let is_other_type = has(", where ") && has(" belongs");
    let words = [
        " is outside ",
        " finite number",
        " is none of its values",
        UNKNOWN_KEY,
    ];
    is_other_type || words.into_iter().any(has)
}

/// Returns true if two errors, such as those of two axes, have the same cause.
fn is_one(error: &SceneError, other: &SceneError) -> bool {
    error.problem == other.problem && !is_by_itself(error)
}

/// Returns true if a check at `key`, other than that of its range, may depend on the value of `other`.
fn depends(key: &str, other: &str) -> bool {
    let table = |key: &'_ str| key.rsplit_once('.').map(|(table, _)| table.to_owned());
    if table(key) == table(other) {
        return true;
    }
    let root = |key: &str| key.split(['.', '[']).next().unwrap_or_default().to_owned();
    let other = root(other);
    let among = |roots: &[&str]| roots.contains(&other.as_str());
    match root(key).as_str() {
        "program" => among(&["machine", "cam", "limits", "control", "program"]),
        "limits" => among(&["machine", "cam", "control", "limits"]),
        "axes" | "axis" => among(&[
            "machine",
            "cam",
            "limits",
            "control",
            "cam_table",
            "axes",
            "axis",
        ]),
        "command" | "input" | "late" | "fault" | "cam_table" => among(&["axes", "axis"]),
        _ => true,
    }
}

/// Sets the value of a key, or removes the key. `None` if there is no such place, or if that would remove the machine.
fn put(table: &mut Table, key: &str, value: Option<Value>) -> Option<()> {
    let (parent, name) = key.rsplit_once('.').unwrap_or(("", key));
    let parent = steps(parent)
        .filter(|step| !matches!(step, Step::Name("")))
        .try_fold(Place::Table(table), |place, step| match (place, step) {
            (Place::Table(table), Step::Name(name)) => place_of(table.get_mut(name)?),
            (Place::List(list), Step::Entry(entry)) => place_of(list.get_mut(entry)?),
            _ => None,
        })?;
    let Place::Table(parent) = parent else {
        return None;
    };
    match value {
        Some(value) => {
            parent.insert(name.to_owned(), value);
        }
        None if ["machine", "cam"].contains(&key) => return None,
        None => {
            parent.remove(name)?;
        }
    }
    Some(())
}

enum Place<'a> {
    Table(&'a mut Table),
    List(&'a mut Vec<Value>),
}

fn place_of(value: &mut Value) -> Option<Place<'_>> {
    match value {
        Value::Table(table) => Some(Place::Table(table)),
        Value::Array(list) => Some(Place::List(list)),
        _ => None,
    }
}
