//! Lists and tables that are still open where a heading or another key begins. The reader reports what follows, and the mistake is above.

use super::brackets::closed_in_comment;
use super::tokens::{Token, tokens};
use crate::load::place::bare;

/// List or table that is not closed.
#[derive(Debug)]
pub(super) struct Unclosed<'a> {
    /// Byte at which its line begins.
    pub(super) begin: usize,
    source: &'a str,
    opens: char,
    /// The line at which it should be closed already, and its number.
    next: Option<(&'a str, usize)>,
}

/// Returns the innermost list or table that is open at the line of an error, if that line belongs to none.
pub(super) fn unclosed(text: &str, error_at: usize) -> Option<Unclosed<'_>> {
    let mut open: Vec<Unclosed<'_>> = Vec::new();
    let mut begin = 0;
    for (number, line) in (1..).zip(text.split_inclusive('\n')) {
        if begin > error_at {
            break;
        }
        let source = line.trim_end();
        let tokens = tokens(source);
        if let Some(innermost) = open.pop_if(|innermost| follows(source, &tokens, innermost.opens))
        {
            return Some(Unclosed {
                next: Some((source, number)),
                ..innermost
            });
        }
        for token in &tokens {
            match token {
                Token::Mark(opens @ ('{' | '[')) => open.push(Unclosed {
                    begin,
                    source,
                    opens: *opens,
                    next: None,
                }),
                Token::Mark('}' | ']') => {
                    open.pop();
                }
                _ => {}
            }
        }
        begin += line.len();
    }
    // The end of the file closes nothing.
    open.pop().filter(|_| text[error_at..].trim().is_empty())
}

/// Returns true for a heading, and for a key where a list expects an entry. A table may have its keys in lines of their own.
fn follows(source: &str, tokens: &[Token], opens: char) -> bool {
    let name = source.trim_start_matches('[').split(']').next();
    let is_heading = source.starts_with('[') && name.is_some_and(|name| bare(name.trim()));
    let is_key = matches!(tokens, [Token::Words(key), Token::Mark('='), ..] if bare(key.trim()));
    // `[5]` may be an entry of a list.
    let is_number = name.is_some_and(|name| name.trim().parse::<f64>().is_ok());
    (is_heading && !is_number) || (is_key && opens == '[')
}

impl Unclosed<'_> {
    /// Returns the broken rule.
    pub(super) fn rule(&self) -> String {
        let (what, closes) = match self.opens {
            '{' => ("table", '}'),
            _ => ("list", ']'),
        };
        if let Some(rule) = closed_in_comment(self.source) {
            return format!("the {what} that begins here is not closed: {rule}");
        }
        let place = match self.next {
            Some((next, line)) => format!(" before `{next}` in line {line}"),
            None => String::new(),
        };
        format!(
            "the {what} that begins here is not closed{place}; write `{closes}` after its last entry"
        )
    }
}
