//! Repairs of numbers.

use std::cell::Cell;

use cophase_core::problem::Problem;

use super::tokens::{Token, is_number, joined, tokens, values};

pub(super) fn decimal_commas(line: &str) -> Option<(String, String)> {
    let mut tokens = tokens(line);
    let mut is_changed = false;
    let mut at = 1;
    while at + 2 < tokens.len() {
        let (whole, fraction) = (tokens[at].words(), tokens[at + 2].words());
        let is_whole = tokens[at - 1].is('=') && is_number(&whole.replace('.', ""));
        let is_fraction = fraction.starts_with(|first: char| first.is_ascii_digit())
            && !tokens.get(at + 3).is_some_and(|next| next.is('='))
            && !is_ambiguous(whole, fraction);
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

/// True for digits around a comma that may be thousands, or a fraction.
fn is_ambiguous(whole: &str, fraction: &str) -> bool {
    let digits = fraction.split('.').next().unwrap_or_default();
    digits.len() == 3 && is_number(digits) && !whole.contains('.') && !matches!(whole, "0" | "-0")
}

/// The rule for a comma that may stand before thousands, or before a fraction: `40,000`.
pub(super) fn ambiguous_comma(line: &str) -> Option<String> {
    let tokens = tokens(line);
    let mut places = tokens.windows(4).filter_map(|window| match window {
        [Token::Mark('='), whole, Token::Mark(','), fraction] => {
            Some((whole.words(), fraction.words()))
        }
        _ => None,
    });
    let is_meant =
        |(whole, fraction): &(&str, &str)| is_number(whole) && is_ambiguous(whole, fraction);
    let (whole, fraction) = places.find(is_meant)?;
    let fractional = match fraction.contains('.') {
        true => String::new(),
        false => format!(", or `{whole}.{fraction}` if the comma is a decimal one"),
    };
    Some(format!(
        "a number has no comma: write `{whole}{fraction}`{fractional}"
    ))
}

/// The rule for a list of numbers with commas in them: `[7,680, 7,500]` or `[0,525, 1,02]`. Behind the comma of an entry is a space.
pub(in super::super) fn commas_in_list(line: &str) -> Option<String> {
    let (_, value) = line.split_once('=')?;
    let value = value.split('#').next()?.trim();
    let entries = value.strip_prefix('[')?.strip_suffix(']')?;
    let entries: Vec<(&str, &str)> = entries
        .split(", ")
        .map(|entry| entry.trim().split_once(',').unwrap_or((entry.trim(), "")))
        .collect();
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let are_numbers = entries
        .iter()
        .all(|(whole, after)| is_number(whole) && digits(after));
    if !are_numbers || entries.len() < 2 || entries.iter().all(|(_, after)| after.is_empty()) {
        return None;
    }
    let with = |between: &str| {
        let number = |(whole, after): &(&str, &str)| match after.is_empty() {
            true => (*whole).to_owned(),
            false => format!("{whole}{between}{after}"),
        };
        let numbers: Vec<_> = entries.iter().map(number).collect();
        format!("`[{}]`", numbers.join(", "))
    };
    let are_thousands = entries.iter().all(|(whole, after)| {
        matches!(after.len(), 0 | 3) && !whole.trim_start_matches('-').starts_with('0')
    });
    Some(match are_thousands {
        true => format!(
            "a number has no comma: write {}, or {} if the comma is a decimal one",
            with(""),
            with(".")
        ),
        false => format!("a number has a decimal point: write {}", with(".")),
    })
}

/// The rule for a number of a list that may be the thousands of the one before: `[175, 2,030]`.
pub(super) fn ambiguous_zeros(line: &str) -> Option<String> {
    let tokens = tokens(line);
    let mut places = tokens.windows(3).filter_map(|window| match window {
        [whole, Token::Mark(','), digits] => Some((whole.words(), digits.words())),
        _ => None,
    });
    let is_meant = |(whole, digits): &(&str, &str)| is_number(whole) && is_group(digits);
    let (whole, digits) = places.find(is_meant)?;
    Some(format!(
        "`{whole},{digits}` is two numbers, and none has a zero before its digits: write `{whole}{digits}` if it is one"
    ))
}

/// True for the digits of a thousand with zeros in front.
fn is_group(digits: &str) -> bool {
    digits.len() == 3 && digits.starts_with('0') && is_number(digits)
}

pub(super) fn powers(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, _| {
        let value = plain_exponent(value);
        let forms = [
            "×10^", "*10^", "x10^", "·10^", " × 10^", " * 10^", " x 10^", " · 10^", "*10**",
        ];
        let form = forms.iter().find(|form| value.contains(**form))?;
        let number = value.replacen(form, "e", 1);
        is_number(&number).then_some(number)
    })?;
    Some(("a power of ten is written with e".to_owned(), line))
}

/// Returns a number with `^-3` in the place of superscript digits.
fn plain_exponent(value: &str) -> String {
    const SUPERSCRIPTS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let mut plain = String::new();
    let mut is_exponent = false;
    for c in value.chars() {
        let digit = SUPERSCRIPTS
            .chars()
            .position(|superscript| superscript == c);
        if !is_exponent && (digit.is_some() || c == '⁻') {
            plain.push('^');
            is_exponent = true;
        }
        match digit {
            Some(digit) => plain.push_str(&digit.to_string()),
            None if c == '⁻' => plain.push('-'),
            None => plain.push(c),
        }
    }
    plain
}

pub(super) fn thousands(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, key| {
        // In a list, they may be several numbers.
        let is_in_list = key.is_empty() && value.contains(' ');
        if is_in_list && !value.split(' ').skip(1).all(is_group) {
            return None;
        }
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

pub(super) fn units(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, key| {
        let (number, unit) = number_and_unit(value)?;
        is_unit_of(key, unit).then(|| number.to_owned())
    })?;
    Some(("a number has no unit".to_owned(), line))
}

/// The rule for a number in another unit than its key's.
pub(super) fn other_unit(line: &str) -> Option<String> {
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
    if is_number(value) {
        return None;
    }
    let is_end = |at: &usize| value.is_char_boundary(*at) && is_number(&value[..*at]);
    let end = (1..value.len()).rev().find(is_end)?;
    let (number, unit) = (&value[..end], value[end..].trim());
    // m/s^2 has a digit as well, but the digits of other numbers come first.
    let letters = unit.trim_end_matches(['2', '3', '^']);
    let is_unit = letters.starts_with(|first: char| first.is_alphabetic() || "°%".contains(first))
        && !letters.contains(|c: char| c.is_ascii_digit() || c == ':');
    is_unit.then_some((number, unit))
}

pub(super) fn points(line: &str) -> Option<(String, String)> {
    let line = values(line, |value, key| {
        if key.is_empty() && is_group(value) {
            return None;
        }
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
