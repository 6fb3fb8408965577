//! Reader of a scene's TOML tree. It compares the tree with the rows of the keys, finds all errors in one pass, and fills in the defaults.
//!
//! A *key path* has the form `limits.band[0].from_hz`, with entries counted from 0.

use cophase_core::problem::Problem;
use cophase_core::settings::key::{Absent, Key, Kind};
use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use super::explain;
use super::place::line_at;
use crate::file::{Correction, Link, Method, Noise, Questions, Scene, Segment, Wiring};
use crate::{SceneError, keys};

/// Limit of errors that are reported together. With more, it is probably the wrong file.
const MOST: usize = 10;

/// Makes a scene of a document, whose text gives the lines.
///
/// # Errors
/// Keys that no scene has, keys that are missing, values of another type, and numbers out of their range: up to ten, by line.
pub(super) fn scene(text: &str, document: &DeTable) -> Result<Scene, SceneError> {
    let mut reader = Reader::new(text);
    let table = reader.table("", document, None, Scene::KEYS);
    let mut errors = reader.errors;
    errors.sort_by_key(|error| error.line.unwrap_or(usize::MAX));
    errors.truncate(MOST);
    match SceneError::together(errors) {
        Some(error) => Err(error),
        None => made(table),
    }
}

/// Implements `Default` for tables whose keys all have defaults.
macro_rules! defaults {
    ($($Table:ident),+) => {
        $(impl Default for $Table {
            fn default() -> Self {
                let table = Reader::new("").table("", &DeTable::new(), None, Self::KEYS);
                made(table).expect("a test makes every default")
            }
        })+
    };
}
defaults!(Correction, Link, Method, Noise, Questions, Segment, Wiring);

/// Makes a struct from values that fit its rows.
fn made<T: for<'de> Deserialize<'de>>(table: Table) -> Result<T, SceneError> {
    T::deserialize(Value::Table(table)).map_err(|error| SceneError::at("", error.to_string()))
}

struct Reader<'a> {
    text: &'a str,
    errors: Vec<SceneError>,
    /// Headings of tables whose keys are in another one.
    misplaced: Vec<String>,
}

impl<'a> Reader<'a> {
    const fn new(text: &'a str) -> Self {
        Self {
            text,
            errors: Vec::new(),
            misplaced: Vec::new(),
        }
    }

    /// Adds an error at a key. `at` is its byte in the text, if it has one.
    fn refuse(&mut self, at: Option<usize>, path: &str, problem: String) {
        self.add(at, SceneError::at(path, problem));
    }

    fn add(&mut self, at: Option<usize>, error: SceneError) {
        let line = at.map(|byte| line_at(self.text, byte));
        self.errors.push(SceneError { line, ..error });
    }

    /// Returns the values of a table, with the defaults of keys that are left out. `at` is its byte in the text, if it has one.
    fn table(
        &mut self,
        path: &str,
        table: &DeTable,
        at: Option<usize>,
        keys: &'static [Key],
    ) -> Table {
        let mut values = Table::new();
        let mut unknown = Vec::new();
        for (name, value) in table {
            let Some(key) = keys.iter().find(|key| key.name == name.get_ref()) else {
                unknown.push(name);
                continue;
            };
            if let Some(value) = self.value(&join(path, key.name), key, &key.kind, value) {
                values.insert(key.name.to_owned(), value);
            }
        }
        // As in the file; a table has its keys in alphabetical order.
        unknown.sort_by_key(|name| name.span().start);
        let meant = self.refuse_unknown(path, &unknown, keys);
        for key in keys.iter().filter(|key| !table.contains_key(key.name)) {
            let path = join(path, key.name);
            match key.absent {
                Absent::Needed if meant.contains(&key.name) || self.is_misplaced(key) => {}
                Absent::Needed => self.refuse(at, &path, explain::missing(&path)),
                Absent::Nothing => {}
                Absent::Number(_) | Absent::Value(_) => {
                    let value = match key.kind {
                        Kind::Table(keys) => {
                            Some(self.table(&path, &DeTable::new(), at, keys()).into())
                        }
                        _ => keys::default(key),
                    };
                    values.extend(value.map(|value| (key.name.to_owned(), value)));
                }
            }
        }
        values
    }

    fn is_misplaced(&self, key: &Key) -> bool {
        let heading = keys::heading(key, key.name);
        heading.is_some_and(|heading| self.misplaced.contains(&heading))
    }

    /// Refuses keys that the table does not have. Returns the keys that they were probably meant to be.
    fn refuse_unknown(
        &mut self,
        path: &str,
        unknown: &[&Spanned<std::borrow::Cow<'_, str>>],
        keys: &'static [Key],
    ) -> Vec<&'static str> {
        let known: Vec<&str> = keys.iter().map(|key| key.name).collect();
        let names: Vec<String> = unknown
            .iter()
            .map(|name| explain::short(&explain::one_line(name.get_ref())))
            .collect();
        if let Some(heading) = explain::other_heading(&names) {
            let problem = explain::wrong_heading(path, &names, &heading);
            let at = Some(unknown[0].span().start);
            self.refuse(at, &join(path, &names[0]), problem);
            self.misplaced.push(heading);
            // Keys are missing because another table is here.
            return known;
        }
        let mut meant = Vec::new();
        for (i, (name, place)) in names.iter().zip(unknown).enumerate() {
            let nearest = explain::meant(name, &known);
            meant.extend(nearest);
            let problem = explain::unknown_key(name, nearest, &known, i == 0);
            self.refuse(Some(place.span().start), &join(path, name), problem);
        }
        meant
    }

    /// Returns a value of a key, or of an entry in its list; `None` if it is wrong.
    fn value(
        &mut self,
        path: &str,
        key: &Key,
        kind: &Kind,
        given: &Spanned<DeValue>,
    ) -> Option<Value> {
        let at = Some(given.span().start);
        let source = self.text.get(given.span()).unwrap_or_default();
        let problem = match (kind, given.get_ref()) {
            (Kind::Table(keys), DeValue::Table(table)) => {
                return Some(Value::Table(self.table(path, table, at, keys())));
            }
            (Kind::List(kind, length), DeValue::Array(list))
                if length.is_none_or(|length| length == list.len()) =>
            {
                let entries = list.iter().enumerate();
                // The first wrong entry shows what is wrong with all.
                let values: Option<_> = entries
                    .map(|(entry, value)| self.value(&format!("{path}[{entry}]"), key, kind, value))
                    .collect();
                return values.map(Value::Array);
            }
            (Kind::Flag, DeValue::Boolean(flag)) => return Some(Value::Boolean(*flag)),
            (Kind::Text, DeValue::String(text)) => return Some(Value::String(text.to_string())),
            (Kind::Word(words), DeValue::String(word)) => {
                if words.contains(&word.as_ref()) {
                    return Some(Value::String(word.to_string()));
                }
                explain::no_word(word, words)
            }
            (kind, value) => match number(kind, value, source) {
                Some(value) => {
                    let size = value
                        .as_float()
                        .or(value.as_integer().map(|whole| whole as f64));
                    match out_of_range(key, size.unwrap_or(f64::NAN)) {
                        None => return Some(value),
                        Some(problem) => {
                            self.add(at, SceneError::of(path, problem));
                            return None;
                        }
                    }
                }
                None => explain::wrong_form(path, kind, value, source),
            },
        };
        self.refuse(at, path, problem);
        None
    }
}

/// Returns a number, if the value is one of that form.
fn number(kind: &Kind, value: &DeValue, source: &str) -> Option<Value> {
    let float = |digits: &str| {
        let number: f64 = digits.parse().ok()?;
        let is_too_large = number.is_infinite() && !source.contains("inf");
        (!is_too_large).then_some(Value::Float(number))
    };
    match (kind, value) {
        (Kind::Number, DeValue::Float(digits)) => float(digits.as_str()),
        (Kind::Number, DeValue::Integer(digits)) => match digits.radix() {
            10 => float(digits.as_str()),
            radix => {
                let whole = i64::from_str_radix(digits.as_str(), radix).ok()?;
                Some(Value::Float(whole as f64))
            }
        },
        (Kind::Whole(least, most), DeValue::Integer(digits)) => {
            let whole = i64::from_str_radix(digits.as_str(), digits.radix()).ok()?;
            (*least..=*most)
                .contains(&whole)
                .then_some(Value::Integer(whole))
        }
        _ => None,
    }
}

/// Returns the problem of a number out of its key's range. A range that other keys decide is checked where these are known.
fn out_of_range(key: &Key, value: f64) -> Option<Problem> {
    let is_outside = key.high != f64::MAX && !(key.low..=key.high).contains(&value);
    is_outside.then(|| Problem::out_of_range(value, key.low, key.high))
}

fn join(path: &str, name: &str) -> String {
    match path {
        "" => name.to_owned(),
        path => format!("{path}.{name}"),
    }
}
