//! Check of the numbers of a scene against the ranges of their keys, where each number has the form of its key.
//!
//! Another key may determine the end of a range. It counts only if its own number is right, so that one mistake is one error.

use cophase_core::settings::key::{Key, Kind};
use toml::{Table, Value};

use super::read::join;
use crate::file::Scene;
use crate::range::outside_of;
use crate::{SceneError, keys};

/// Returns the errors of all numbers out of their ranges.
pub(super) fn outside(scene: &Table) -> impl Iterator<Item = SceneError> {
    let mut errors = Vec::new();
    each(scene, Scene::KEYS, "", &mut |key, path, value| {
        errors.extend(wrong(scene, key, path, value));
    });
    errors.into_iter()
}

/// Calls a function for each value that is no table, and no list of tables, with its key and its path.
fn each(
    table: &Table,
    keys: &'static [Key],
    path: &str,
    check: &mut dyn FnMut(&'static Key, &str, &Value),
) {
    for key in keys {
        let path = join(path, key.name);
        match (keys::rows(&key.kind), table.get(key.name)) {
            (_, None) => {}
            (Some(rows), Some(Value::Table(table))) => each(table, rows, &path, check),
            (Some(rows), Some(Value::Array(list))) => {
                for (entry, table) in list.iter().enumerate() {
                    if let Value::Table(table) = table {
                        each(table, rows, &format!("{path}[{entry}]"), check);
                    }
                }
            }
            (_, Some(value)) => check(key, &path, value),
        }
    }
}

/// Returns the error of a number out of its range; of a list, of the first one in it.
fn wrong(scene: &Table, key: &Key, path: &str, value: &Value) -> Option<SceneError> {
    if let (Value::Array(list), Kind::List(..)) = (value, &key.kind) {
        return list.iter().enumerate().find_map(|(entry, value)| {
            let part = key.parts.get(entry);
            let at = part.map_or(format!("{path}[{entry}]"), |_| path.to_owned());
            let mut error = wrong(scene, key, &at, value)?;
            if let Some(part) = part {
                error.problem = format!("{part} {}", error.problem);
            }
            Some(error)
        });
    }
    let number = |path: &str| right(scene, path);
    let problem = outside_of(path, key, as_number(value)?, number)?;
    Some(SceneError::for_key(path, problem))
}

/// Returns the number of a key that is given, or has a default, and is in its range.
fn right(scene: &Table, path: &str) -> Option<f64> {
    let mut steps = path.split('.');
    let first = scene.get(steps.next()?)?;
    let value = steps.try_fold(first, |value, step| value.get(step))?;
    let number = as_number(value)?;
    let (low, high) = keys::row(path)?.ends(|other| right(scene, other));
    (low..=high).contains(&number).then_some(number)
}

fn as_number(value: &Value) -> Option<f64> {
    let whole = || value.as_integer().map(|whole| whole as f64);
    value.as_float().or_else(whole)
}
