//! Tests of the repairs, and of what is left alone.

use super::*;

/// The repair of a line that follows the head of a table.
#[track_caller]
fn repaired(line: &str) -> Repaired {
    let text = format!("[t]\n{line}\nafter = 1\n");
    let error = DeTable::parse(&text).expect_err("the line is TOML");
    let at = error.span().unwrap().start;
    repair(&text, at).unwrap_or_else(|| panic!("`{line}` is not repaired"))
}

#[test]
fn each_mistake_is_repaired_and_its_rule_is_named() {
    for (line, right, rule) in [
        (
            "a = −5",
            "a = -5",
            "`−` (U+2212) is a minus sign; `-` belongs there",
        ),
        (
            "a = –5",
            "a = -5",
            "`–` (U+2013) is an en dash; `-` belongs there",
        ),
        (
            "a =\u{a0}8",
            "a = 8",
            "U+00A0 is a no-break space; a plain space belongs there",
        ),
        (
            "a = 8\u{200b}",
            "a = 8",
            "U+200B is an invisible character; delete it",
        ),
        (
            "a = “x”",
            "a = \"x\"",
            "`“` (U+201C) is a curly quotation mark; `\"` belongs there",
        ),
        (
            "a = \"x”",
            "a = \"x\"",
            "`”` (U+201D) is a curly quotation mark; `\"` belongs there",
        ),
        (
            "a = １８",
            "a = 18",
            "`１` (U+FF11) is a full-width character; `1` belongs there",
        ),
        (
            "a ＝ 8",
            "a = 8",
            "`＝` (U+FF1D) is a full-width character; `=` belongs there",
        ),
        ("a = 60,5", "a = 60.5", "a number has a decimal point"),
        (
            "a = 40\u{2009}000",
            "a = 40000",
            "U+2009 is a wide or thin space; the digits of a number stay together",
        ),
        (
            "\u{430}max_g = 80",
            "amax_g = 80",
            "`\u{430}` (U+0430) is a Cyrillic letter; `a` belongs there",
        ),
        (
            "a = [[0, 300], [200 300]]",
            "a = [[0, 300], [200, 300]]",
            "a comma is between two entries",
        ),
        (
            "a = 35\u{2019}000",
            "a = 35000",
            "`\u{2019}` (U+2019) is a curly quotation mark; the digits of a number stay together",
        ),
        (
            "a = 1.5·10⁻³",
            "a = 1.5e-3",
            "a power of ten is written with e",
        ),
        (
            "a = [[0, 33.0], [61, 30.0]]]",
            "a = [[0, 33.0], [61, 30.0]]",
            "one `]` is too many",
        ),
        ("a = { b = 1 }}", "a = { b = 1 }", "one `}` is too many"),
        (
            "a = [(0, 300), (200, 300)]",
            "a = [[0, 300], [200, 300]]",
            "a list is in [ ], not in ( )",
        ),
        (
            "a = 1.000,5 # c",
            "a = 1000.5 # c",
            "a number has a decimal point",
        ),
        (
            "a = { b = 60,5, c = 1 }",
            "a = { b = 60.5, c = 1 }",
            "a number has a decimal point",
        ),
        (
            "a = { b = 1, c = 60,5 }",
            "a = { b = 1, c = 60.5 }",
            "a number has a decimal point",
        ),
        ("load_kg = 18 kg", "load_kg = 18", "a number has no unit"),
        (
            "a = { b_hz = 25Hz, c_hz = 29 Hz }",
            "a = { b_hz = 25, c_hz = 29 }",
            "a number has no unit",
        ),
        ("a = 8 %", "a = 8", "a number has no unit"),
        (
            "a = 1'000",
            "a = 1000",
            "the digits of a number stay together",
        ),
        (
            "a = 1 000.5",
            "a = 1000.5",
            "the digits of a number stay together",
        ),
        ("a = 8×10^3", "a = 8e3", "a power of ten is written with e"),
        (
            "a = -.5",
            "a = -0.5",
            "a number has digits before and after its point, and no zero before its digits",
        ),
        (
            "a = 05",
            "a = 5",
            "a number has digits before and after its point, and no zero before its digits",
        ),
        ("a == 8", "a = 8", "one `=` is between key and value"),
        ("a := 8", "a = 8", "one `=` is between key and value"),
        ("a => 8", "a = 8", "one `=` is between key and value"),
        ("a: 8", "a = 8", "`=` is between key and value"),
        ("a 8", "a = 8", "`=` is between key and value"),
        (
            "a = { \"b\": 1, \"c\": 2 }",
            "a = { \"b\" = 1, \"c\" = 2 }",
            "`=` is between key and value",
        ),
        (
            "a = { b = 1, c 2 }",
            "a = { b = 1, c = 2 }",
            "`=` is between key and value",
        ),
        ("a b = 8", "a_b = 8", "a key has no spaces"),
        (
            "a = { b = 1 c = 2 }",
            "a = { b = 1, c = 2 }",
            "a comma is between two entries",
        ),
        (
            "a = { b = 1; c = 2 }",
            "a = { b = 1, c = 2 }",
            "a comma is between two entries",
        ),
        (
            "a = { b = 1, , c = 2 }",
            "a = { b = 1,  c = 2 }",
            "one comma is between two entries",
        ),
        (
            "a = [{ b = 1 ]",
            "a = [{ b = 1 }]",
            "brackets come in pairs: { } around an entry, [ ] around a list",
        ),
        (
            "a = [{ b = 1 }}]",
            "a = [{ b = 1 }]",
            "brackets come in pairs: { } around an entry, [ ] around a list",
        ),
        (
            "a = [{{ b = 1 }]",
            "a = [{ b = 1 }]",
            "brackets come in pairs: { } around an entry, [ ] around a list",
        ),
        (
            "a = [{ b = 1 ]]",
            "a = [{ b = 1 }]",
            "brackets come in pairs: { } around an entry, [ ] around a list",
        ),
        (
            "a = ( b = 1 )",
            "a = { b = 1 }",
            "an entry is in { }, not in ( )",
        ),
        ("a = { 1, 2 }", "a = [1, 2]", "a list is in [ ]"),
        (
            "band = [b = 1, c = 2]",
            "band = [{ b = 1, c = 2 }]",
            "an entry of a list is in { }",
        ),
        (
            "servo = [b = 1, c = 2]",
            "servo = { b = 1, c = 2 }",
            "an entry of a list is in { }",
        ),
        ("a = -550, 550", "a = [-550, 550]", "a list is in [ ]"),
        (
            "a = [[0, 5] [1, 4]]",
            "a = [[0, 5], [1, 4]]",
            "a comma is between two entries",
        ),
        ("a = 8;", "a = 8", "nothing ends a line but its end"),
        ("a = 8, # c", "a = 8 # c", "nothing ends a line but its end"),
        (
            "a = above",
            "a = \"above\"",
            "text is in quotes; true, false and numbers are not",
        ),
        (
            "a = \"above",
            "a = \"above\"",
            "text is in quotes; true, false and numbers are not",
        ),
        (
            "a = True",
            "a = true",
            "text is in quotes; true, false and numbers are not",
        ),
        ("a = 8 // c", "a = 8  # c", "a comment begins with #"),
    ] {
        let Repaired {
            line: repaired,
            rules,
            ..
        } = repaired(line);
        assert_eq!(
            (repaired.as_deref(), rules.join("; ").as_str()),
            (Some(right), rule),
            "{line}"
        );
    }
}

#[test]
fn several_mistakes_of_a_line_are_repaired_together() {
    let Repaired { line, rules, .. } = repaired("a = { b_mm = −60,5 mm, c = “x” }");
    assert_eq!(line.unwrap(), "a = { b_mm = -60.5, c = \"x\" }");
    assert_eq!(rules.len(), 3, "{rules:?}");
}

#[test]
fn an_entry_that_is_not_closed_is_closed_on_its_line() {
    let Repaired { begin, line, .. } = repaired("a = [\n  { b = 1, c = 2,\n]");
    assert_eq!((begin, line.unwrap().as_str()), (10, "{ b = 1, c = 2 },"));
}

#[test]
fn a_number_in_another_unit_is_not_converted() {
    let Repaired { rules, line, .. } = repaired("b_hz = 2 kHz");
    assert_eq!(line, None);
    assert_eq!(
        rules,
        ["a number has no unit, and `b_hz` is in rev/s; convert 2 kHz"]
    );
}

#[test]
fn what_cannot_be_meant_is_not_repaired() {
    for line in ["a =", "= 8", "a = 25.1.1", "a = 1/2", "a = ~8", "?"] {
        let text = format!("[t]\n{line}\nafter = 1\n");
        let at = DeTable::parse(&text).unwrap_err().span().unwrap().start;
        assert_eq!(repair(&text, at), None, "{line}");
    }
}

#[test]
fn quoted_text_and_comments_stay_as_they_are() {
    let Repaired { line, .. } = repaired("a = 60,5 # „60,5” – kg");
    assert_eq!(line.unwrap(), "a = 60.5 # „60,5” – kg");
    let Repaired { line, .. } = repaired("a = { b = \"5 – 6, x = 7;\", c = −1 }");
    assert_eq!(line.unwrap(), "a = { b = \"5 – 6, x = 7;\", c = -1 }");
}

/// The repair of a text with several lines.
#[track_caller]
fn repaired_text(text: &str) -> Repaired {
    let error = DeTable::parse(text).expect_err("the text is TOML");
    let at = error.span().map_or(0, |span| span.start);
    repair(text, at).unwrap_or_else(|| panic!("`{text}` is not repaired"))
}

/// The reader finds the mistake only at the heading after it.
#[test]
fn a_list_or_table_that_is_not_closed_is_named_where_it_begins() {
    for (line, right) in [
        (
            "a = [[0, 12.0], [5, 11.0, [10, 9.0]]",
            "a = [[0, 12.0], [5, 11.0], [10, 9.0]]",
        ),
        ("a = [[0, 12.0], [10, 9.0]", "a = [[0, 12.0], [10, 9.0]]"),
        ("a = [0, 12.0 # Nm", "a = [0, 12.0] # Nm"),
        ("a = { b = 1, c = 2", "a = { b = 1, c = 2 }"),
    ] {
        for next in ["[[axis]]\nb = 1\n", "", "\n# note\n\n[u]\n"] {
            let found = repaired_text(&format!("[t]\n{line}\n{next}"));
            assert_eq!(
                (found.begin, found.line.as_deref()),
                (4, Some(right)),
                "{line}, {next}"
            );
        }
    }
    let found = repaired_text("a = [\n  { b = 1 },\n  { b = 2 },\n[[axis]]\nb = 1\n");
    assert_eq!((found.begin, found.line), (0, None));
    assert!(
        found.rules[0].contains("before `[[axis]]` in line 4; write `]` after"),
        "{:?}",
        found.rules
    );
    let found = repaired_text("x = 1\na = { b = 1, # note, c = 2 }\n\n[[axis]]\nb = 1\n");
    assert_eq!((found.begin, found.line), (6, None));
    assert!(
        found.rules[0].contains("its `}` is behind a `#`"),
        "{:?}",
        found.rules
    );
}

#[test]
fn a_comma_between_entries_of_two_lines_is_added_to_the_first() {
    let found = repaired_text("a = [\n  { b = 1 } # c\n  { b = 2 },\n]\n");
    assert_eq!(
        (found.begin, found.line.as_deref()),
        (6, Some("{ b = 1 }, # c"))
    );
    let found = repaired_text("a = [\n  [1, 2]\n  [3, 4],\n]\n");
    assert_eq!((found.begin, found.line.as_deref()), (6, Some("[1, 2],")));
}

/// A line that has two meanings is not changed to one of them.
#[test]
fn what_only_the_author_knows_is_left_to_the_author() {
    for (line, rule) in [
        (
            "a = 40,000",
            "a number has no comma: write `40000`, or `40.000` if the comma is a decimal one",
        ),
        ("a = 1,234.5", "a number has no comma: write `1234.5`"),
        (
            "a = [402, 175, 2,030]",
            "a number has no comma: write `[402, 175, 2030]`, or `[402, 175, 2.030]` if the comma is a decimal one",
        ),
        (
            "a = [[402, 2,030]]",
            "`2,030` is two numbers, and none has a zero before its digits: write `2030` if it is one",
        ),
    ] {
        let found = repaired(line);
        assert_eq!(
            (found.line, found.rules),
            (None, vec![rule.to_owned()]),
            "{line}"
        );
    }
    for entry in ["{ 1, 2 },", "{ 135 },"] {
        let found = repaired_text(&format!("a = [\n  {{ b = 1 }},\n  {entry}\n]\n"));
        assert_eq!(found.line, None);
        assert!(found.rules[0].contains("have keys"), "{:?}", found.rules);
    }
    let found = repaired_text("a = [\n  { b = 1, # c = 2 },\n  { b = 2 },\n]\n");
    assert_eq!((found.begin, found.line), (6, None));
    assert!(found.rules[0].contains("behind a `#`"), "{:?}", found.rules);
}
