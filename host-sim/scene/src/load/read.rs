//! Reader of a scene's TOML tree. It compares the tree with the rows of the keys, finds all errors in one pass, and fills in the defaults.
//!
//! A *key path* has the form `limits.band[0].from_hz`, with entries counted from 0.

use std::borrow::Cow;

use cophase_core::settings::key::{Absent, Key, Kind};
use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use super::place::{line_at, placed};
use super::{explain, ranges};
use crate::file::{Correction, Link, MACHINES, Method, Noise, Questions, Scene, Segment, Wiring};
use crate::{SceneError, keys};

/// Makes a scene of a document, whose text gives the lines.
///
/// # Errors
/// Keys that no scene has, keys that are missing, values of another type, and numbers out of their range: up to ten, by line.
pub(super) fn scene(text: &str, document: &DeTable) -> Result<Scene, SceneError> {
    let mut reader = Reader::new(text);
    reader.refuse_second_machine(document);
    let table = reader.table("", document, None, Scene::KEYS);
    reader.refuse_missing();
    let mut errors = reader.errors;
    let outside = ranges::outside(&table);
    errors.extend(outside.map(|error| placed(error, text, document)));
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
    T::deserialize(Value::Table(table)).map_err(|error| SceneError::for_key("", error.to_string()))
}

struct Reader<'a> {
    text: &'a str,
    errors: Vec<SceneError>,
    /// Paths of required keys that are missing, with the byte of the table that lacks each.
    missing: Vec<(Option<usize>, String)>,
    /// Tables that lack keys for a reason that is reported: the keys are in another table, or the whole table is too much.
    excused: Vec<String>,
}

impl<'a> Reader<'a> {
    const fn new(text: &'a str) -> Self {
        Self {
            text,
            errors: Vec::new(),
            missing: Vec::new(),
            excused: Vec::new(),
        }
    }

    /// Adds an error at a key. `at` is its byte in the text, if it has one.
    fn refuse(&mut self, at: Option<usize>, path: &str, problem: String) {
        let line = at.map(|byte| line_at(self.text, byte));
        let error = SceneError::for_key(path, problem);
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
        for key in keys {
            if let Some(value) = table.get(key.name)
                && let Some(value) = self.value(&join(path, key.name), &key.kind, value)
            {
                values.insert(key.name.to_owned(), value);
            }
        }
        let meant = self.refuse_unknown(path, table, keys);
        for key in keys.iter().filter(|key| !table.contains_key(key.name)) {
            let path = join(path, key.name);
            match key.absent {
                Absent::Needed if meant.contains(&key.name) => {}
                Absent::Needed => self.missing.push((at, path)),
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

    /// Refuses the keys that are missing, unless their table is excused.
    fn refuse_missing(&mut self) {
        for (at, path) in std::mem::take(&mut self.missing) {
            let section = path.split(['.', '[']).next().unwrap_or_default();
            if !self.excused.iter().any(|excused| excused == section) {
                self.refuse(at, &path, explain::missing(&path));
            }
        }
    }

    /// Refuses all machines but the first.
    fn refuse_second_machine(&mut self, document: &DeTable) {
        let is_machine = |name: &str| MACHINES.contains(&name);
        let given = document.iter().map(|(name, _)| name);
        let mut given: Vec<_> = given.filter(|name| is_machine(name.get_ref())).collect();
        given.sort_by_key(|name| name.span().start);
        let Some((first, others)) = given.split_first() else {
            return;
        };
        for other in others {
            let problem = format!(
                "given together with [{}]; a scene has one machine: leave one out",
                first.get_ref()
            );
            self.refuse(Some(other.span().start), other.get_ref(), problem);
            self.excused.push(other.get_ref().to_string());
        }
    }

    /// Refuses keys that the table does not have. Returns the keys that they were probably meant to be.
    fn refuse_unknown(
        &mut self,
        path: &str,
        table: &DeTable,
        keys: &'static [Key],
    ) -> Vec<&'static str> {
        let unknown = unknown_in(table, keys);
        let known: Vec<&str> = keys.iter().map(|key| key.name).collect();
        let names: Vec<String> = unknown
            .iter()
            .map(|name| explain::short(&explain::one_line(name.get_ref())))
            .collect();
        if let Some(heading) = explain::other_heading(&names) {
            let of_heading = keys::row(heading.trim_matches(['[', ']']));
            let of_heading = of_heading
                .and_then(|row| keys::rows(&row.kind))
                .unwrap_or_default();
            let is_there = |name: &str| of_heading.iter().any(|key| key.name == name);
            let has_others = table.iter().any(|(name, _)| {
                known.contains(&name.get_ref().as_ref()) && !is_there(name.get_ref())
            });
            let problem = explain::wrong_heading(path, &names, has_others, &heading);
            let at = Some(unknown[0].span().start);
            self.refuse(at, &join(path, &names[0]), problem);
            self.excused
                .push(heading.trim_matches(['[', ']']).to_owned());
            // Keys are missing because another table is here.
            return known;
        }
        let mut meant = Vec::new();
        for (i, (name, place)) in names.iter().zip(&unknown).enumerate() {
            let nearest = explain::meant(name, &known);
            meant.extend(nearest);
            let problem = explain::unknown_key(path, name, nearest, &known, i == 0);
            self.refuse(Some(place.span().start), &join(path, name), problem);
        }
        meant
    }

    /// Returns a value of a key, or of an entry in its list; `None` if it is wrong.
    fn value(&mut self, path: &str, kind: &Kind, given: &Spanned<DeValue>) -> Option<Value> {
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
                    .map(|(entry, value)| self.value(&format!("{path}[{entry}]"), kind, value))
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
            (Kind::List(Kind::Table(keys), _), DeValue::Table(table)) => {
                // The keys may be those of another table.
                let unknown = unknown_in(table, keys());
                let names: Vec<_> = unknown
                    .iter()
                    .map(|name| name.get_ref().to_string())
                    .collect();
                if let Some(heading) = explain::other_heading(&names) {
                    self.excused
                        .push(heading.trim_matches(['[', ']']).to_owned());
                    explain::wrong_heading(path, &names, false, &heading)
                } else {
                    explain::wrong_form(path, kind, given.get_ref(), source)
                }
            }
            (kind, value) => match number(kind, value, source) {
                Some(value) => return Some(value),
                None => explain::wrong_form(path, kind, value, source),
            },
        };
        self.refuse(at, path, problem);
        None
    }
}

/// Returns the keys of a table that have no row, in the order of the file.
fn unknown_in<'a, 'i>(table: &'a DeTable<'i>, keys: &[Key]) -> Vec<&'a Spanned<Cow<'i, str>>> {
    let names = table.iter().map(|(name, _)| name);
    let is_unknown = |name: &&Spanned<Cow<str>>| keys.iter().all(|key| key.name != name.get_ref());
    let mut unknown: Vec<_> = names.filter(is_unknown).collect();
    unknown.sort_by_key(|name| name.span().start);
    unknown
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
        (Kind::Whole(min, max), DeValue::Integer(digits)) => {
            let whole = i64::from_str_radix(digits.as_str(), digits.radix()).ok()?;
            (*min..=*max)
                .contains(&whole)
                .then_some(Value::Integer(whole))
        }
        _ => None,
    }
}

pub(super) fn join(path: &str, name: &str) -> String {
    match path {
        "" => name.to_owned(),
        path => format!("{path}.{name}"),
    }
}
