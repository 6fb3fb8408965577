//! Numbers as values of options. An error states the range.

use std::num::IntErrorKind;
use std::ops::RangeInclusive;

/// Returns a parser of a whole number in a range.
pub(crate) fn whole<N>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync + 'static
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
                if *to == u64::MAX && !is_too_large {
                    format!("give a whole number, {from} or more")
                } else {
                    format!("give a whole number, {from} to {to}")
                }
            })
    }
}

/// Parses a number that may have a fraction. The command checks its range with all other inputs.
pub(crate) fn number(text: &str) -> Result<f64, &'static str> {
    text.parse()
        .map_err(|_| "give a number without a unit, with a point for fractions, such as 12.5")
}
