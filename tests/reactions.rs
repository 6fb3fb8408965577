//! The table of reactions in docs/faults.md is the one that the loop goes by.

use cophase_core::supervisor::Reaction;
use cophase_core::supervisor::reaction::REACTIONS;

const DOCS: &str = include_str!("../docs/faults.md");

const fn word(reaction: Reaction) -> &'static str {
    match reaction {
        Reaction::Report => "report",
        Reaction::Correct => "correct",
        Reaction::Stop => "stop",
        Reaction::Disable => "disable",
    }
}

/// Were it another, who reads it would wire, and trust, a machine that reacts otherwise.
#[test]
fn the_table_that_is_read_is_the_one_that_is_run() {
    let mut table =
        "| kind | number | within limits | else |\n| --- | --- | --- | --- |\n".to_owned();
    for row in REACTIONS {
        let (name, number) = (row.kind.name(), row.kind as u8);
        let (safe, else_) = (word(row.safe), word(row.unsafe_));
        table += &format!("| `{name}` | {number} | {safe} | {else_} |\n");
    }
    let begin = "<!-- reactions -->\n";
    let from = DOCS.find(begin).expect("the table's beginning") + begin.len();
    let to = DOCS.find("<!-- /reactions -->").expect("the table's end");
    assert!(
        DOCS[from..to] == table,
        "docs/faults.md should have\n\n{table}"
    );
}
