//! Tests of the sentences about the form of a scene.

use crate::load::parse;
use crate::{SceneError, library};

/// The error of the default scene with one piece of its text replaced.
#[track_caller]
fn error(from: &str, to: &str) -> SceneError {
    let text = library::find("default").unwrap().text;
    assert!(text.contains(from), "{from}");
    parse(&text.replacen(from, to, 1)).unwrap_err()
}

#[track_caller]
fn assert_says(from: &str, to: &str, key: &str, problem: &str) {
    let error = error(from, to);
    assert_eq!((error.key.as_str(), error.problem.as_str()), (key, problem));
    assert!(error.line.is_some(), "{error}");
}

#[test]
fn unknown_keys_suggest_the_nearest_key_and_its_table() {
    let unknown = error("load_kg = 2", "load_kg = 2\nx = 8").problem;
    let (_, machine) = unknown.split_once("known here: ").unwrap();
    assert!(machine.starts_with("mechanism, crank_radius_mm, "));
    assert_says(
        "load_kg = 2",
        "load_g = 8",
        "machine.load_g",
        &format!("unknown key; did you mean `load_kg`, in kg? known here: {machine}"),
    );
    assert_says(
        "load_kg = 2",
        "load_kg = 2\ncolour = 8",
        "machine.colour",
        &format!("unknown key; known here: {machine}"),
    );
    assert_says(
        "load_kg = 2",
        "load_kg = 2\nspeed_hz = 8",
        "machine.speed_hz",
        &format!("unknown key; it belongs under [limits] or [[fault]]; known here: {machine}"),
    );
}

#[test]
fn unknown_values_list_the_valid_values() {
    assert_says(
        "platform = \"above\"",
        "platform = \"abov\"",
        "machine.platform",
        "\"abov\" is none of its values; did you mean \"above\"? give one of \"above\", \"below\"",
    );
    assert_says(
        "platform = \"above\"",
        "platform = \"top\"",
        "machine.platform",
        "\"top\" is none of its values; give one of \"above\", \"below\"",
    );
}

#[test]
fn missing_keys_come_with_an_example() {
    assert_says(
        "load_kg = 2",
        "",
        "machine.load_kg",
        "missing; it has no default, so give it, such as `load_kg = 2`",
    );
}

#[test]
fn wrong_types_name_the_actual_and_expected_type() {
    for (to, problem) in [
        (
            "\"8\"",
            "`\"8\"` is text, where a number belongs; write 8, without quotes",
        ),
        (
            "true",
            "`true` is true or false, where a number belongs; such as `load_kg = 2`",
        ),
        (
            "[8]",
            "`[8]` is a list, where a number belongs; such as `load_kg = 2`",
        ),
        (
            "{ a = 8 }",
            "`{ a = 8 }` is a table, where a number belongs; such as `load_kg = 2`",
        ),
        (
            "2020-01-01",
            "`2020-01-01` is a date, where a number belongs; such as `load_kg = 2`",
        ),
    ] {
        assert_says(
            "load_kg = 2",
            &format!("load_kg = {to}"),
            "machine.load_kg",
            problem,
        );
    }
    let count = "where a whole number, 0 or more, belongs";
    for (to, problem) in [
        (
            "4.0",
            format!("`4.0` is a number with a fraction or exponent, {count}; such as `count = 4`"),
        ),
        (
            "-4",
            format!("`-4` is negative, {count}; such as `count = 4`"),
        ),
        (
            "\"4\"",
            format!("`\"4\"` is text, {count}; write 4, without quotes"),
        ),
    ] {
        assert_says(
            "count = 4",
            &format!("count = {to}"),
            "axes.count",
            &problem,
        );
    }
}

#[test]
fn long_texts_are_cut() {
    let long = "x".repeat(10_000);
    for (from, to) in [
        ("load_kg = 2", format!("load_kg = \"{long}\"")),
        ("load_kg = 2", format!("{long} = 8")),
        ("load_kg = 2", format!("load_kg = {long}")),
        ("platform = \"above\"", format!("platform = \"{long}\"")),
    ] {
        let error = error(from, &to).to_string();
        assert!(error.len() < 500, "{error}");
    }
}
