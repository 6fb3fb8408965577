//! Errors in the form of a scene: tables, keys, types, and TOML syntax.

use super::edit::{append, before, replace, set, with_line};
use super::{assert_all_refused, case};

#[test]
fn unknown_and_missing_tables_and_keys_are_refused() {
    assert_all_refused(&[
        case(
            "misspelt table",
            replace("[limits]", "[limit]"),
            "limit",
            "unknown key",
            "`limits`",
        ),
        case(
            "misspelt machine",
            replace("[machine]", "[machin]"),
            "machin",
            "unknown key",
            "`machine`",
        ),
        case(
            "misspelt key",
            replace("lambda =", "lamda ="),
            "machine.lamda",
            "unknown key",
            "`lambda`",
        ),
        case(
            "key out of its table",
            before("name", "load_kg = 3"),
            "load_kg",
            "unknown key",
            "it belongs under [machine]",
        ),
        case(
            "key in another table",
            before("control.tick_hz", "speed_hz = 3"),
            "control.speed_hz",
            "unknown key",
            "it belongs under [limits]",
        ),
        case(
            "a key of the top below a table",
            append("fidelity = \"kinematic\""),
            "scope.fidelity",
            "unknown key",
            "it belongs at the top, above the first [table]",
        ),
        case(
            "the name below a list",
            append("[[fault]]\nat_s = 1\nkind = \"stop-input\"\nname = \"x\""),
            "fault[0].name",
            "unknown key",
            "it belongs at the top, above the first [table]",
        ),
        case(
            "invented key",
            before("machine.lambda", "colour = 3"),
            "machine.colour",
            "unknown key",
            "known here: mechanism, crank_radius_mm, lambda",
        ),
    ]);
}

#[test]
fn values_of_the_wrong_type_are_refused() {
    let load = |value, wrong, right| {
        case(
            "type",
            set("machine.load_kg", value),
            "machine.load_kg",
            wrong,
            right,
        )
    };
    let such_as = "where a number belongs; such as `load_kg =";
    assert_all_refused(&[
        load("\"10\"", "`\"10\"` is text", "write 10, without quotes"),
        load("\"ten\"", "`\"ten\"` is text", such_as),
        load("true", "`true` is true or false", such_as),
        load("[10]", "`[10]` is a list", such_as),
        load("{ kg = 10 }", "`{ kg = 10 }` is a table", such_as),
        load("2020-01-01", "`2020-01-01` is a date", such_as),
        case(
            "a list for a text",
            set("machine.platform", "[\"above\"]"),
            "machine.platform",
            "`[\"above\"]` is a list",
            "platform = \"above\"",
        ),
    ]);
}

#[test]
fn toml_syntax_errors_are_refused() {
    let line = |name, line, wrong, right| {
        let text = with_line("machine.load_kg", line);
        case(name, text, "machine.load_kg", wrong, right)
    };
    let form = "the form is `load_kg = 2`";
    assert_all_refused(&[
        line("no value", "load_kg =", "the value is missing", form),
        line(
            "no sign",
            "load_kg 10",
            "is not TOML, at `load_kg 10`: `=` is between key and value",
            "write `load_kg = 10`",
        ),
        line(
            "a unit",
            "load_kg = 10 kg",
            "is not TOML, at `load_kg = 10 kg`: a number has no unit",
            "write `load_kg = 10`",
        ),
        line(
            "no end",
            "load_kg = \"10",
            "is not TOML, at `load_kg = \"10`",
            form,
        ),
        case(
            "twice",
            before("machine.load_kg", "load_kg = 3"),
            "machine.load_kg",
            "given before",
            "keep one of the two",
        ),
        case(
            "an entry of a list without its second brackets",
            append("[program]\namax_g = 1"),
            "program",
            "given before",
            "write [[program]] at each of its entries",
        ),
        case(
            "twice in an entry",
            set("limits.band", "[{ from_hz = 6, to_hz = 6.5, from_hz = 7 }]"),
            "limits.band",
            "`from_hz` is given before",
            "keep one of the two",
        ),
        case(
            "table twice",
            replace("[control]", "[machine]"),
            "machine",
            "given before",
            "keep one of the two",
        ),
        case(
            "a Greek letter for its name",
            replace("lambda =", "λ ="),
            "machine.lambda",
            "`λ` (U+03BB) is a Greek letter",
            "write `lambda = 0.3`",
        ),
        case(
            "an invisible character in a value",
            set("machine.platform", "\"ab\u{200b}ove\""),
            "machine.platform",
            "U+200B is an invisible character",
            "write \"above\"",
        ),
        case(
            "a decimal comma in a list",
            set("axes.pull_out", "[[0, 20,0], [20, 15,0]]"),
            "axes.pull_out[0]",
            "has 3 in it",
            "write `[0, 20.0]`",
        ),
        case(
            "a range in a list",
            set("axes.ratio", "[1..2]"),
            "axes.ratio",
            "two numbers have a comma between them",
            "write `ratio = [1, 2]`",
        ),
        case(
            "a list of entries in braces",
            set(
                "limits.band",
                "{ { from_hz = 6, to_hz = 6.5 }, { from_hz = 8, to_hz = 9 } }",
            ),
            "limits.band",
            "a list is in [ ]",
            "write `band = [{ from_hz = 6, to_hz = 6.5 }, { from_hz = 8, to_hz = 9 }]`",
        ),
        case(
            "a usual name of a key",
            replace("position_gain_per_s =", "kp ="),
            "axes.servo.kp",
            "unknown key",
            "did you mean `position_gain_per_s`",
        ),
        case(
            "a missing heading",
            replace("[machine]\n", ""),
            "mechanism",
            "the heading [machine] is missing above this line",
            "crank_radius_mm",
        ),
        case(
            "the heading of another machine",
            replace("[machine]\n", "[screen]\n"),
            "screen.mechanism",
            "are keys of [machine]",
            "write [machine] in the place of [screen]",
        ),
        case(
            "JSON",
            "{\"name\": \"x\"}\n".to_owned(),
            "",
            "is data (JSON) and no scene",
            "cophase scenes default > my.toml",
        ),
        case(
            "prose",
            "Shake it well.\n".to_owned(),
            "",
            "is not TOML, at `Shake it well.`",
            "write `key = value`",
        ),
        case(
            "nothing",
            String::new(),
            "",
            "is empty",
            "cophase scenes default > my.toml",
        ),
        case(
            "comments",
            "# to do\n\n".to_owned(),
            "",
            "is empty",
            "cophase scenes default > my.toml",
        ),
    ]);
}

/// If this fails, a syntax mistake from another language gets the TOML parser's own message, which suggests no fix.
#[test]
fn syntax_of_other_languages_is_refused_with_a_fix() {
    let line = |name, line, right| {
        let text = with_line("machine.load_kg", line);
        case(name, text, "machine.load_kg", "is not TOML, at `", right)
    };
    assert_all_refused(&[
        line(
            "a decimal comma",
            "load_kg = 10,5",
            "write `load_kg = 10.5`",
        ),
        line(
            "a decimal comma and a comment",
            "load_kg = 10,5 # kg",
            "a number has a decimal point: write `load_kg = 10.5 # kg`",
        ),
        line(
            "a comment of C",
            "load_kg = 10 // kg",
            "a comment begins with #: write `load_kg = 10  # kg`",
        ),
        line("a semicolon", "load_kg = 10;", "write `load_kg = 10`"),
        line("a comma", "load_kg = 10,", "write `load_kg = 10`"),
        line("a colon", "load_kg: 10", "write `load_kg = 10`"),
        case(
            "a line of comment of C",
            before("name", "// my scene"),
            "",
            "is not TOML, at `// my scene`",
            "a comment begins with #",
        ),
        case(
            "a line of comment of an INI file",
            before("name", "; heavy"),
            "",
            "is not TOML, at `; heavy`",
            "a comment begins with #",
        ),
    ]);
}

/// A message that quotes text from a file stays one line that a terminal can show.
#[test]
fn messages_escape_and_shorten_quoted_text() {
    let long = "x".repeat(100_000);
    assert_all_refused(&[
        case(
            "a bell in a key",
            before("machine.lambda", "\"a\\u0007\\nb\" = 1"),
            "machine.a\\u{7} b",
            "unknown key",
            "known here",
        ),
        case(
            "an escape in a value",
            set("machine.platform", "\"\\u001b[2J\""),
            "machine.platform",
            "is none of its values",
            "\"above\", \"below\"",
        ),
        case(
            "a long value",
            set("machine.platform", &format!("\"{long}\"")),
            "machine.platform",
            "xxx…\" is none of its values",
            "\"above\", \"below\"",
        ),
        case(
            "a long line",
            with_line("machine.load_kg", &format!("load_kg = {long}")),
            "machine.load_kg",
            "is not TOML",
            "the form is `load_kg = 2`",
        ),
    ]);
}
