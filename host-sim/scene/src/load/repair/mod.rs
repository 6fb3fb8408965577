//! Repairs of a line that is not TOML, so that a message can state what to write.
//!
//! Each repair is for one kind of mistake, such as a decimal comma or a pasted minus sign. It is kept if the reader of TOML gets
//! further with it. So a message only proposes what is TOML.

mod brackets;
mod numbers;
mod pasted;
mod rules;
mod tokens;
mod unclosed;

use toml::de::DeTable;

use brackets::{closed_in_comment, keyless};
pub(super) use numbers::commas_in_list;
use numbers::{ambiguous_comma, ambiguous_zeros, other_unit};
pub(super) use pasted::pasted_in_text;
pub(super) use rules::QUOTES;
use rules::REPAIRS;
use unclosed::unclosed;

/// Longest line that is repaired, bytes.
const MAX_BYTES: usize = 4096;

/// Mistakes that one line has at most.
const MAX_MISTAKES: usize = 5;

/// A line with its mistakes repaired, and the rules that it broke.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Repaired {
    /// Byte at which the line begins.
    pub(super) begin: usize,
    pub(super) rules: Vec<String>,
    /// None if only the author knows what to write.
    pub(super) line: Option<String>,
}

/// Mistakes that only the author can repair. Each gives the broken rule.
const ADVICE: [fn(&str) -> Option<String>; 5] = [
    closed_in_comment,
    other_unit,
    ambiguous_comma,
    ambiguous_zeros,
    keyless,
];

/// Repairs the line around the first error of a text that is not TOML; or the line above, if that is incomplete.
pub(super) fn repair(text: &str, error_at: usize) -> Option<Repaired> {
    let begin = text[..error_at].rfind('\n').map_or(0, |at| at + 1);
    let end = text[begin..].find('\n').map_or(text.len(), |at| begin + at);
    if let Some(open) = unclosed(text, error_at) {
        return Some(
            repair_line(text, open.begin, end).unwrap_or_else(|| Repaired {
                begin: open.begin,
                rules: vec![open.rule()],
                line: None,
            }),
        );
    }
    let before = text[..begin].trim_end().rfind('\n').map_or(0, |at| at + 1);
    repair_line(text, begin, end)
        .or_else(|| repair_line(text, before, end).filter(|_| before < begin))
}

/// Repairs the line at `begin` so that no error remains before `end`.
fn repair_line(text: &str, begin: usize, end: usize) -> Option<Repaired> {
    let length = text[begin..].find('\n').unwrap_or(text.len() - begin);
    let (line, after) = text[begin..].split_at(length);
    if line.len() > MAX_BYTES {
        return None;
    }
    let with = |line: &str| format!("{}{line}{after}", &text[..begin]);
    let rest = text.len() - end;
    let mut line = line.to_owned();
    let mut rules = Vec::new();
    // Each of its numbers could be repaired, and some of them to others than were meant.
    if let Some(rule) = commas_in_list(&line) {
        rules.push(rule);
        return Some(Repaired {
            begin,
            rules,
            line: None,
        });
    }
    for _ in 0..MAX_MISTAKES {
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
            rules.push(ADVICE.iter().find_map(|advice| advice(&line))?);
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

#[cfg(test)]
mod tests;
