//! Pieces of a line, whether it is TOML or not.

/// Piece of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Token {
    /// One of `=,{}[]`.
    Mark(char),
    /// Text in quotes.
    Quoted(String),
    Comment(String),
    /// Keys and values between them, with their spaces.
    Words(String),
}

impl Token {
    pub(super) fn is(&self, mark: char) -> bool {
        *self == Self::Mark(mark)
    }

    /// The words without the spaces around them; empty for other tokens.
    pub(super) fn words(&self) -> &str {
        match self {
            Self::Words(words) => words.trim(),
            _ => "",
        }
    }

    /// Replaces the words, and keeps the spaces around them.
    pub(super) fn put(&mut self, new: &str) {
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

pub(super) fn tokens(line: &str) -> Vec<Token> {
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

pub(super) fn joined(tokens: &[Token]) -> String {
    let text = |token: &Token| match token {
        Token::Mark(mark) => mark.to_string(),
        Token::Quoted(text) | Token::Comment(text) | Token::Words(text) => text.clone(),
    };
    tokens.iter().map(text).collect()
}

/// Changes the words of each place for a value: after `=`, or in a list. `change` has the words, and the key before them.
pub(super) fn values(line: &str, change: impl Fn(&str, &str) -> Option<String>) -> Option<String> {
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

pub(super) fn is_number(text: &str) -> bool {
    let digits = text.trim_start_matches(['+', '-']);
    digits.starts_with(|first: char| first.is_ascii_digit()) && text.parse::<f64>().is_ok()
}
