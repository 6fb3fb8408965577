//! The tables of faults in the manual are those that the loop uses.

use cophase_core::supervisor::{KINDS, Reaction};

const DOCS: &str = include_str!("../../docs/faults.md");

const fn word(reaction: Reaction) -> &'static str {
    match reaction {
        Reaction::Report => "report",
        Reaction::Correct => "correct",
        Reaction::StopAndHold => "stop, hold",
        Reaction::StopAndCut => "stop, cut",
        Reaction::Disable => "disable",
    }
}

/// If this fails, a reader of the table wires, and trusts, a machine that reacts differently.
#[test]
fn documented_reactions_match_the_code() {
    let begin = "<!-- reactions -->\n";
    let from = DOCS.find(begin).expect("the table's beginning") + begin.len();
    let to = DOCS.find("<!-- /reactions -->").expect("the table's end");
    let mut lines = DOCS[from..to].lines();
    let head = "| kind | number | within limits | else | why |";
    assert_eq!(lines.next(), Some(head));
    assert_eq!(lines.next(), Some("| --- | --- | --- | --- | --- |"));
    for row in KINDS {
        let (name, number) = (row.kind.name(), row.kind as u8);
        let (safe, else_) = (word(row.safe), word(row.unsafe_));
        let expected = format!("| `{name}` | {number} | {safe} | {else_} | ");
        let line = lines.next().unwrap_or_default();
        let why = line.strip_prefix(&expected);
        assert!(
            why.is_some_and(|why| why.ends_with(" |") && why.len() > 5),
            "docs/faults.md should have {expected}, and a reason, not {line}"
        );
    }
    assert_eq!(lines.next(), None);
}

/// If this fails, a user looks for a fault in vain.
#[test]
fn faults_have_their_rows_in_troubleshooting() {
    let manual = include_str!("../../docs/troubleshooting.md");
    for row in KINDS {
        let begin = format!("\n| `{}` |", row.name);
        assert!(manual.contains(&begin), "no row for {}", row.name);
    }
}
