//! Repairs of brackets, and of the entries in them.

use super::tokens::{Token, joined, tokens};

/// Keys of lists whose entries are in braces.
const LISTS: [&str; 4] = ["band", "segments", "segment", "program"];

/// Parentheses, around keys or around numbers.
pub(super) fn parentheses(line: &str) -> Option<(String, String)> {
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
pub(super) fn brackets(line: &str) -> Option<(String, String)> {
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
pub(super) fn extra_bracket(line: &str) -> Option<(String, String)> {
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
pub(super) fn entries(line: &str) -> Option<(String, String)> {
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
    if let Some((key, value)) = line.split_once('=')
        && let (Some(begin), Some(end)) = (value.find('{'), value.rfind('}'))
        && begin < end
        && value[begin + 1..].trim_start().starts_with('{')
    {
        let list = format!(
            "{key}={}[{}]{}",
            &value[..begin],
            value[begin + 1..end].trim(),
            &value[end + 1..]
        );
        return Some(("a list is in [ ]".to_owned(), list));
    }
    if let (Some(begin), Some(end)) = (line.find('['), line.rfind(']'))
        && begin < end
        && line[begin..end].contains('=')
    {
        let inner = line[begin + 1..end].trim();
        let key = line.split('=').next().unwrap_or_default().trim();
        let (open, close) = match LISTS.contains(&key) {
            true => ("[{", "}]"),
            false => ("{", "}"),
        };
        return Some((
            rule,
            format!(
                "{}{open} {inner} {close}{}",
                &line[..begin],
                &line[end + 1..]
            ),
        ));
    }
    let inner = line.trim().trim_end_matches(',');
    has_keys.then(|| (rule, format!("{{ {inner} }},")))
}

/// An entry of a list in a line of its own, without a comma after it.
pub(super) fn comma_after_entry(line: &str) -> Option<(String, String)> {
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
