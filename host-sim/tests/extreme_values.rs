//! Extreme values of every number of the built-in scenes. A check that loops or allocates over a number before it is checked hangs, or
//! ends the process.

use std::collections::BTreeSet;

use cophase_scene::library::SCENES;
use cophase_scene::load;
use host_sim::checked::Checked;
use toml::Value;

/// Part of the path to a number.
#[derive(Clone)]
enum Part {
    Key(String),
    Entry(usize),
}

/// Collects the paths to all numbers, each with its name without the entry's number.
fn numbers(value: &Value, path: &mut Vec<Part>, found: &mut Vec<Vec<Part>>) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                path.push(Part::Key(key.clone()));
                numbers(value, path, found);
                path.pop();
            }
        }
        Value::Array(entries) => {
            for (i, value) in entries.iter().enumerate() {
                path.push(Part::Entry(i));
                numbers(value, path, found);
                path.pop();
            }
        }
        Value::Integer(_) | Value::Float(_) => found.push(path.clone()),
        _ => {}
    }
}

fn name(path: &[Part]) -> String {
    let part = |part: &Part| match part {
        Part::Key(key) => format!(".{key}"),
        Part::Entry(_) => "[]".to_owned(),
    };
    path.iter().map(part).collect()
}

fn at<'a>(scene: &'a mut Value, path: &[Part]) -> &'a mut Value {
    path.iter().fold(scene, |value, part| match part {
        Part::Key(key) => value.get_mut(key).unwrap(),
        Part::Entry(i) => value.get_mut(i).unwrap(),
    })
}

/// Every key is tried in the first scene that has it, and the number of axes in every scene.
#[test]
fn extreme_values_of_every_key_are_answered() {
    let mut tried = BTreeSet::new();
    let mut answers = [0, 0];
    for built_in in SCENES {
        // With the keys that have a default.
        let whole = toml::to_string(&load::parse(built_in.text).unwrap()).unwrap();
        let scene: Value = toml::from_str(&whole).unwrap();
        let mut paths = Vec::new();
        numbers(&scene, &mut Vec::new(), &mut paths);
        for path in paths {
            let key = name(&path);
            if !tried.insert(key.clone()) && key != ".axes.count" {
                continue;
            }
            let integers = [i64::MAX, i64::from(u32::MAX), 0, -1, i64::MIN];
            let floats = [1e308, -1e308, 5e-324, f64::INFINITY, f64::NAN];
            let values = integers.map(Value::Integer).into_iter();
            for value in values.chain(floats.map(Value::Float)) {
                let mut extreme = scene.clone();
                *at(&mut extreme, &path) = value;
                let text = toml::to_string(&extreme).unwrap();
                let checked = load::parse(&text).and_then(Checked::new);
                answers[usize::from(checked.is_ok())] += 1;
            }
        }
    }
    println!("{} keys, {answers:?} refused and accepted", tried.len());
    assert!(tried.len() > 120, "only {} keys were tried", tried.len());
    assert!(answers[0] > 500, "only {} were refused", answers[0]);
    // A count in each scene that has one is refused with its key.
    for built_in in SCENES {
        let mut scene: Value = toml::from_str(built_in.text).unwrap();
        *at(
            &mut scene,
            &[Part::Key("axes".into()), Part::Key("count".into())],
        ) = Value::Integer(i64::MAX);
        let text = toml::to_string(&scene).unwrap();
        let error = load::parse(&text).and_then(Checked::new).unwrap_err();
        assert!(error.to_string().contains("axes.count"), "{error}");
    }
}
