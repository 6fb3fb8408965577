//! Sentences about the form of a scene, and messages of the TOML reader in the words of authors of scenes.

use cophase_core::problem::Problem;
use cophase_core::settings::key::Kind;
use toml::de::DeValue;

use super::nearest::nearest;
use super::repair::{QUOTES, Repaired, commas_in_list, pasted_in_text, repair_value};
use crate::file::{MACHINES, Scene};
use crate::keys;

/// Longest piece of a file that a message repeats, in characters.
const MAX_QUOTED: usize = 48;

/// Longest line that a message proposes, in characters.
const MAX_REPAIRED: usize = 160;

/// The problem of a key that no scene has at its place.
const UNKNOWN_KEY: &str = "unknown key";

/// Names that other programs and data sheets have for keys.
const USUAL: [(&str, &str); 12] = [
    ("kp", "position_gain_per_s"),
    ("kv", "velocity_gain_nms"),
    ("ti", "integral_s"),
    ("max_torque", "limit_nm"),
    ("peak_torque_nm", "limit_nm"),
    ("inertia", "rotor_inertia_kgm2"),
    ("microsteps", "steps_per_turn"),
    ("steps", "steps_per_turn"),
    ("mass_kg", "load_kg"),
    ("acceleration_g", "amax_g"),
    ("ramp", "ramp_s"),
    ("hold", "hold_s"),
];

/// Returns the problem of a line that is not TOML. `key` is the key on it, if it can be recognised, and `at` the text to which the message
/// of the reader refers.
pub(super) fn not_toml(
    key: &str,
    message: &str,
    at: &str,
    source: &str,
    repaired: Option<Repaired>,
) -> String {
    let message = one_line(message);
    let source = source.trim_start_matches('\u{feff}').trim();
    if message.starts_with("duplicate key") {
        return if source.starts_with("[[") {
            let list = key.trim_end_matches(|c| c != '[').trim_end_matches('[');
            let other = nearest(
                list,
                &Scene::KEYS
                    .iter()
                    .map(|key| key.name)
                    .filter(|name| *name != list)
                    .collect::<Vec<_>>(),
            )
            .map_or(String::new(), |other| {
                format!(", or [{other}] if its keys are those")
            });
            format!("given before as a table; write [[{list}]] there, too{other}")
        } else if source.starts_with('[')
            && !key.contains('[')
            && keys::row(key).is_some_and(|row| list_of_tables(&row.kind))
        {
            format!("given before, and it is a list; write [[{key}]] at each of its entries")
        } else if source.starts_with('[') || key.ends_with(at) {
            "given before; keep one of the two".to_owned()
        } else {
            format!(
                "`{}` is given before in these braces; keep one of the two",
                short(at)
            )
        };
    }
    if message.contains("recurs") {
        return "lists and tables are nested too deep; a program's blocks go 8 deep at most"
            .to_owned();
    }
    let quoted_source = quoted(source, MAX_QUOTED);
    let is_text = keys::row(key).is_none_or(|row| matches!(row.kind, Kind::Text | Kind::Word(_)));
    let meant = repaired.filter(|repaired| is_text || repaired.rules != [QUOTES]);
    let Some(Repaired { rules, line, .. }) = meant else {
        let has_no_value = source
            .split('#')
            .next()
            .unwrap_or_default()
            .trim_end()
            .ends_with('=');
        let problem = match message.as_str() {
            _ if has_no_value => "the value is missing",
            // What the reader tries last says nothing about what was meant.
            message if message.contains("literal string") => "there is no value that TOML knows",
            message => message,
        };
        let form = match keys::example(key) {
            Some(example) => format!("the form is `{}`", quoted(&example, MAX_REPAIRED)),
            None => "write `key = value`, a line each, under `[table]` headings: text in quotes, numbers without units".to_owned(),
        };
        return format!("is not TOML, at `{quoted_source}`: {problem}; {form}");
    };
    let rules = rules.join("; ");
    let right = line.map_or(String::new(), |line| {
        format!(": write `{}`", quoted(&line, MAX_REPAIRED))
    });
    format!("is not TOML, at `{quoted_source}`: {rules}{right}")
}

/// Returns the sentence about a key that is missing.
pub(super) fn missing(path: &str) -> String {
    // A reader who has no servo meets the keys of one first.
    let other = match path.rsplit_once('.') {
        Some(("axes.servo", _)) => "; if no axis is a servo, leave axes.servo out",
        Some(("axes.induction", _)) => {
            "; if no axis has an induction motor, leave axes.induction out"
        }
        _ => "",
    };
    format!(
        "missing; it has no default, so give it{}{other}",
        such_as(", ", path)
    )
}

/// Returns the words about an example of a key, behind a mark; empty if there is none.
fn such_as(mark: &str, path: &str) -> String {
    keys::example(path).map_or(String::new(), |example| {
        format!("{mark}such as `{example}`")
    })
}

/// Returns the sentence about a word that is none of a key's.
pub(super) fn no_word(word: &str, words: &[&str]) -> String {
    if let Some((rule, plain)) = pasted_in_text(word)
        && words.contains(&plain.as_str())
    {
        return format!("{rule}: write \"{plain}\"");
    }
    let meant = nearest(word, words).map(|name| format!("did you mean \"{name}\"? "));
    format!(
        "\"{}\" is none of its values; {}give one of {}",
        short(word),
        meant.unwrap_or_default(),
        list(words)
    )
}

/// Returns the known key that an unknown one was probably meant to be.
pub(super) fn meant<'a>(unknown: &str, known: &[&'a str]) -> Option<&'a str> {
    let usual = USUAL.iter().find(|(usual, _)| *usual == unknown);
    usual
        .and_then(|(_, key)| known.iter().copied().find(|name| name == key))
        .or_else(|| nearest(unknown, known))
}

/// Returns the sentence about a key that no scene has at its place. The known keys are listed once for a table.
pub(super) fn unknown_key(
    table: &str,
    unknown: &str,
    meant: Option<&str>,
    known: &[&str],
    is_first: bool,
) -> String {
    let mut parts = vec![UNKNOWN_KEY.to_owned()];
    if let Some(key) = meant {
        parts.push(match Problem::unit(key) {
            "" => format!("did you mean `{key}`?"),
            unit => format!("did you mean `{key}`, in {unit}?"),
        });
    } else {
        let homes = keys::homes(unknown);
        let place = homes.join(" or ");
        match homes.first() {
            Some(home) if is_machine(home) && is_machine(table) => parts.push(format!(
                "it belongs under {place}, and a scene has one machine; leave it out"
            )),
            Some(home) if home.starts_with('[') => parts.push(format!("it belongs under {place}")),
            Some(_) => parts.push(format!("it belongs {place}")),
            None => {}
        }
    }
    if is_first {
        parts.push(format!("known here: {}", known.join(", ")));
    }
    parts.join("; ").replace("?;", "?")
}

/// Returns the heading to which all unknown keys of a table belong, if there are two or more. Then their own is wrong, or missing.
pub(super) fn other_heading(unknown: &[String]) -> Option<String> {
    // No scene has some keys.
    let homes = unknown.iter().map(|key| keys::homes(key));
    let mut homes = homes.filter(|homes| !homes.is_empty());
    let first = homes.next()?;
    let mut shared = homes.fold(first, |mut shared, homes| {
        shared.retain(|home| homes.contains(home));
        shared
    });
    let heading = shared.pop()?;
    let is_one = shared.is_empty() && unknown.len() > 1 && heading.starts_with('[');
    is_one.then_some(heading)
}

/// Returns the sentence about keys of a heading that are in a table without it, or with another one, which may have keys of its own.
pub(super) fn wrong_heading(
    table: &str,
    unknown: &[String],
    has_others: bool,
    heading: &str,
) -> String {
    let list = unknown.join(", ");
    match table {
        "" => format!("the heading {heading} is missing above this line: {list} are its keys"),
        table if has_others && is_machine(table) && is_machine(heading) => format!(
            "{list} are keys of {heading}, and a scene has one machine, here [{table}]; leave them out"
        ),
        table => format!(
            "{list} are keys of {heading}; write {heading} in the place of [{table}], or move them there"
        ),
    }
}

/// True for the heading of a machine, with or without brackets.
fn is_machine(heading: &str) -> bool {
    MACHINES.contains(&heading.trim_matches(['[', ']']))
}

fn list_of_tables(kind: &Kind) -> bool {
    matches!(kind, Kind::List(Kind::Table(_), _))
}

/// Returns the sentence about a value that has not the form of its key; `source` is its text.
pub(super) fn wrong_form(path: &str, kind: &Kind, value: &DeValue, written: &str) -> String {
    let source = short(written);
    let such_as = such_as("; ", path);
    let is_top = !path.contains(['.', '[']);
    let is_whole = matches!(kind, Kind::Whole(..));
    let expected = match kind {
        Kind::Number => "a number",
        Kind::Whole(0, _) => "a whole number, 0 or more,",
        Kind::Whole(..) => "a whole number",
        Kind::Flag => "true or false",
        Kind::Text | Kind::Word(_) => "text in quotes",
        Kind::List(_, Some(2)) => "a list of two numbers",
        Kind::List(_, Some(3)) => "a list of three numbers",
        Kind::List(_, Some(_)) => "a list of four numbers",
        Kind::List(_, None) => "a list",
        Kind::Table(_) => "a table",
    };
    let found = match value {
        DeValue::Array(list) if matches!(kind, Kind::List(..)) => {
            let right = commas_in_list(&format!("{path} = {written}"))
                .map_or(such_as, |rule| format!("; {rule}"));
            let length = list.len();
            return format!("`{source}` has {length} in it, where {expected} belongs{right}");
        }
        DeValue::Array(_) if matches!(kind, Kind::Table(_)) && is_top => {
            return format!("is a list here; there is one for all, so write [{path}], once");
        }
        DeValue::Table(_) if list_of_tables(kind) && is_top => {
            return format!("is a table, where a list of tables belongs; write [[{path}]]");
        }
        DeValue::Float(_) if matches!(kind, Kind::Number) => {
            return format!("`{source}`: the number is too large{such_as}");
        }
        DeValue::String(_) => "text",
        DeValue::Integer(_) if matches!(kind, Kind::Whole(0, _)) && written.starts_with('-') => {
            "negative"
        }
        DeValue::Integer(_) if is_whole => "too large",
        DeValue::Float(_) if is_whole => "a number with a fraction or exponent",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
        DeValue::Datetime(_) => "a date",
    };
    let right = match (value, written.trim_matches(['"', '\''])) {
        (DeValue::Table(_), table)
            if expected == "a list" && !table.contains('\n') && table.len() < MAX_REPAIRED =>
        {
            format!("; write [{table}]")
        }
        (DeValue::String(_), inner) if is_whole || matches!(kind, Kind::Number) => {
            let inner = repair_value(inner).unwrap_or_else(|| inner.to_owned());
            let number: Result<f64, _> = inner.parse();
            match number {
                Ok(number) if !is_whole || number.fract() == 0.0 => {
                    format!("; write {inner}, without quotes")
                }
                _ => such_as,
            }
        }
        (DeValue::String(_), inner) if matches!(kind, Kind::List(_, Some(2))) => {
            let numbers: Vec<_> = inner.split([':', '/', ',', 'x']).map(str::trim).collect();
            match numbers[..] {
                [one, other] if [one, other].iter().all(|text| text.parse::<f64>().is_ok()) => {
                    format!("; write [{one}, {other}]")
                }
                _ => such_as,
            }
        }
        (DeValue::Float(_), _) if is_whole && path.ends_with("steps_per_turn") => {
            "; give the motor's own, and its belt or gearbox as gear = [motor turns, crank turns]"
                .to_owned()
        }
        _ => such_as,
    };
    format!("`{source}` is {found}, where {expected} belongs{right}")
}

fn list(names: &[&str]) -> String {
    let names: Vec<_> = names.iter().map(|name| format!("\"{name}\"")).collect();
    names.join(", ")
}

pub(super) fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

pub(super) fn short(text: &str) -> String {
    quoted(text, MAX_QUOTED)
}

/// Returns the first line of a text, shortened if it is long.
fn quoted(text: &str, max: usize) -> String {
    let line = text.lines().next().unwrap_or_default();
    let cut = line.chars().count() > max || line.len() < text.trim_end().len();
    let mut kept: String = line.chars().take(max).collect();
    if cut {
        kept.push('…');
    }
    kept
}

#[cfg(test)]
mod tests;
