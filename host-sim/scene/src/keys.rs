//! Rows of all keys of a scene, and what follows from them for readers: examples, the tables of the manual, and a JSON Schema for editors.

use cophase_core::problem::Problem;
use cophase_core::settings::key::{Absent, Key, Kind, Product};
use serde_json::{Map, Value, json};
use toml::Table;
use toml::de::{DeTable, DeValue};

use crate::digits::{hundredths, plain};
use crate::file::Scene;

/// Rows of a table, or of the tables in a list.
pub(crate) fn rows(kind: &Kind) -> Option<&'static [Key]> {
    match kind {
        Kind::Table(keys) => Some(keys()),
        Kind::List(Kind::Table(keys), _) => Some(keys()),
        _ => None,
    }
}

/// Returns the row of a key path, such as `control.tick_hz` or `limits.band[0].to_hz`.
pub fn row(path: &str) -> Option<&'static Key> {
    let mut keys = Scene::KEYS;
    let mut found = None;
    for step in path.split('.') {
        let name = step.split('[').next().unwrap_or(step);
        let key = keys.iter().find(|key| key.name == name)?;
        keys = rows(&key.kind).unwrap_or_default();
        found = Some(key);
    }
    found
}

/// Returns the heading of a table at a key path, or of the tables in a list.
pub(crate) fn heading(key: &Key, path: &str) -> Option<String> {
    match key.kind {
        Kind::Table(_) => Some(format!("[{path}]")),
        Kind::List(Kind::Table(_), _) => Some(format!("[[{path}]]")),
        _ => None,
    }
}

/// Returns the places of a key in scenes: the top level, in words, or headings.
pub(crate) fn homes(name: &str) -> Vec<String> {
    let has_it = |keys: &[Key]| keys.iter().any(|key| key.name == name);
    let is_at_top = |key: &Key| key.name == name && rows(&key.kind).is_none();
    if Scene::KEYS.iter().any(is_at_top) {
        return vec!["at the top, above the first [table]".to_owned()];
    }
    let sections = Scene::KEYS.iter();
    sections
        .filter(|key| rows(&key.kind).is_some_and(has_it))
        .filter_map(|key| heading(key, key.name))
        .collect()
}

/// Returns the default of a key.
pub(crate) fn default(key: &Key) -> Option<toml::Value> {
    Some(match (key.absent, key.kind) {
        (Absent::Number(number), Kind::Whole(..)) => (number as i64).into(),
        (Absent::Number(number), _) => number.into(),
        (Absent::Value(text), Kind::Text | Kind::Word(_)) => text.into(),
        (Absent::Value(text), Kind::Flag) => (text == "true").into(),
        (Absent::Value(_), Kind::Table(_)) => Table::new().into(),
        // No list of anything else has a default other than `[]`.
        (Absent::Value(text), _) => {
            let numbers = text.trim_matches(['[', ']']).split(',');
            let numbers = numbers.filter_map(|number| number.trim().parse().ok());
            toml::Value::Array(numbers.map(toml::Value::Integer).collect())
        }
        (Absent::Needed | Absent::Nothing, _) => return None,
    })
}

/// Returns the default of a key, or its example, as it is written in a scene.
fn written(key: &Key) -> Option<String> {
    let text = match (key.absent, key.example) {
        (Absent::Number(number), "") => return Some(number.to_string()),
        (Absent::Value(text), "") => text,
        (_, example) => example,
    };
    match key.kind {
        Kind::Text | Kind::Word(_) => Some(format!("\"{text}\"")),
        Kind::Table(keys) if key.example.is_empty() => Some(inline(keys())),
        Kind::List(Kind::Table(keys), _) if key.example.is_empty() => {
            Some(format!("[{}]", inline(keys())))
        }
        _ => Some(text.to_owned()).filter(|text| !text.is_empty()),
    }
}

/// Returns the required keys of a table with their examples: `{ from_hz = 10, to_hz = 12 }`.
fn inline(keys: &[Key]) -> String {
    let needed = keys.iter().filter(|key| key.absent == Absent::Needed);
    let all: Vec<_> = needed
        .filter_map(|key| Some(format!("{} = {}", key.name, written(key)?)))
        .collect();
    format!("{{ {} }}", all.join(", "))
}

/// Returns the form of a key path: `load_kg = 2`, `[limits]`, `[[program]]`; of an entry of a list, that of the first one.
pub(crate) fn example(path: &str) -> Option<String> {
    let key = row(path)?;
    if !path.contains('.')
        && let Some(heading) = heading(key, key.name)
    {
        return Some(heading);
    }
    let line = format!("{} = {}", key.name, written(key)?);
    if !path.ends_with(']') {
        return Some(line);
    }
    let depth = path.rsplit('.').next()?.matches('[').count();
    let table = DeTable::parse(&line).ok()?;
    let mut value = table.get_ref().get(key.name)?;
    for _ in 0..depth {
        let DeValue::Array(list) = value.get_ref() else {
            return None;
        };
        value = list.first()?;
    }
    line.get(value.span()).map(str::to_owned)
}

/// Returns the JSON Schema of a scene (draft 7, which editors of TOML know). Ranges are those of single keys: relations between keys are
/// checked when a scene is read.
pub fn schema() -> Value {
    let mut schema = table(Scene::KEYS);
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!("Scene of Cophase");
    // A program's blocks may contain blocks.
    if let Some(program) = row("program") {
        schema["definitions"] = json!({ SEGMENT: table(rows(&program.kind).unwrap_or_default()) });
    }
    schema
}

/// Definition of an entry of the program.
const SEGMENT: &str = "segment";

fn table(keys: &[Key]) -> Value {
    let properties: Map<_, _> = keys
        .iter()
        .map(|row| (row.name.to_owned(), property(row)))
        .collect();
    let needed: Vec<_> = keys
        .iter()
        .filter(|row| row.absent == Absent::Needed)
        .map(|row| row.name)
        .collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": needed,
        "additionalProperties": false,
    })
}

fn property(row: &Key) -> Value {
    let mut property = form(row, &row.kind);
    property["description"] = json!(sentences(row));
    if let Some(default) = default(row).filter(|default| !default.is_table()) {
        property["default"] = json!(default);
    }
    property
}

/// Returns the schema of a value of a key, or of an entry in its list.
fn form(row: &Key, kind: &Kind) -> Value {
    match kind {
        Kind::Number if row.is_open() => json!({ "type": "number" }),
        Kind::Number => json!({ "type": "number", "minimum": row.low, "maximum": row.high }),
        Kind::Whole(min, max) => json!({
            "type": "integer",
            "minimum": (row.low as i64).max(*min),
            "maximum": (row.high as i64).min(*max),
        }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Word(words) => json!({ "type": "string", "enum": words }),
        Kind::Table(_) if row.name == "segments" => {
            json!({ "$ref": format!("#/definitions/{SEGMENT}") })
        }
        Kind::Table(keys) => table(keys()),
        Kind::List(kind, length) => {
            let mut list = json!({ "type": "array", "items": form(row, kind) });
            if let Some(length) = length {
                list["minItems"] = json!(length);
                list["maxItems"] = json!(length);
            }
            list
        }
    }
}

/// Returns the sentences of a row, and its range with the unit.
fn sentences(row: &Key) -> String {
    let doc = row.doc.trim();
    if row.is_open() {
        return doc.to_owned();
    }
    let unit = match Problem::unit(row.name) {
        unit if unit.is_empty() || unit.starts_with('°') => unit.to_owned(),
        unit => format!(" {unit}"),
    };
    let [low, high] = shown_ends(row);
    let narrower = [("at least", row.at_least), ("at most", row.at_most)]
        .into_iter()
        .filter_map(|(word, product)| Some(format!(", {word} {}", formula(product?))));
    format!(
        "{doc} {low} to {high}{unit}{}",
        narrower.collect::<String>()
    )
}

/// Returns the ends of a range in few digits.
fn shown_ends(row: &Key) -> [String; 2] {
    [row.low, row.high].map(|end| plain(hundredths(end, f64::round)))
}

/// Returns a product as a formula: `0.5 × screen.length_mm`.
fn formula(product: Product) -> String {
    let factor = plain(hundredths(product.factor, f64::round));
    let power = |&(key, power): &(&str, i32)| {
        let sign = if power > 0 { '×' } else { '/' };
        let raised = match power.abs() {
            1 => "",
            2 => "²",
            _ => "³",
        };
        format!(" {sign} {key}{raised}")
    };
    let whole = format!(
        "{factor}{}",
        product.keys.iter().map(power).collect::<String>()
    );
    whole
        .replacen("-1 × ", "-", 1)
        .trim_start_matches("1 × ")
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANUAL: &str = include_str!("../../../docs/scenes.md");

    /// Line of a table in the manual: names of keys, and the cells of their defaults and their text.
    type Line<'a> = (Vec<&'a str>, &'a str, &'a str);

    /// Returns the tables of keys in the manual, with the path in the heading of each.
    fn manual_tables() -> Vec<(&'static str, Vec<Line<'static>>)> {
        let mut tables: Vec<(&str, Vec<Line>)> = Vec::new();
        let mut is_inside = false;
        for line in MANUAL.lines() {
            let cells: Vec<_> = line
                .split(" |")
                .map(|cell| cell.trim_start_matches('|').trim())
                .collect();
            let names = cells[0].split('`').skip(1).step_by(2);
            if cells.get(1) == Some(&"default") && cells[0].starts_with("`[") {
                let heading = names.map(|name| name.trim_matches(['[', ']'])).next();
                tables.extend(heading.map(|heading| (heading, Vec::new())));
                is_inside = true;
            } else if !line.starts_with('|') {
                is_inside = false;
            } else if let [_, default, text, ..] = cells[..]
                && is_inside
                && let Some((_, lines)) = tables.last_mut()
                && !default.starts_with("---")
            {
                lines.push((names.collect(), default, text));
            }
        }
        tables
    }

    /// If this fails, the manual states a range or a default that does not apply, or lacks one.
    #[test]
    fn tables_of_the_manual_have_the_defaults_and_ranges_of_the_rows() {
        let mut wrong = Vec::new();
        for (section, lines) in manual_tables() {
            let keys = rows(&row(section).unwrap().kind).unwrap();
            for (names, default, text) in lines {
                let mut defaults = match names[..] {
                    [_] => vec![default],
                    _ => default.split(", ").collect(),
                };
                if let [of_all] = defaults[..] {
                    defaults = vec![of_all; names.len()];
                }
                for (i, name) in names.iter().enumerate() {
                    let place = format!("{section}.{name}");
                    let key = keys.iter().find(|key| key.name == *name).expect(&place);
                    let of_another_table = default.contains("as in");
                    let stated = defaults.get(i).unwrap_or(&"").trim_matches('`');
                    let applies = match (key.absent, written(key)) {
                        (Absent::Needed, _) => stated.is_empty(),
                        (Absent::Nothing, _) => stated.parse::<f64>().is_err(),
                        (Absent::Value("[]"), _) => stated == "none",
                        (_, default) => stated == default.unwrap(),
                    };
                    if !applies && !of_another_table {
                        wrong.push(format!("{place}: default {stated}"));
                    }
                    let [low, high] = shown_ends(key);
                    let has_range = key.is_open() || text.contains(&format!("{low} to {high}"));
                    if !has_range && !of_another_table {
                        wrong.push(format!("{place}: no {low} to {high}"));
                    }
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    /// If this fails, the manual lacks a key.
    #[test]
    fn the_manual_has_every_key() {
        let tables = manual_tables();
        let mut absent = Vec::new();
        each(Scene::KEYS, "", &mut |key, path| {
            let (section, name) = path.rsplit_once('.').unwrap_or(("", path));
            let table = tables.iter().find(|(heading, _)| *heading == section);
            let is_there = match table {
                Some((_, lines)) if rows(&key.kind).is_none() => {
                    lines.iter().any(|(names, ..)| names.contains(&name))
                }
                _ => MANUAL.contains(name),
            };
            if !is_there {
                absent.push(path.to_owned());
            }
        });
        assert_eq!(absent, [""; 0]);
    }

    /// Calls a function for every row with its path.
    fn each(keys: &[Key], table: &str, check: &mut dyn FnMut(&Key, &str)) {
        for key in keys {
            let path = format!("{table}{}", key.name);
            check(key, &path);
            if key.name != "segments" {
                each(
                    rows(&key.kind).unwrap_or_default(),
                    &format!("{path}."),
                    check,
                );
            }
        }
    }

    /// If this fails, a default is refused, or an example is.
    #[test]
    fn defaults_and_examples_fit_their_rows() {
        each(Scene::KEYS, "", &mut |key, path| {
            if let Absent::Number(default) = key.absent {
                assert!((key.low..=key.high).contains(&default), "{path}");
            }
            for text in [default_text(key), Some(key.example)].into_iter().flatten() {
                let fits = match key.kind {
                    Kind::Word(words) => words.contains(&text),
                    Kind::Number | Kind::Whole(..) => {
                        let number: f64 = text.parse().unwrap_or(f64::NAN);
                        (key.low..=key.high).contains(&number)
                    }
                    _ => true,
                };
                assert!(fits || text.is_empty(), "{path}: {text}");
            }
            let has_default = !matches!(key.absent, Absent::Needed | Absent::Nothing);
            assert_eq!(default(key).is_some(), has_default, "{path}");
            if let (Absent::Value(text), Some(list @ toml::Value::Array(_))) =
                (key.absent, default(key))
            {
                assert_eq!(list.to_string(), text, "{path}");
            }
        });
    }

    fn default_text(key: &Key) -> Option<&'static str> {
        match key.absent {
            Absent::Value(text) => Some(text),
            _ => None,
        }
    }

    #[test]
    fn examples_have_the_form_of_their_key() {
        for (path, written) in [
            ("machine.load_kg", Some("load_kg = 2")),
            ("machine", Some("[machine]")),
            ("program", Some("[[program]]")),
            ("axis[7].number", Some("number = 1")),
            ("limits.band[3]", Some("{ from_hz = 10, to_hz = 12 }")),
            ("axes.pull_out[1]", Some("[0, 5.0]")),
            ("colour", None),
        ] {
            assert_eq!(example(path).as_deref(), written, "{path}");
        }
        assert_eq!(homes("load_kg"), ["[machine]"]);
        assert_eq!(homes("amax_g"), ["[[program]]"]);
        assert!(homes("fidelity")[0].starts_with("at the top"));
        assert!(homes("colour").is_empty());
    }
}
