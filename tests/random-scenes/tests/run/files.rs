//! The results of a run: its files, its text and its exit status agree, and every number is finite.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use cophase::Status;
use serde_json::Value;

use super::command::Run;

/// Files of a run, as listed in `docs/formats.md`.
const FILES: [&str; 4] = ["report.json", "scope.svg", "steps.vcd", "trace.csv"];
/// File of a run whose machine has motors with known torque.
const RANGE: &str = "torque.svg";

/// Places where `docs/formats.md` allows a report without a number. `*` is any entry of a list.
const MAY_BE_NULL: [&str; 8] = [
    "fidelity.outputs.*.value",
    "fidelity.outputs.*.bound",
    "fidelity.outputs.*.measured",
    "fidelity.outputs.*.against",
    "fidelity.outputs.*.step_error",
    "axes.*.pull_out_used",
    "reported_faults.*.axis",
    "faults.*.axis",
];

/// Checks that the text contains no word for a number that is not finite.
pub fn no_number(place: &str, text: &str) -> Result<(), String> {
    let is_none = |word: &&str| {
        matches!(
            word.to_ascii_lowercase().as_str(),
            "nan" | "inf" | "infinite" | "infinity"
        )
    };
    for line in text.lines() {
        if line
            .split(|c: char| !c.is_alphanumeric())
            .any(|word| is_none(&word))
        {
            return Err(format!("{place} has a number that is none: {line}"));
        }
    }
    Ok(())
}

/// Names of the files in a folder.
fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect()
}

/// Checks that a refused run has left no file.
pub fn check_none(folder: &Path) -> Result<(), String> {
    let left = names(folder);
    if left.is_empty() {
        Ok(())
    } else {
        Err(format!("status 2, and yet there are files: {left:?}"))
    }
}

/// Reads a text file of a run.
pub fn read(folder: &Path, name: &str) -> Result<String, String> {
    fs::read_to_string(folder.join(name)).map_err(|error| format!("{name}: {error}"))
}

/// Checks the files of a completed run, and the text that it printed.
pub fn check(folder: &Path, run: &Run) -> Result<(), String> {
    let mut left = names(folder);
    if left.remove(RANGE) {
        let picture = read(folder, RANGE)?;
        no_number(RANGE, &picture)?;
        if !picture.trim_end().ends_with("</svg>") {
            return Err(format!("{RANGE} does not end"));
        }
    }
    if !left.iter().eq(FILES.iter()) {
        return Err(format!("the files are {left:?}"));
    }
    for name in FILES {
        no_number(name, &read(folder, name)?)?;
    }
    no_number("the text", &run.out)?;
    no_number("the error text", &run.err)?;
    check_trace(&read(folder, "trace.csv")?)?;
    if !read(folder, "scope.svg")?.trim_end().ends_with("</svg>") {
        return Err("scope.svg does not end".to_owned());
    }
    let report = read(folder, "report.json")?;
    let report = serde_json::from_str(&report).map_err(|error| format!("report.json: {error}"))?;
    check_null("", &report)?;
    check_words(&report, run)
}

/// Checks that every field but those with words is a finite number, and that all rows have the same
/// fields.
fn check_trace(text: &str) -> Result<(), String> {
    let mut rows = text.lines();
    let header: Vec<&str> = rows.next().unwrap_or_default().split(',').collect();
    if !rows.clone().any(|row| !row.is_empty()) {
        return Err("trace.csv has no row".to_owned());
    }
    for (i, row) in rows.enumerate() {
        let fields: Vec<&str> = row.split(',').collect();
        if fields.len() != header.len() {
            return Err(format!("trace.csv, row {i}, has {} fields", fields.len()));
        }
        for (name, field) in header.iter().zip(fields) {
            let is_finite = || field.parse().is_ok_and(f64::is_finite);
            if !["state", "version", "commit"].contains(name) && !is_finite() {
                return Err(format!("trace.csv, row {i}: {name} is {field}"));
            }
        }
    }
    Ok(())
}

fn check_null(place: &str, value: &Value) -> Result<(), String> {
    let inside = |name: &str| {
        if place.is_empty() {
            name.to_owned()
        } else {
            format!("{place}.{name}")
        }
    };
    match value {
        Value::Null if MAY_BE_NULL.contains(&place) => Ok(()),
        Value::Null => Err(format!("report.json: {place} is null")),
        Value::Array(entries) => {
            let place = inside("*");
            entries
                .iter()
                .try_for_each(|entry| check_null(&place, entry))
        }
        Value::Object(entries) => entries
            .iter()
            .try_for_each(|(name, entry)| check_null(&inside(name), entry)),
        _ => Ok(()),
    }
}

/// Checks that the text agrees with the report, and that the exit status follows from the report.
fn check_words(report: &Value, run: &Run) -> Result<(), String> {
    let out = &run.out;
    let warnings: Vec<&str> = report["warnings"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    let printed: Vec<&str> = out
        .lines()
        .filter_map(|line| line.strip_prefix("Warning: "))
        .filter(|warning| !warning.starts_with("steps.vcd is empty"))
        .collect();
    if printed != warnings {
        return Err(format!(
            "the text warns of {printed:#?}, the report of {warnings:#?}"
        ));
    }
    let warns = |start: &str| warnings.iter().any(|warning| warning.starts_with(start));
    let has_diverged = warns("The simulated machine diverged");
    let ended = &report["ended"];
    let (Some(has_fault), Some(state)) = (ended["fault"].as_bool(), ended["state"].as_str()) else {
        return Err(format!("report.json: ended is {ended}"));
    };
    // A fault that is superseded by a more exact one is listed again, with its tick.
    let mut ticks: Vec<_> = report["faults"].as_array().into_iter().flatten().collect();
    ticks.dedup_by_key(|fault| fault["tick"].as_u64());
    let faults = ticks.len();
    let ending = match (has_diverged, has_fault, state) {
        (true, ..) => "The simulated machine diverged: its equations".to_owned(),
        (_, true, "fault") => "A fault ".to_owned(),
        (_, true, state) if faults == 1 => {
            format!("There was 1 fault, and the machine ended in state `{state}`.")
        }
        (_, true, state) => {
            format!("There were {faults} faults, and the machine ended in state `{state}`.")
        }
        (_, false, "parked") if ended["stopped_by"] == "request" => {
            "The machine was stopped on request, and parked.".to_owned()
        }
        (_, false, "parked") => "The program ran to its end, and the machine parked.".to_owned(),
        (_, false, state) => format!("The machine ended in state `{state}`."),
    };
    if !out.lines().any(|line| line.starts_with(&ending)) {
        return Err(format!(
            "the text has no line \"{ending}\", and ended is {ended}"
        ));
    }
    if has_fault != (faults > 0) {
        return Err(format!("ended is {ended}, and there are {faults} faults"));
    }
    let has_lost = |warning: &&str| warning.contains("and the controller did not notice");
    let right = if has_fault || has_diverged || warnings.iter().any(has_lost) {
        Status::Fault
    } else {
        Status::Done
    };
    if run.status == right {
        Ok(())
    } else {
        Err(format!(
            "the exit status is {:?}, and by the report {right:?}",
            run.status
        ))
    }
}

/// Checks that two runs of a scene left the same bytes, except for the speed of the run.
pub fn check_same(one: &Path, other: &Path) -> Result<(), String> {
    for name in FILES {
        let (mut one, mut other) = (read(one, name)?, read(other, name)?);
        if name == "report.json" {
            one = without_speed(&one)?;
            other = without_speed(&other)?;
        }
        if one != other {
            return Err(format!("a second run writes another {name}"));
        }
    }
    Ok(())
}

fn without_speed(report: &str) -> Result<String, String> {
    let report: Result<Value, _> = serde_json::from_str(report);
    let mut report = report.map_err(|error| format!("report.json: {error}"))?;
    report["speed"] = Value::Null;
    Ok(report.to_string())
}
