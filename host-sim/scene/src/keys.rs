//! Tables whose keys have rows, and what follows from the rows for readers: the tables of the manual, and a JSON Schema for editors.
//!
//! The rows are those of the core. Tables that have none yet are open in the schema: it accepts any key there.

use cophase_core::problem::Problem;
use cophase_core::settings::{Control, Drift, IndexSettings, Key, PulseSettings};
use serde_json::{Map, Value, json};

/// Table of a scene, and its rows.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Name in a scene.
    pub name: &'static str,
    /// Purpose, for the schema and behind the name in the manual.
    pub about: &'static str,
    /// Rows, in the order of the manual.
    pub keys: &'static [Key],
}

/// Tables whose keys have rows.
pub const SECTIONS: [Section; 4] = [
    Section {
        name: "control",
        about: "settings of the loop",
        keys: Control::KEYS,
    },
    Section {
        name: "index",
        about: "filter of the index lines",
        keys: IndexSettings::KEYS,
    },
    Section {
        name: "drift",
        about: "limits on phase errors",
        keys: Drift::KEYS,
    },
    Section {
        name: "pulse",
        about: "timing of the STEP and DIR lines",
        keys: PulseSettings::KEYS,
    },
];

/// Returns the row of a key path, such as `control.tick_hz`.
pub fn row(path: &str) -> Option<&'static Key> {
    let mut rows = SECTIONS.iter().flat_map(|section| section.keys);
    rows.find(|row| row.path == path)
}

/// Returns the table of a section for the manual, in Markdown.
pub fn manual_table(section: &Section) -> String {
    let rows = section.keys.iter().map(|row| {
        let (name, default, text) = (row.name(), row.default, sentences(row));
        format!("| `{name}` | {default} | {text} |\n")
    });
    let Section { name, about, .. } = section;
    format!(
        "| `[{name}]`, {about} | default | |\n| --- | --- | --- |\n{}",
        rows.collect::<String>()
    )
}

/// Returns the JSON Schema of a scene (draft 7, which editors of TOML know). Ranges are those of single keys: relations between keys are
/// checked when a scene is read.
pub fn schema() -> Value {
    let tables: Map<_, _> = SECTIONS
        .iter()
        .map(|section| (section.name.to_owned(), table(section)))
        .collect();
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of Cophase",
        "type": "object",
        "properties": tables,
        "additionalProperties": true,
    })
}

fn table(section: &Section) -> Value {
    let keys: Map<_, _> = section
        .keys
        .iter()
        .map(|row| (row.name().to_owned(), property(row)))
        .collect();
    json!({
        "type": "object",
        "description": section.about,
        "properties": keys,
        "additionalProperties": false,
    })
}

fn property(row: &Key) -> Value {
    let number = |value: f64| match row.is_whole {
        true => json!(value as u64),
        false => json!(value),
    };
    json!({
        "type": if row.is_whole { "integer" } else { "number" },
        "minimum": number(row.low),
        "maximum": number(row.high),
        "default": number(row.default),
        "description": sentences(row),
    })
}

/// Returns the sentences of a row, and its range with the unit.
fn sentences(row: &Key) -> String {
    let unit = match Problem::unit(row.path) {
        unit if unit.is_empty() || unit.starts_with('°') => unit.to_owned(),
        unit => format!(" {unit}"),
    };
    format!("{} {} to {}{unit}", row.doc.trim(), row.low, row.high)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANUAL: &str = include_str!("../../../docs/scenes.md");

    /// If this fails, the manual states a range or a default that does not apply.
    #[test]
    fn the_manual_has_the_table_of_every_section() {
        for section in &SECTIONS {
            let table = manual_table(section);
            assert!(MANUAL.contains(&table), "docs/scenes.md lacks\n{table}");
        }
    }

    #[test]
    fn every_default_is_within_its_range() {
        for row in SECTIONS.iter().flat_map(|section| section.keys) {
            assert!((row.low..=row.high).contains(&row.default), "{}", row.path);
        }
    }

    #[test]
    fn a_row_belongs_to_the_table_that_lists_it() {
        for section in &SECTIONS {
            for row in section.keys {
                assert_eq!(row.path, format!("{}.{}", section.name, row.name()));
            }
        }
    }
}
