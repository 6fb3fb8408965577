//! One repair for each kind of mistake.

use super::numbers::{decimal_commas, points, powers, thousands, units};
use super::tokens::{Token, is_number, joined, tokens, values};
use crate::scene::load::place::bare;

type Repair = fn(&str) -> Option<(String, String)>;

/// All repairs, in the order in which they are tried. Each gives the broken rule and the repaired line.
pub(super) const REPAIRS: [Repair; 19] = [
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

/// Greek and Cyrillic letters that look like Latin ones.
const LIKE_LATIN: [(char, char); 34] = [
    ('а', 'a'),
    ('е', 'e'),
    ('о', 'o'),
    ('р', 'p'),
    ('с', 'c'),
    ('у', 'y'),
    ('х', 'x'),
    ('і', 'i'),
    ('ј', 'j'),
    ('ѕ', 's'),
    ('һ', 'h'),
    ('ԁ', 'd'),
    ('А', 'A'),
    ('В', 'B'),
    ('Е', 'E'),
    ('К', 'K'),
    ('М', 'M'),
    ('Н', 'H'),
    ('О', 'O'),
    ('Р', 'P'),
    ('С', 'C'),
    ('Т', 'T'),
    ('Х', 'X'),
    ('ο', 'o'),
    ('ν', 'v'),
    ('Α', 'A'),
    ('Β', 'B'),
    ('Ε', 'E'),
    ('Η', 'H'),
    ('Κ', 'K'),
    ('Μ', 'M'),
    ('Ν', 'N'),
    ('Ο', 'O'),
    ('Τ', 'T'),
];

/// A pasted character: its name, and what TOML has in its place.
fn pasted_character(c: char) -> Option<(&'static str, String)> {
    if let '\u{ff01}'..='\u{ff5e}' = c {
        let usual = char::from_u32(c as u32 - FULL_WIDTH)?;
        return Some(("a full-width character", usual.to_string()));
    }
    if let Some((_, usual)) = LIKE_LATIN.iter().find(|(other, _)| *other == c) {
        let name = if c < '\u{400}' {
            "a Greek letter"
        } else {
            "a Cyrillic letter"
        };
        return Some((name, usual.to_string()));
    }
    let (_, name, usual) = PASTED.iter().find(|(all, ..)| all.contains(c))?;
    Some((name, (*usual).to_owned()))
}

fn pasted(line: &str) -> Option<(String, String)> {
    let mut found: Option<(char, &str, String)> = None;
    let mut is_in_number = false;
    let mut tokens = tokens(line);
    for at in 0..tokens.len() {
        let is_value = at > 0 && tokens[at - 1].is('=');
        let Token::Words(words) = &mut tokens[at] else {
            continue;
        };
        let mut usual_words = String::new();
        let mut rest = words.chars();
        while let Some(c) = rest.next() {
            let Some((name, usual)) = pasted_character(c) else {
                usual_words.push(c);
                continue;
            };
            // Typography has such spaces and apostrophes between the digits of a number.
            let before = usual_words.ends_with(|before: char| before.is_ascii_digit());
            let after = rest
                .as_str()
                .starts_with(|after: char| after.is_ascii_digit());
            let is_between = is_value && [" ", "'"].contains(&&*usual) && before && after;
            is_in_number |= is_between;
            if !is_between {
                usual_words.push_str(&usual);
            }
            found.get_or_insert((c, name, usual));
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
        " " | "'" if is_in_number => format!("{shown}; the digits of a number stay together"),
        " " => format!("{shown}; a plain space belongs there"),
        usual => format!("{shown}; `{usual}` belongs there"),
    };
    Some((rule, joined(&tokens)))
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

/// Parentheses, around keys or around numbers.
fn parentheses(line: &str) -> Option<(String, String)> {
    let mut changed = line.to_owned();
    let mut rule = "";
    while let Some(end) = changed.find(')') {
        let begin = changed[..end].rfind('(')?;
        let has_keys = changed[begin..end].contains('=');
        let (open, close);
        (open, close, rule) = match has_keys {
            true => ("{", "}", "an entry is in { }, not in ( )"),
            false => ("[", "]", "a list is in [ ], not in ( )"),
        };
        changed.replace_range(end..=end, close);
        changed.replace_range(begin..=begin, open);
    }
    (!rule.is_empty()).then(|| (rule.to_owned(), changed))
}

/// Brackets that do not match. A list may begin on a line above, or end on one below.
fn brackets(line: &str) -> Option<(String, String)> {
    if closed_in_comment(line).is_some() {
        return None;
    }
    let tokens = tokens(line);
    let mut matching: Vec<Token> = Vec::new();
    // The brackets that close those that are open.
    let mut open = Vec::new();
    // True if the innermost list has numbers or words as entries, and so no lists.
    let mut is_flat = false;
    for (at, token) in tokens.iter().enumerate() {
        match token {
            Token::Mark('[') if is_flat && open.last() == Some(&']') => {
                let comma = matching.iter().rposition(|token| token.is(','));
                matching.insert(comma.unwrap_or(matching.len()), Token::Mark(']'));
                is_flat = false;
            }
            Token::Mark('{') if matching.last().is_some_and(|last| last.is('{')) => continue,
            Token::Mark('{') => open.push('}'),
            Token::Mark('[') => open.push(']'),
            Token::Mark(mark @ ('}' | ']')) => match open.pop() {
                Some(needed) if needed == *mark => {}
                // The list around the entry ends, or another bracket stands in the place of the entry's.
                Some('}') => {
                    matching.push(Token::Mark('}'));
                    let ends_here = open.last() == Some(mark);
                    if !ends_here || tokens[at + 1..].iter().any(|later| later.is(*mark)) {
                        continue;
                    }
                    open.pop();
                }
                Some(needed) => {
                    open.push(needed);
                    continue;
                }
                None if *mark == ']' => {}
                None => continue,
            },
            _ => {}
        }
        match token {
            Token::Mark('{' | '[' | '}' | ']') => is_flat = false,
            Token::Words(words) => is_flat |= !words.trim().is_empty(),
            _ => {}
        }
        matching.push(token.clone());
    }
    let comment = matching.pop_if(|last| matches!(last, Token::Comment(_)));
    let mut matching = joined(&matching);
    if open.last() == Some(&'}') {
        let entries = matching.trim_end();
        let comma = if entries.ends_with(',') { "," } else { "" };
        matching = format!("{} }}{comma}", entries.trim_end_matches([',', ' ']));
        open.pop();
    }
    let (code, spaces) = matching.split_at(matching.trim_end().len());
    // A list that goes on in the next line ends with a comma or with its bracket.
    let closes = match code.ends_with([',', '[']) {
        true => String::new(),
        false => open.iter().rev().collect(),
    };
    let comment = comment.map_or(String::new(), |comment| joined(&[comment]));
    let matching = format!("{code}{closes}{spaces}{comment}");
    let rule = "brackets come in pairs: { } around an entry, [ ] around a list";
    Some((rule.to_owned(), matching))
}

/// The rule for a list or table whose end is behind a `#`.
pub(super) fn closed_in_comment(line: &str) -> Option<String> {
    let tokens = tokens(line);
    let Some(Token::Comment(comment)) = tokens.last() else {
        return None;
    };
    let count = |marks: [char; 2]| {
        tokens
            .iter()
            .filter(|token| marks.iter().any(|mark| token.is(*mark)))
            .count()
    };
    let closes = comment.chars().find(|c| "]}".contains(*c))?;
    (count(['{', '[']) > count(['}', ']'])).then(|| {
        format!(
            "its `{closes}` is behind a `#`, which begins a comment; move the comment to the end of the line"
        )
    })
}

/// More brackets at the end of a line than it has opened.
fn extra_bracket(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let closes = |token: &Token| token.is('}') || token.is(']');
    let opened = tokens
        .iter()
        .filter(|token| token.is('{') || token.is('['))
        .count();
    let closed = tokens.iter().filter(|token| closes(token)).count();
    let last = tokens
        .iter()
        .rposition(closes)
        // A bracket alone ends a list of the lines above.
        .filter(|_| closed > opened && opened > 0)?;
    let Token::Mark(mark) = tokens.remove(last) else {
        return None;
    };
    Some((format!("one `{mark}` is too many"), joined(&tokens)))
}

/// A list in braces, and an entry without braces.
fn entries(line: &str) -> Option<(String, String)> {
    let has_keys = line.contains('=');
    if let (Some(begin), Some(end)) = (line.find('{'), line.rfind('}'))
        && has_keys
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

/// An entry of a list in a line of its own, without a comma after it.
fn comma_after_entry(line: &str) -> Option<(String, String)> {
    let tokens = tokens(line);
    let is_comment = |token: &Token| matches!(token, Token::Comment(_));
    let comment = tokens.iter().position(is_comment);
    let (code, comment) = tokens.split_at(comment.unwrap_or(tokens.len()));
    let code = joined(code);
    let entry = code.trim_end();
    let is_entry = entry.trim_start().starts_with(['{', '[']) && entry.ends_with(['}', ']']);
    is_entry.then(|| {
        let rule = "a comma is between two entries, also of two lines".to_owned();
        let spaces = &code[entry.len()..];
        (rule, format!("{entry},{spaces}{}", joined(comment)))
    })
}

/// The rule for an entry in braces without keys. Only its author knows them.
pub(super) fn keyless(line: &str) -> Option<String> {
    let entry = line.trim().trim_end_matches(',');
    let has_keys = entry.contains(['=', ':']);
    let is_keyless = entry.starts_with('{') && entry.ends_with('}') && !has_keys;
    is_keyless.then(|| {
        "the values of an entry in { } have keys: `{ key = value, key = value }`".to_owned()
    })
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
    Some((
        "text is in quotes; true, false and numbers are not".to_owned(),
        line,
    ))
}
