//! Messages of the TOML reader and of serde, in the words of authors of scenes.

use cophase_core::problem::Problem;

use super::nearest::nearest;
use super::place::{example, example_value, home_of};
use super::repair::{QUOTES, Repaired, commas_in_list, pasted_in_text, repair_value};

/// Longest piece of a file that a message repeats, in characters.
const MOST_QUOTED: usize = 48;

/// Longest line that a message proposes, in characters.
const MOST_REPAIRED: usize = 160;

/// The problem of a key that no scene has at its place.
pub(super) const UNKNOWN_KEY: &str = "unknown key";

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

/// Tables that occur once in a scene.
const TABLES: [&str; 9] = [
    "machine", "cam", "control", "limits", "pulse", "axes", "index", "drift", "scope",
];

/// Lists of tables: each entry has a heading of its own.
const LISTS: [&str; 9] = [
    "program",
    "axis",
    "command",
    "input",
    "fault",
    "late",
    "cam_table",
    "cam_table.segment",
    "limits.band",
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
        return if source.starts_with('[') && LISTS.contains(&key) {
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
    let quoted_source = quoted(source, MOST_QUOTED);
    let is_text = example_value(key).is_none_or(|value| value.is_str());
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
        let form = match example(key) {
            Some(example) => format!("the form is `{}`", quoted(&example, MOST_REPAIRED)),
            None => "write `key = value`, a line each, under `[table]` headings: text in quotes, numbers without units".to_owned(),
        };
        return format!("is not TOML, at `{quoted_source}`: {problem}; {form}");
    };
    let rules = rules.join("; ");
    let right = line.map_or(String::new(), |line| {
        format!(": write `{}`", quoted(&line, MOST_REPAIRED))
    });
    format!("is not TOML, at `{quoted_source}`: {rules}{right}")
}

/// Returns key and sentence for a message of serde; `written` is its text in the file.
///
/// serde gives the known keys in the message only, quoted with backticks. The form is that of
/// `serde::de::Error::unknown_field`, `unknown_variant`, `missing_field`, `invalid_type` and `invalid_length`.
pub(super) fn explain(path: &str, message: &str, written: &str) -> (String, String) {
    let message = one_line(message);
    let path: String = path
        .split('.')
        .map(|step| short(&one_line(step)))
        .collect::<Vec<_>>()
        .join(".");
    let path = path.as_str();
    let mut names = message.split('`').skip(1).step_by(2);
    if let Some(table) = TABLES.iter().find(|table| {
        path.strip_prefix(**table)
            .is_some_and(|rest| rest.starts_with('['))
    }) {
        let problem = format!("is a list here; there is one for all, so write [{table}], once");
        return ((*table).to_owned(), problem);
    }
    if message.starts_with("unknown field") {
        let unknown = names.next().unwrap_or_default();
        let known: Vec<&str> = names.collect();
        return (join(path, unknown), unknown_key(unknown, &known));
    }
    if message.starts_with("unknown variant") {
        let unknown = names.next().unwrap_or_default();
        let known: Vec<&str> = names.collect();
        if let Some((rule, plain)) = pasted_in_text(unknown)
            && known.contains(&plain.as_str())
        {
            return (path.to_owned(), format!("{rule}: write \"{plain}\""));
        }
        let meant = nearest(unknown, &known).map(|name| format!("did you mean \"{name}\"? "));
        let problem = format!(
            "\"{}\" is none of its values; {}give one of {}",
            short(unknown),
            meant.unwrap_or_default(),
            list(&known)
        );
        return (path.to_owned(), problem);
    }
    if message.starts_with("missing field") {
        let key = join(path, names.next().unwrap_or_default());
        // A reader who has no servo meets the keys of one first.
        let other = match path {
            "axes.servo" => "; if no axis is a servo, leave axes.servo out",
            "axes.induction" => "; if no axis has an induction motor, leave axes.induction out",
            _ => "",
        };
        let problem = match example(&key) {
            Some(example) => {
                format!("missing; it has no default, so give it, such as `{example}`{other}")
            }
            None => format!("missing; it has no default, so give it{other}"),
        };
        return (key, problem);
    }
    (path.to_owned(), wrong_type(path, &message, written))
}

fn unknown_key(unknown: &str, known: &[&str]) -> String {
    let usual = USUAL
        .iter()
        .find(|(usual, key)| *usual == unknown && known.contains(key));
    let meant = if let Some(key) = usual
        .map(|(_, key)| *key)
        .or_else(|| nearest(unknown, known))
    {
        match Problem::unit(key) {
            "" => format!("did you mean `{key}`? "),
            unit => format!("did you mean `{key}`, in {unit}? "),
        }
    } else if let Some(home) = home_of(unknown) {
        format!("it belongs {home}; ")
    } else {
        String::new()
    };
    format!("{UNKNOWN_KEY}; {meant}known here: {}", known.join(", "))
}

/// Explains messages such as "invalid type: string "10", expected f64".
fn wrong_type(path: &str, message: &str, written: &str) -> String {
    let such_as = example(path).map_or(String::new(), |example| format!("; such as `{example}`"));
    let source = short(written);
    if message == "wanted string or table" {
        let kind = match written.chars().next() {
            Some('[') => "a list",
            Some('t' | 'f') => "true or false",
            _ => "a number",
        };
        return format!("`{source}` is {kind}, where text in quotes belongs{such_as}");
    }
    let Some((found, expected)) = message
        .strip_prefix("invalid ")
        .and_then(|rest| rest.split_once(", expected "))
    else {
        // A message of the reader itself: the number is too large.
        let message = message.replace(
            "floating-point number overflowed",
            "the number is too large",
        );
        return format!("`{source}`: {message}{such_as}");
    };
    let expected_kind = match expected {
        "f64" => "a number",
        "usize" | "u32" | "u64" => "a whole number, 0 or more,",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "an array of length 2" => "a list of two numbers",
        "an array of length 3" => "a list of three numbers",
        _ if expected.starts_with("a sequence") => "a list",
        _ if expected.starts_with("struct") => "a table",
        other => other,
    };
    let whole = expected_kind.starts_with("a whole");
    if let Some(length) = found.strip_prefix("length ") {
        if let Some(rule) = commas_in_list(&format!("{path} = {written}")) {
            return format!("`{source}` has {length} in it, where {expected_kind} belongs; {rule}");
        }
        return format!("`{source}` has {length} in it, where {expected_kind} belongs{such_as}");
    }
    let (_, found) = found.split_once(": ").unwrap_or(("", found));
    let kind = match found.split([' ', '`']).next().unwrap_or_default() {
        "string" => "text",
        "integer" if whole && written.starts_with('-') => "negative",
        "integer" if whole => "too large",
        "integer" => "a number",
        "floating" if whole => "a number with a fraction or exponent",
        "floating" => "a number",
        "boolean" => "true or false",
        "sequence" => "a list",
        "map" if written.starts_with(['[', '{']) => "a table",
        "map" => "a date",
        _ => "something else",
    };
    if kind == "a table" && expected_kind == "a list" && !path.contains('.') {
        return format!("is a table, where a list of tables belongs; write [[{path}]]");
    }
    let right = match (kind, written.trim_matches(['"', '\''])) {
        ("a table", table)
            if expected_kind == "a list"
                && !table.contains('\n')
                && table.len() < MOST_REPAIRED =>
        {
            format!("; write [{table}]")
        }
        ("text", inner) if expected_kind == "a number" || whole => {
            let number = |text: &str| {
                text.parse::<f64>()
                    .is_ok_and(|x| !whole || x.fract() == 0.0)
            };
            let inner = repair_value(inner).unwrap_or_else(|| inner.to_owned());
            if number(&inner) {
                format!("; write {inner}, without quotes")
            } else {
                such_as
            }
        }
        ("text", inner) if expected_kind == "a list of two numbers" => {
            let numbers: Vec<_> = inner.split([':', '/', ',', 'x']).map(str::trim).collect();
            match numbers[..] {
                [one, other] if [one, other].iter().all(|text| text.parse::<f64>().is_ok()) => {
                    format!("; write [{one}, {other}]")
                }
                _ => such_as,
            }
        }
        _ if kind.contains("fraction") && path.ends_with("steps_per_turn") => {
            "; give the motor's own, and its belt or gearbox as gear = [motor turns, crank turns]"
                .to_owned()
        }
        _ => such_as,
    };
    format!("`{source}` is {kind}, where {expected_kind} belongs{right}")
}

fn join(path: &str, key: &str) -> String {
    let key = short(key);
    // If serde was inside the key, the path already ends with it.
    if path.is_empty() || path == key {
        key
    } else if path.ends_with(&format!(".{key}")) {
        path.to_owned()
    } else {
        format!("{path}.{key}")
    }
}

fn list(names: &[&str]) -> String {
    let names: Vec<_> = names.iter().map(|name| format!("\"{name}\"")).collect();
    names.join(", ")
}

fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn short(text: &str) -> String {
    quoted(text, MOST_QUOTED)
}

/// Returns the first line of a text, shortened if it is long.
fn quoted(text: &str, most: usize) -> String {
    let line = text.lines().next().unwrap_or_default();
    let cut = line.chars().count() > most || line.len() < text.trim_end().len();
    let mut kept: String = line.chars().take(most).collect();
    if cut {
        kept.push('…');
    }
    kept
}

#[cfg(test)]
mod tests;
