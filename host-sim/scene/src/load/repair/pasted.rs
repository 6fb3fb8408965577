//! Repair of characters that are pasted from other programs.

use super::tokens::{Token, joined, tokens};

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

/// Letters and digits that keys spell in ASCII.
const SPELLED: [(char, &str, &str); 8] = [
    ('λ', "a Greek letter", "lambda"),
    ('ω', "a Greek letter", "omega"),
    ('ζ', "a Greek letter", "zeta"),
    ('φ', "a Greek letter", "phi"),
    ('μ', "a Greek letter", "u"),
    ('µ', "the sign of micro", "u"),
    ('²', "a superscript", "2"),
    ('³', "a superscript", "3"),
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

/// A character that no key has: its name, and how keys spell it.
fn spelled_character(c: char) -> Option<(&'static str, String)> {
    let (_, name, usual) = SPELLED.iter().find(|(other, ..)| *other == c)?;
    Some((name, (*usual).to_owned()))
}

/// Returns a text without characters that are pasted from other programs, and the rule that the first of them breaks.
pub(in super::super) fn pasted_in_text(text: &str) -> Option<(String, String)> {
    let (c, (name, usual)) = text.chars().find_map(|c| Some((c, pasted_character(c)?)))?;
    let usual_of = |c: char| pasted_character(c).map_or(c.to_string(), |(_, usual)| usual);
    Some((
        rule(c, name, &usual, false),
        text.chars().map(usual_of).collect(),
    ))
}

pub(super) fn pasted(line: &str) -> Option<(String, String)> {
    let mut found: Option<(char, &str, String)> = None;
    let mut is_in_number = false;
    let mut tokens = tokens(line);
    for at in 0..tokens.len() {
        let is_value = at > 0 && tokens[at - 1].is('=');
        let is_key = tokens.get(at + 1).is_some_and(|next| next.is('='));
        let Token::Words(words) = &mut tokens[at] else {
            continue;
        };
        let mut usual_words = String::new();
        let mut rest = words.chars();
        while let Some(c) = rest.next() {
            let spelled = || spelled_character(c).filter(|_| is_key);
            let Some((name, usual)) = pasted_character(c).or_else(spelled) else {
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
    Some((rule(c, name, &usual, is_in_number), joined(&tokens)))
}

/// The rule that a pasted character breaks.
fn rule(c: char, name: &str, usual: &str, is_in_number: bool) -> String {
    let code = c as u32;
    let shown = if c.is_whitespace() || usual.is_empty() {
        format!("U+{code:04X} is {name}")
    } else {
        format!("`{c}` (U+{code:04X}) is {name}")
    };
    match usual {
        "" => format!("{shown}; delete it"),
        " " | "'" if is_in_number => format!("{shown}; the digits of a number stay together"),
        " " => format!("{shown}; a plain space belongs there"),
        usual => format!("{shown}; `{usual}` belongs there"),
    }
}
