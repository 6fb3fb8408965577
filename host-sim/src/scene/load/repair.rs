//! Repairs of a line that is not TOML, so that a message can state what to write.
//!
//! Each repair is for one kind of mistake, such as a decimal comma or a pasted minus sign. It is kept if the reader of TOML gets
//! further with it. So a message only proposes what is TOML.

use std::cell::Cell;

use cophase_core::settings::Problem;
use toml::de::DeTable;

use super::place::bare;

/// Longest line that is repaired, bytes.
const MOST_BYTES: usize = 4096;

/// Mistakes that one line has at most.
const MOST_MISTAKES: usize = 5;

/// A line with its mistakes repaired, and the rules that it broke.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Repaired {
    /// Byte at which the line begins.
    pub(super) begin: usize,
    pub(super) rules: Vec<String>,
    /// None if only the author knows what to write.
    pub(super) line: Option<String>,
}

type Repair = fn(&str) -> Option<(String, String)>;

/// In the order in which they are tried. Each gives the broken rule and the repaired line.
const REPAIRS: [Repair; 16] = [
    comment,
    pasted,
    decimal_commas,
    powers,
    thousands,
    units,
    points,
    equals,
    colons,
    missing_commas,
    missing_equals,
    extra_commas,
    brackets,
    entries,
    line_ends,
    quotes,
];

/// Repairs the line around the first error of a text that is not TOML, or the line before, if that is incomplete.
pub(super) fn repair(text: &str, error_at: usize) -> Option<Repaired> {
    let begin = text[..error_at].rfind('\n').map_or(0, |at| at + 1);
    let end = text[begin..].find('\n').map_or(text.len(), |at| begin + at);
    let before = text[..begin].trim_end().rfind('\n').map_or(0, |at| at + 1);
    repair_line(text, begin, end)
        .or_else(|| repair_line(text, before, end).filter(|_| before < begin))
}

/// Repairs the line at `begin` so that no error remains before `end`.
fn repair_line(text: &str, begin: usize, end: usize) -> Option<Repaired> {
    let length = text[begin..].find('\n').unwrap_or(text.len() - begin);
    let (line, after) = text[begin..].split_at(length);
    if line.len() > MOST_BYTES {
        return None;
    }
    let with = |line: &str| format!("{}{line}{after}", &text[..begin]);
    let rest = text.len() - end;
    let mut line = line.to_owned();
    let mut rules = Vec::new();
    for _ in 0..MOST_MISTAKES {
        let now = with(&line);
        // An error at the end of the line is one of the line.
        let error = error_at(&now).filter(|at| at + rest <= now.len());
        let Some(error) = error else {
            let line = Some(line.trim().to_owned());
            return (!rules.is_empty()).then_some(Repaired { begin, rules, line });
        };
        let found = REPAIRS.iter().find_map(|repair| {
            let (rule, repaired) = repair(&line)?;
            let next = with(&repaired);
            let same = now.bytes().zip(next.bytes());
            let changed_at = same.take_while(|(one, other)| one == other).count();
            // The reader has read what was changed, and less is left.
            let gets_further = error_at(&next)
                .is_none_or(|at| at >= changed_at && next.len() - at < now.len() - error);
            gets_further.then_some((rule, repaired))
        });
        let Some((rule, repaired)) = found else {
            rules.push(other_unit(&line)?);
            return Some(Repaired {
                begin,
                rules,
                line: None,
            });
        };
        rules.push(rule);
        line = repaired;
    }
    None
}

/// Repairs a value, such as a number that was written as text.
pub(super) fn repair_value(value: &str) -> Option<String> {
    let line = repair(&format!("x = {value}"), 0)?.line?;
    line.strip_prefix("x = ").map(str::to_owned)
}

/// Place of the first error of a text.
fn error_at(text: &str) -> Option<usize> {
    let error = DeTable::parse(text).err()?;
    Some(error.span().map_or(0, |span| span.start).min(text.len()))
}

/// Piece of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Token {
    /// One of `=,{}[]`.
    Mark(char),
    /// Text in quotes.
    Quoted(String),
    Comment(String),
    /// What is between them, with its spaces.
    Words(String),
}

impl Token {
    fn is(&self, mark: char) -> bool {
        *self == Self::Mark(mark)
    }

    /// The words without the spaces around them; empty for other tokens.
    fn words(&self) -> &str {
        match self {
            Self::Words(words) => words.trim(),
            _ => "",
        }
    }

    /// Replaces the words, and keeps the spaces around them.
    fn put(&mut self, new: &str) {
        if let Self::Words(words) = self {
            let trimmed = words.trim();
            *words = if trimmed.is_empty() {
                new.to_owned()
            } else {
                words.replacen(trimmed, new, 1)
            };
        }
    }
}

fn tokens(line: &str) -> Vec<Token> {
    let mut tokens: Vec<Token> = Vec::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let (length, token) = match first {
            '=' | ',' | '{' | '}' | '[' | ']' => (1, Token::Mark(first)),
            '#' => (rest.len(), Token::Comment(rest.to_owned())),
            '"' | '\'' if rest[1..].contains(first) => {
                let length = rest[1..].find(first).map_or(rest.len(), |at| at + 2);
                (length, Token::Quoted(rest[..length].to_owned()))
            }
            _ => (first.len_utf8(), Token::Words(first.to_string())),
        };
        match (tokens.last_mut(), token) {
            (Some(Token::Words(words)), Token::Words(more)) => words.push_str(&more),
            (_, token) => tokens.push(token),
        }
        rest = &rest[length..];
    }
    tokens
}

fn joined(tokens: &[Token]) -> String {
    let text = |token: &Token| match token {
        Token::Mark(mark) => mark.to_string(),
        Token::Quoted(text) | Token::Comment(text) | Token::Words(text) => text.clone(),
    };
    tokens.iter().map(text).collect()
}

/// Changes the words of each place for a value: after `=`, or in a list. `change` has the words, and the key before them.
fn values(line: &str, change: impl Fn(&str, &str) -> Option<String>) -> Option<String> {
    let mut tokens = tokens(line);
    let mut is_changed = false;
    for at in 1..tokens.len() {
        let is_value = matches!(tokens[at - 1], Token::Mark('=' | '[' | ','));
        let is_key = tokens.get(at + 1).is_some_and(|next| next.is('='));
        if !is_value || is_key || tokens[at].words().is_empty() {
            continue;
        }
        let key = if tokens[at - 1].is('=') && at > 1 {
            tokens[at - 2].words()
        } else {
            ""
        };
        if let Some(new) = change(tokens[at].words(), key) {
            tokens[at].put(&new);
            is_changed = true;
        }
    }
    is_changed.then(|| joined(&tokens))
}

fn is_number(text: &str) -> bool {
    let digits = text.trim_start_matches(['+', '-']);
    digits.starts_with(|first: char| first.is_ascii_digit()) && text.parse::<f64>().is_ok()
}

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

/// Characters that text processors and web pages have in the place of those of TOML.
const PASTED: [(&str, &str, &str); 12] = [
    ("\u{2212}", "a minus sign", "-"),
    ("\u{2010}\u{2011}\u{2012}\u{2043}\u{fe63}", "a hyphen", "-"),
    ("\u{2013}", "an en dash", "-"),
    ("\u{2014}\u{2015}", "an em dash", "-"),
    ("\u{a0}\u{202f}", "a no-break space", " "),
    (
        "\u{2002}\u{2003}\u{2005}\u{2007}\u{2008}\u{2009}\u{200a}\u{3000}",
        "a wide or thin space",
        " ",
    ),
    (
        "\u{200b}\u{200c}\u{200d}\u{2060}\u{feff}\u{ad}",
        "an invisible character",
        "",
    ),
    (
        "\u{201c}\u{201d}\u{201e}\u{201f}\u{ab}\u{bb}\u{2033}",
        "a curly quotation mark",
        "\"",
    ),
    (
        "\u{2018}\u{2019}\u{201a}\u{201b}\u{b4}`\u{2032}",
        "a curly quotation mark",
        "'",
    ),
    ("\u{66b}", "a decimal separator", "."),
    ("\u{60c}\u{3001}", "a comma", ","),
    ("\u{2044}\u{2215}", "a slash", "/"),
];

/// Distance of a full-width character from its usual form.
const FULL_WIDTH: u32 = 0xfee0;

/// A pasted character: its name, and what TOML has in its place.
fn pasted_character(c: char) -> Option<(&'static str, String)> {
    if let '\u{ff01}'..='\u{ff5e}' = c {
        let usual = char::from_u32(c as u32 - FULL_WIDTH)?;
        return Some(("a full-width character", usual.to_string()));
    }
    let (_, name, usual) = PASTED.iter().find(|(all, ..)| all.contains(c))?;
    Some((name, (*usual).to_owned()))
}

fn pasted(line: &str) -> Option<(String, String)> {
    let mut found: Option<(char, &str, String)> = None;
    let mut tokens = tokens(line);
    for token in &mut tokens {
        let Token::Words(words) = token else { continue };
        let mut usual_words = String::new();
        for c in words.chars() {
            match pasted_character(c) {
                None => usual_words.push(c),
                Some((name, usual)) => {
                    usual_words.push_str(&usual);
                    found.get_or_insert((c, name, usual));
                }
            }
        }
        *words = usual_words;
    }
    let (c, name, usual) = found?;
    let code = c as u32;
    let shown = if c.is_whitespace() || usual.is_empty() {
        format!("U+{code:04X} is {name}")
    } else {
        format!("`{c}` (U+{code:04X}) is {name}")
    };
    let rule = match usual.as_str() {
        "" => format!("{shown}; delete it"),
        " " => format!("{shown}; a plain space belongs there"),
        usual => format!("{shown}; `{usual}` belongs there"),
    };
    Some((rule, joined(&tokens)))
}

fn decimal_commas(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let mut is_changed = false;
    let mut at = 1;
    while at + 2 < tokens.len() {
        let (whole, fraction) = (tokens[at].words(), tokens[at + 2].words());
        let is_whole = tokens[at - 1].is('=') && is_number(&whole.replace('.', ""));
        let is_fraction = fraction.starts_with(|first: char| first.is_ascii_digit())
            && !tokens.get(at + 3).is_some_and(|next| next.is('='));
        if is_whole && tokens[at + 1].is(',') && is_fraction {
            let number = format!("{}.{fraction}", whole.replace('.', ""));
            tokens[at].put(&number);
            if let Token::Words(words) = &mut tokens[at] {
                words.truncate(words.trim_end().len());
            }
            if let Token::Words(after) = &tokens[at + 2] {
                let spaces = after[after.trim_end().len()..].to_owned();
                tokens[at + 2] = Token::Words(spaces);
            }
            tokens.remove(at + 1);
            is_changed = true;
        }
        at += 1;
    }
    is_changed.then(|| ("a number has a decimal point".to_owned(), joined(&tokens)))
}

fn powers(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, _| {
        let forms = [
            "×10^", "*10^", "x10^", " × 10^", " * 10^", " x 10^", "*10**",
        ];
        let form = forms.iter().find(|form| value.contains(**form))?;
        let number = value.replacen(form, "e", 1);
        is_number(&number).then_some(number)
    })?;
    Some(("a power of ten is written with e".to_owned(), line))
}

fn thousands(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, _| {
        let mut groups = value.split([' ', '\'']);
        let first = groups.next()?;
        let is_grouped = groups.all(|group| {
            let digits = group.split('.').next().unwrap_or_default();
            digits.len() == 3 && is_number(group)
        });
        let number = value.replace([' ', '\''], "");
        (number != value && is_number(first) && is_grouped).then_some(number)
    })?;
    Some(("the digits of a number stay together".to_owned(), line))
}

fn units(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, key| {
        let (number, unit) = number_and_unit(value)?;
        is_unit_of(key, unit).then(|| number.to_owned())
    })?;
    Some(("a number has no unit".to_owned(), line))
}

/// The rule for a number in another unit than its key's.
fn other_unit(line: &str) -> Option<String> {
    let rule = Cell::new(None);
    values(line, |value, key| {
        let (number, unit) = number_and_unit(value)?;
        if !is_unit_of(key, unit) {
            let right = Problem::unit(key);
            rule.set(Some(format!(
                "a number has no unit, and `{key}` is in {right}; convert {number} {unit}"
            )));
        }
        None
    });
    rule.into_inner()
}

/// True for the unit that is in the name of a key, or in messages about it. A key without a unit takes any.
fn is_unit_of(key: &str, unit: &str) -> bool {
    let right = Problem::unit(key);
    right.is_empty() || right == unit || key.ends_with(&format!("_{}", unit.to_lowercase()))
}

fn number_and_unit(value: &str) -> Option<(&str, &str)> {
    let is_end = |at: &usize| value.is_char_boundary(*at) && is_number(&value[..*at]);
    let end = (1..value.len()).rev().find(is_end)?;
    let (number, unit) = (&value[..end], value[end..].trim());
    // m/s^2 has a digit as well, but the digits of other numbers come first.
    let letters = unit.trim_end_matches(['2', '3', '^']);
    let is_unit = letters.starts_with(|first: char| first.is_alphabetic() || "°%".contains(first))
        && !letters.contains(|c: char| c.is_ascii_digit() || c == ':');
    is_unit.then_some((number, unit))
}

fn points(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, _| {
        let (sign, digits) = match value.strip_prefix(['-', '+']) {
            Some(digits) => (&value[..1], digits),
            None => ("", value),
        };
        let digits = match digits.split_once('.') {
            Some(("", fraction)) => format!("0.{fraction}"),
            Some((whole, "")) => format!("{whole}.0"),
            _ => digits.to_owned(),
        };
        let (zeros, rest) = digits.split_at(digits.len() - digits.trim_start_matches('0').len());
        let is_needed = !rest.starts_with(|first: char| first.is_ascii_digit());
        let zero = if is_needed && !zeros.is_empty() {
            "0"
        } else {
            ""
        };
        let number = format!("{sign}{zero}{rest}");
        (number != value && is_number(&number)).then_some(number)
    })?;
    Some((
        "a number has digits before and after its point, and no zero before its digits".to_owned(),
        line,
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

fn missing_commas(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let mut is_changed = false;
    for at in 1..tokens.len() {
        let before_equals = tokens.get(at + 1).is_some_and(|next| next.is('='));
        let is_after_value = matches!(tokens[at - 1], Token::Quoted(_));
        let words = tokens[at].words();
        let new = if is_after_value && before_equals {
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

/// Brackets that do not match. What a list opens may end on another line.
fn brackets(line: &str) -> Option<(String, String)> {
    let line = line.replace('(', "{").replace(')', "}");
    let mut fixed: Vec<Token> = Vec::new();
    let mut open = Vec::new();
    let tokens = tokens(&line);
    let closed_later = |at: usize, mark: char| tokens[at + 1..].iter().any(|token| token.is(mark));
    for (at, token) in tokens.iter().enumerate() {
        match token {
            Token::Mark(mark @ ('{' | '[')) => {
                if open.last() == Some(&'{')
                    && *mark == '{'
                    && fixed.last().is_some_and(|last| last.is('{'))
                {
                    continue;
                }
                open.push(*mark);
            }
            Token::Mark(mark @ ('}' | ']')) => {
                let needed = if open.last() == Some(&'{') { '}' } else { ']' };
                if open.is_empty() {
                    // It closes a list of lines above, or nothing.
                    if *mark == '}' {
                        continue;
                    }
                } else if needed != *mark {
                    let is_skipped = open.len() > 1 && *mark == ']' && !closed_later(at, ']');
                    match (needed, is_skipped) {
                        ('}', true) => {
                            fixed.push(Token::Mark('}'));
                            open.truncate(open.len() - 2);
                            fixed.push(token.clone());
                        }
                        ('}', false) => {
                            open.pop();
                            fixed.push(Token::Mark('}'));
                        }
                        _ => {}
                    }
                    continue;
                } else {
                    open.pop();
                }
            }
            _ => {}
        }
        fixed.push(token.clone());
    }
    let mut fixed = joined(&fixed);
    if open.last() == Some(&'{') {
        let entries = fixed.trim_end();
        let comma = if entries.ends_with(',') { "," } else { "" };
        fixed = format!("{} }}{comma}", entries.trim_end_matches([',', ' ']));
    }
    Some((
        "brackets come in pairs: { } around an entry, [ ] around a list".to_owned(),
        fixed,
    ))
}

/// A list in braces, and an entry without braces.
fn entries(line: &str) -> Option<(String, String)> {
    let has_keys = line.contains('=');
    if let (Some(begin), Some(end)) = (line.find('{'), line.rfind('}'))
        && begin < end
        && !line[begin..end].contains('=')
    {
        let list = format!(
            "{}[{}]{}",
            &line[..begin],
            line[begin + 1..end].trim(),
            &line[end + 1..]
        );
        return Some(("a list is in [ ]".to_owned(), list));
    }
    let rule = "an entry of a list is in { }".to_owned();
    if let (Some(begin), Some(end)) = (line.find('['), line.rfind(']'))
        && begin < end
        && line[begin..end].contains('=')
    {
        let inner = line[begin + 1..end].trim();
        return Some((
            rule,
            format!("{}[{{ {inner} }}]{}", &line[..begin], &line[end + 1..]),
        ));
    }
    let inner = line.trim().trim_end_matches(',');
    has_keys.then(|| (rule, format!("{{ {inner} }},")))
}

fn line_ends(line: &str) -> Option<(String, String)> {
    let tokens = tokens(line);
    let comment = tokens
        .iter()
        .position(|token| matches!(token, Token::Comment(_)));
    let (code, comment) = tokens.split_at(comment.unwrap_or(tokens.len()));
    let code = joined(code);
    let end = code.trim_end();
    let kept = end.trim_end_matches([';', ',']).trim_end();
    let rest = &code[end.len()..];
    (kept.len() < end.len()).then(|| {
        let rule = "nothing ends a line but its end".to_owned();
        (rule, format!("{kept}{rest}{}", joined(comment)))
    })
}

/// The rule that a bare word breaks, unless a number was meant.
pub(super) const QUOTES: &str = "text is in quotes; true, false and numbers are not";

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
    Some((
        "text is in quotes; true, false and numbers are not".to_owned(),
        line,
    ))
}

#[cfg(test)]
mod tests {
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
                "brackets come in pairs: { } around an entry, [ ] around a list",
            ),
            ("a = { 1, 2 }", "a = [1, 2]", "a list is in [ ]"),
            (
                "a = [b = 1, c = 2]",
                "a = [{ b = 1, c = 2 }]",
                "an entry of a list is in { }",
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
}
