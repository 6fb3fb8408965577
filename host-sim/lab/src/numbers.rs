//! Numbers as values of options. An error states the range, and the number in the right form if it is clear which one was meant.

use std::error::Error;
use std::fmt;
use std::num::IntErrorKind;
use std::ops::RangeInclusive;

/// Text that is no number as its option takes it.
#[derive(Debug)]
pub struct NoNumber {
    text: String,
    /// The form of a right value.
    form: String,
    /// Ends the form if it is not clear what was meant.
    example: &'static str,
    /// Range of whole numbers; none if a number may have a fraction.
    whole: Option<RangeInclusive<u64>>,
}

impl fmt::Display for NoNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.form, self.example)
    }
}

impl Error for NoNumber {}

impl NoNumber {
    /// Returns what to give for an option with a unit in its name.
    fn fix(&self, unit: Option<&str>) -> String {
        let meant = match &self.whole {
            None => meant(&self.text, unit).map(|number| number.to_string()),
            Some(range) => meant_whole(&self.text, unit)
                .filter(|number| range.contains(number))
                .map(|number| number.to_string()),
        };
        meant.map_or_else(
            || self.to_string(),
            |meant| format!("{}: {meant}", self.form),
        )
    }
}

/// Returns the reason why the value of an option is refused.
pub fn reason(refusal: &(dyn Error + 'static), option: &str) -> String {
    refusal
        .downcast_ref::<NoNumber>()
        .map_or_else(|| refusal.to_string(), |number| number.fix(unit_of(option)))
}

/// Returns a parser of a whole number in a range.
pub fn whole<N>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<N, NoNumber> + Clone + Send + Sync + 'static
where
    N: TryFrom<u64> + 'static,
{
    move |text| {
        let parsed = text.parse::<u64>();
        let is_too_large =
            (parsed.as_ref()).is_err_and(|error| *error.kind() == IntErrorKind::PosOverflow);
        let number = parsed.ok().filter(|number| range.contains(number));
        number
            .and_then(|number| N::try_from(number).ok())
            .ok_or_else(|| {
                let (from, to) = (range.start(), range.end());
                let form = if *to == u64::MAX && !is_too_large {
                    format!("give a whole number, {from} or more")
                } else {
                    format!("give a whole number, {from} to {to}")
                };
                NoNumber {
                    text: text.to_owned(),
                    form,
                    example: "",
                    whole: Some(range.clone()),
                }
            })
    }
}

/// Parses a number that may have a fraction. The command checks its range with all other inputs.
pub fn number(text: &str) -> Result<f64, NoNumber> {
    text.parse().map_err(|_| NoNumber {
        text: text.to_owned(),
        form: "give a number without a unit, with a point for fractions".to_owned(),
        example: ", such as 12.5",
        whole: None,
    })
}

/// Parses a number of a unit in a range, which `form` states.
pub fn in_range(
    text: &str,
    range: RangeInclusive<f64>,
    unit: &str,
    form: &str,
) -> Result<f64, String> {
    let is_right = |number: &f64| range.contains(number);
    let parsed = text.parse().ok().filter(is_right);
    parsed.ok_or_else(|| {
        let meant = meant(text, Some(unit)).filter(is_right);
        meant.map_or_else(|| form.to_owned(), |meant| format!("{form}: {meant}"))
    })
}

/// Other spellings of the units in names of options and columns.
const SPELLINGS: [(&str, &[&str]); 9] = [
    ("%", &["percent", "pct"]),
    ("s", &["sec", "secs", "second", "seconds"]),
    ("x", &["times"]),
    ("deg", &["°", "degrees"]),
    ("mps2", &["m/s2", "m/s²", "m/s^2"]),
    ("kgm2", &["kg*m2", "kgm²", "kg*m²", "kg*m^2", "kgm^2"]),
    ("kg", &["kilograms"]),
    ("m", &["metres", "meters"]),
    ("rpm", &["1/min", "rev/min"]),
];

/// Returns the number of a text with this unit after it, or with a comma for its fraction. There is none if the text is a right number,
/// has another unit, or may mean two numbers.
pub fn meant(text: &str, unit: Option<&str>) -> Option<f64> {
    let text = text.trim();
    let ends = (1..=text.len()).rev();
    let mut parts = ends.filter_map(|end| text.split_at_checked(end));
    let (number, after) = parts.find_map(|(number, after)| {
        let number = with_point(number.trim_end())?;
        Some((number, after.trim()))
    })?;
    let is_unit = |unit: &str| {
        let spellings = SPELLINGS.iter().find(|(known, _)| *known == unit);
        let others = spellings.map_or(&[][..], |(_, others)| others);
        unit.eq_ignore_ascii_case(after) || others.iter().any(|s| s.eq_ignore_ascii_case(after))
    };
    let is_clear = number.is_finite() && (after.is_empty() || unit.is_some_and(is_unit));
    is_clear.then_some(number)
}

/// Parses a number with a point or a comma for its fraction. A comma before three digits may also separate thousands.
fn with_point(text: &str) -> Option<f64> {
    // `inf` and `nan` are no beginnings of numbers with units.
    if text.contains(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E')) {
        return None;
    }
    match text.split_once(',') {
        None => text.parse().ok(),
        Some((_, fraction)) if fraction.len() == 3 => None,
        Some(_) => text.replacen(',', ".", 1).parse().ok(),
    }
}

/// Returns the whole number of a text with an exponent, with separated thousands, or with this unit.
fn meant_whole(text: &str, unit: Option<&str>) -> Option<u64> {
    let mut groups = text.trim().split([',', '_', '\'', ' ']);
    let first = groups.next().unwrap_or_default();
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let joined = groups.try_fold(first.to_owned(), |all, group| {
        (group.len() == 3 && is_digits(group)).then(|| all + group)
    });
    if let Some(whole) = joined.and_then(|joined| joined.parse().ok()) {
        return Some(whole);
    }
    // A point before three digits may separate thousands.
    let fraction = text.split_once('.').map_or("", |(_, fraction)| fraction);
    let digits = fraction.bytes().take_while(u8::is_ascii_digit).count();
    let number = meant(text, unit).filter(|number| digits != 3 && number.fract() == 0.0)?;
    // Larger numbers are not exact.
    let is_exact = (0.0..=(1_u64 << 53) as f64).contains(&number);
    is_exact.then_some(number as u64)
}

/// Returns the unit at the end of the name of an option or a column, such as `--load-kg` or `accel_mps2`.
pub fn unit_of(name: &str) -> Option<&str> {
    let name = name.trim_matches(['<', '>']);
    name.rsplit_once(['-', '_']).map(|(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the fix of a refusal is another number than the user meant.
    #[test]
    fn a_number_is_proposed_only_if_it_is_clear() {
        for (text, unit, expected) in [
            ("80%", "%", Some(80.0)),
            ("80 percent", "%", Some(80.0)),
            ("10g", "g", Some(10.0)),
            ("1,5", "g", Some(1.5)),
            ("1,5 kg", "kg", Some(1.5)),
            ("20Hz", "hz", Some(20.0)),
            ("9.81m/s²", "mps2", Some(9.81)),
            ("1e3s", "s", Some(1000.0)),
            ("500g", "kg", None),
            ("500ms", "s", None),
            ("1,234", "g", None),
            ("infs", "s", None),
            ("0x10", "g", None),
            ("g", "g", None),
            ("", "g", None),
        ] {
            let found = meant(text, Some(unit));
            assert_eq!(found, expected, "{text} for {unit}");
        }
        for (text, expected) in [
            ("1e3", Some(1000)),
            ("1,000", Some(1000)),
            ("1_000_000", Some(1_000_000)),
            ("10.0", Some(10)),
            ("8080 port", Some(8080)),
            ("1.000", None),
            ("1.5", None),
            ("10k", None),
            ("1,5", None),
            ("-3", None),
            ("1e300", None),
        ] {
            let found = meant_whole(text, unit_of("--port"));
            assert_eq!(found, expected, "{text}");
        }
    }
}
