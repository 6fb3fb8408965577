//! Every key of a scene, broken in each way that its row excludes. Each mistake gives one error, at its key.

use cophase_core::settings::key::{Absent, Key, Kind};

use super::parse;
use crate::{Scene, keys};

/// Mistake at a key: the line in its place, the key path of the error, and parts of its sentence.
struct Mistake {
    line: String,
    path: String,
    said: Vec<String>,
}

/// Returns lines with the required keys of a table, without one of them.
fn needed(table: &str, keys: &[Key], without: &str) -> String {
    keys.iter()
        .filter(|key| key.absent == Absent::Needed && key.name != without && !is_table(key))
        .map(|key| keys::example(&format!("{table}{}", key.name)).unwrap() + "\n")
        .collect()
}

fn is_table(key: &Key) -> bool {
    keys::rows(&key.kind).is_some()
}

/// Returns the required tables of a scene, without one of them.
fn sections(without: &str) -> String {
    Scene::KEYS
        .iter()
        .filter(|key| key.absent == Absent::Needed && is_table(key) && key.name != without)
        .map(|key| {
            let rows = keys::rows(&key.kind).unwrap();
            let table = needed(&format!("{}.", key.name), rows, "");
            format!("{}\n{table}", keys::heading(key, key.name).unwrap())
        })
        .collect()
}

/// Calls a function for each table of a scene, with its rows, its key path, and the text above its keys.
fn each_table(keys: &[Key], table: &str, above: &str, visit: &mut dyn FnMut(&[Key], &str, &str)) {
    visit(keys, table, above);
    for key in keys {
        // A program's blocks contain entries of a program.
        let Some(rows) = keys::rows(&key.kind).filter(|_| key.name != "segments") else {
            continue;
        };
        let path = format!("{table}{}", key.name);
        let heading = keys::heading(key, &path).unwrap();
        let above = format!("{above}{}{heading}\n", needed(table, keys, key.name));
        each_table(rows, &format!("{path}."), &above, visit);
    }
}

/// Breaks every key of every table.
fn sweep(mistakes: fn(&Key, &str) -> Vec<Mistake>) {
    each_table(Scene::KEYS, "", "", &mut |keys, table, above| {
        for key in keys {
            let path = format!("{table}{}", key.name);
            for Mistake { line, path, said } in mistakes(key, &path) {
                let rest = sections(path.split('.').next().unwrap());
                let text = format!("{above}{}{line}\n{rest}", needed(table, keys, key.name));
                let error = parse(&text).expect_err(&text);
                assert!(error.others.is_empty(), "{error}\n{text}");
                assert_eq!(error.key.replace("[0]", ""), path, "{error}\n{text}");
                for said in said {
                    assert!(error.problem.contains(&said), "not `{said}`: {error}");
                }
            }
        }
    });
}

fn mistake(key: &Key, path: &str, value: &str, said: &[&str]) -> Mistake {
    Mistake {
        line: format!("{} = {value}", key.name),
        path: path.to_owned(),
        said: said.iter().map(|&said| said.to_owned()).collect(),
    }
}

/// If this fails, a struct has no field for a row, or one of another type.
#[test]
fn every_table_is_made_of_its_rows() {
    each_table(Scene::KEYS, "", "", &mut |keys, table, above| {
        let section = table.split(['.', '[']).next().unwrap();
        let own = needed(table, keys, "");
        parse(&format!("{above}{own}\n{}", sections(section))).unwrap();
    });
}

#[test]
fn a_number_out_of_its_range_is_refused_with_the_nearest_end() {
    sweep(|key, path| {
        let (low, high) = (key.low, key.high);
        let outside = [" is outside ", "; give "];
        match key.kind {
            Kind::Number if high < f64::MAX => {
                let step = 0.01 * (high - low).min(low.abs().max(0.01));
                let finite = [low - step, high * 1.01, -1e300, 1e300]
                    .map(|value| mistake(key, path, &format!("{value:?}"), &outside));
                let other = ["nan", "inf", "-inf"].map(|value| {
                    mistake(key, path, value, &["is not a finite number; give one from"])
                });
                finite.into_iter().chain(other).collect()
            }
            Kind::Whole(min, _) if high < f64::MAX => [low - 1.0, high + 1.0]
                .into_iter()
                .filter(|value| *value >= min as f64)
                .map(|value| mistake(key, path, &value.to_string(), &outside))
                .collect(),
            Kind::List(Kind::Number, Some(length)) if high < f64::MAX => {
                let value = format!("{:?}", vec![high * 1.01; length]);
                vec![mistake(key, path, &value, &outside)]
            }
            _ => Vec::new(),
        }
    });
}

#[test]
fn a_value_of_another_type_is_refused_with_an_example() {
    sweep(|key, path| {
        let example = keys::example(path);
        assert!(example.is_some() || is_table(key), "{path} has no example");
        let such_as = format!("such as `{}`", example.unwrap_or_default());
        let wrong = |value: &str, said: &str| mistake(key, path, value, &[said, &such_as]);
        match key.kind {
            Kind::Number => vec![wrong(
                "\"much\"",
                "`\"much\"` is text, where a number belongs",
            )],
            Kind::Whole(..) => vec![
                wrong("\"much\"", "`\"much\"` is text, where a whole number"),
                mistake(key, path, "1.5", &["`1.5` is a number with a fraction"]),
            ],
            Kind::Flag => vec![wrong("1", "`1` is a number, where true or false belongs")],
            Kind::Text => vec![wrong("1", "`1` is a number, where text in quotes belongs")],
            Kind::Word(words) => vec![
                wrong("1", "`1` is a number, where text in quotes belongs"),
                mistake(
                    key,
                    path,
                    &format!("\"{}x\"", words[0]),
                    &[" is none of its values; did you mean \"", words[0]],
                ),
            ],
            Kind::List(Kind::Table(_), _) => vec![mistake(key, path, "1", &["a list belongs"])],
            Kind::List(_, Some(_)) => vec![wrong("[]", "`[]` has 0 in it, where a list of ")],
            Kind::List(_, None) => vec![wrong("1", "`1` is a number, where a list belongs")],
            Kind::Table(_) => vec![mistake(key, path, "1", &["a table belongs"])],
        }
    });
}

#[test]
fn a_misspelt_key_is_refused_with_its_right_name() {
    sweep(|key, path| {
        if key.name.len() < 4 {
            return Vec::new(); // too short to be recognised
        }
        let meant = format!("did you mean `{}`", key.name);
        vec![Mistake {
            line: format!("{}x = 1", key.name),
            path: format!("{path}x"),
            said: vec!["unknown key; ".to_owned(), meant],
        }]
    });
}

#[test]
fn a_required_key_that_is_missing_is_refused_with_an_example() {
    sweep(|key, path| {
        if key.absent != Absent::Needed {
            return Vec::new();
        }
        let such_as = format!("such as `{}`", keys::example(path).unwrap());
        vec![Mistake {
            line: String::new(),
            path: path.to_owned(),
            said: vec!["missing; it has no default".to_owned(), such_as],
        }]
    });
}
