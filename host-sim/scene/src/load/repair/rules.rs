//! One repair for each kind of mistake.

use super::brackets::{brackets, comma_after_entry, entries, extra_bracket, parentheses};
use super::numbers::{decimal_commas, points, powers, thousands, units};
use super::pasted::pasted;
use super::tokens::{Token, is_number, joined, tokens, values};
use crate::load::place::bare;

type Repair = fn(&str) -> Option<(String, String)>;

/// All repairs, in the order in which they are tried. Each gives the broken rule and the repaired line.
pub(super) const REPAIRS: [Repair; 21] = [
    comment,
    pasted,
    list_without_brackets,
    decimal_commas,
    powers,
    thousands,
    units,
    ranges,
    points,
    equals,
    colons,
    missing_commas,
    missing_equals,
    extra_commas,
    parentheses,
    extra_bracket,
    brackets,
    entries,
    comma_after_entry,
    line_ends,
    quotes,
];

/// A comment of another language.
fn comment(line: &str) -> Option<(String, String)> {
    let rule = || "a comment begins with #".to_owned();
    let text = line.trim_start();
    if text.starts_with([';', '%']) || text.starts_with("--") {
        return Some((
            rule(),
            format!("# {}", text.trim_start_matches([';', '%', '-', ' '])),
        ));
    }
    let tokens = tokens(line);
    let at = tokens
        .iter()
        .position(|token| token.words().contains("//"))?;
    let rest = joined(&tokens[at..]);
    let (words, note) = rest.split_once("//")?;
    let before = joined(&tokens[..at]);
    Some((
        rule(),
        format!("{before}{}  # {}", words.trim_end(), note.trim_start()),
    ))
}

/// `:=`, `==` and `=>`.
fn equals(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let at = tokens.iter().position(|token| token.is('='))?;
    if tokens[at - usize::from(at > 0)].words().ends_with(':') {
        let key = tokens[at - 1].words().trim_end_matches([':', ' ']);
        tokens[at - 1] = Token::Words(format!("{key} "));
    } else if tokens.get(at + 1)?.is('=') {
        tokens.remove(at);
    } else {
        let value = tokens[at + 1].words().strip_prefix('>')?.trim_start();
        tokens[at + 1] = Token::Words(format!(" {value}"));
    }
    Some((
        "one `=` is between key and value".to_owned(),
        joined(&tokens),
    ))
}

/// A range of another language in a list: `[22..50]`.
fn ranges(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, _| {
        let (from, to) = value.split_once("..")?;
        let (from, to) = (from.trim(), to.trim_start_matches(['=', '.', ' ']));
        (is_number(from) && is_number(to)).then(|| format!("{from}, {to}"))
    })?;
    Some(("two numbers have a comma between them".to_owned(), line))
}

fn colons(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let mut is_changed = false;
    for at in 0..tokens.len() {
        let after_key = at > 0 && matches!(tokens[at - 1], Token::Quoted(_));
        let Token::Words(words) = &mut tokens[at] else {
            continue;
        };
        let Some((key, value)) = words.split_once(':') else {
            continue;
        };
        if bare(key.trim()) || (after_key && key.trim().is_empty()) {
            *words = format!("{} = {}", key.trim_end(), value.trim_start());
            is_changed = true;
        }
    }
    is_changed.then(|| ("`=` is between key and value".to_owned(), joined(&tokens)))
}

/// Numbers with a comma and a space between them, and no brackets around them: `-550, 550`.
fn list_without_brackets(line: &str) -> Option<(String, String)> {
    let (key, value) = line.split_once('=')?;
    let (value, comment) = value
        .split_once('#')
        .map_or((value, String::new()), |(value, comment)| {
            (value, format!("  #{comment}"))
        });
    let numbers = value.trim().split(", ");
    let are_numbers = numbers.clone().count() > 1 && numbers.map(str::trim).all(is_number);
    are_numbers.then(|| {
        (
            "a list is in [ ]".to_owned(),
            format!("{key}= [{}]{comment}", value.trim()),
        )
    })
}

fn missing_commas(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let mut is_changed = false;
    for at in (2..tokens.len()).rev() {
        let is_between =
            tokens[at - 1].words().is_empty() && matches!(tokens[at - 1], Token::Words(_));
        let are_entries = [(']', '['), ('}', '{')]
            .into_iter()
            .any(|(end, begin)| tokens[at - 2].is(end) && tokens[at].is(begin));
        if is_between && are_entries {
            tokens.insert(at - 1, Token::Mark(','));
            is_changed = true;
        }
    }
    for at in 1..tokens.len() {
        let before_equals = tokens.get(at + 1).is_some_and(|next| next.is('='));
        let is_after_value = matches!(tokens[at - 1], Token::Quoted(_));
        let words = tokens[at].words();
        let is_in_list = matches!(tokens[at - 1], Token::Mark('[' | ',')) && !before_equals;
        let new = if is_in_list && are_numbers(words) {
            words.split_whitespace().collect::<Vec<_>>().join(", ")
        } else if is_after_value && before_equals {
            format!(", {}", words.trim_start_matches([';', ' ']))
        } else if let Some((value, key)) = words.split_once(';') {
            format!("{}, {}", value.trim_end(), key.trim_start())
        } else if let (true, Some((value, key))) = (before_equals, words.split_once(' ')) {
            format!("{value}, {}", key.trim_start())
        } else {
            continue;
        };
        tokens[at].put(&new);
        is_changed = true;
    }
    is_changed.then(|| ("a comma is between two entries".to_owned(), joined(&tokens)))
}

/// Returns true for several numbers with spaces between them. Groups of digits with a zero in front may be parts of one number.
fn are_numbers(words: &str) -> bool {
    let is_other = |group: &str| is_number(group) && !(group.len() > 1 && group.starts_with('0'));
    words.contains(' ') && words.split_whitespace().all(is_other)
}

/// A key without `=`, or with a space in it.
fn missing_equals(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    for at in 0..tokens.len() {
        let Some((key, rest)) = tokens[at].words().split_once(char::is_whitespace) else {
            continue;
        };
        let is_value = at > 0 && tokens[at - 1].is('=');
        if is_value || !bare(key) {
            continue;
        }
        if tokens.get(at + 1).is_some_and(|next| next.is('=')) {
            let key = tokens[at]
                .words()
                .split_whitespace()
                .collect::<Vec<_>>()
                .join("_");
            tokens[at].put(&key);
            return Some(("a key has no spaces".to_owned(), joined(&tokens)));
        }
        let new = format!("{key} = {}", rest.trim_start());
        tokens[at].put(&new);
        return Some(("`=` is between key and value".to_owned(), joined(&tokens)));
    }
    None
}

fn extra_commas(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let is_blank = |token: &Token| matches!(token, Token::Words(words) if words.trim().is_empty());
    for at in (1..tokens.len()).rev() {
        let before = tokens[..at].iter().rev().find(|token| !is_blank(token));
        if tokens[at].is(',') && matches!(before, Some(Token::Mark(',' | '{' | '['))) {
            tokens.remove(at);
            return Some((
                "one comma is between two entries".to_owned(),
                joined(&tokens),
            ));
        }
    }
    None
}

fn line_ends(line: &str) -> Option<(String, String)> {
    let tokens = tokens(line);
    let comment = tokens
        .iter()
        .position(|token| matches!(token, Token::Comment(_)));
    let (code, comment) = tokens.split_at(comment.unwrap_or(tokens.len()));
    let code = joined(code);
    let end = code.trim_end();
    // The comma after an entry of a list is right.
    if end.trim_start().starts_with(['{', '[']) {
        return None;
    }
    let kept = end.trim_end_matches([';', ',']).trim_end();
    let rest = &code[end.len()..];
    (kept.len() < end.len()).then(|| {
        let rule = "nothing ends a line but its end".to_owned();
        (rule, format!("{kept}{rest}{}", joined(comment)))
    })
}

/// The rule that a bare word breaks, unless a number was meant.
pub(in super::super) const QUOTES: &str = "text is in quotes; true, false and numbers are not";

fn quotes(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, _| {
        let small = value.to_lowercase();
        if small == "true" || small == "false" {
            return Some(small);
        }
        let inner = value.trim_matches(['"', '\'']);
        let is_text =
            inner.starts_with(|first: char| first.is_alphabetic() || first == '.' || first == '/');
        is_text.then(|| format!("\"{inner}\""))
    })?;
    Some((QUOTES.to_owned(), line))
}
