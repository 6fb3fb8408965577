//! Ranges of the numbers that a design takes, and the error text for what lies outside.

use core::fmt;

use cophase_scene::digits::plain;
use cophase_scene::range::meant;

/// Range of a number on the command line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Flag that sets the number.
    pub flag: &'static str,
    /// Lower end.
    pub low: f64,
    /// True if the lower end itself is in the range.
    pub closed: bool,
    /// Upper end, which is in the range.
    pub high: f64,
    /// Unit, with a space before it.
    pub unit: &'static str,
    /// Name of the range, in a few words.
    pub meaning: &'static str,
    /// A value that works, for input that is not finite or lies below an open end.
    pub usual: f64,
}

impl Range {
    /// Range from above 0 up to `high`.
    #[must_use]
    pub const fn above_zero(
        flag: &'static str,
        high: f64,
        unit: &'static str,
        meaning: &'static str,
        usual: f64,
    ) -> Self {
        Self {
            flag,
            low: 0.0,
            closed: false,
            high,
            unit,
            meaning,
            usual,
        }
    }

    /// True if `value` is in range; NaN and infinities are not.
    #[must_use]
    pub fn admits(&self, value: f64) -> bool {
        value <= self.high && (value > self.low || (self.closed && value == self.low))
    }
}

/// A number out of its range.
///
/// Prints as `--lambda 0.7: outside 0.1 to 0.6, the crank/rod ratios this mechanism is built with; try 0.6`, and
/// with the value in another unit in which it would be in range. The nearer end is
/// suggested if it is in the range, otherwise a usual value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// The range.
    pub range: Range,
    /// The number as given.
    pub value: f64,
}

impl OutOfRange {
    /// All numbers that are out of their ranges, in order.
    pub fn find_all(numbers: impl IntoIterator<Item = (Range, f64)>) -> Vec<Self> {
        numbers
            .into_iter()
            .filter(|(range, value)| !range.admits(*value))
            .map(|(range, value)| Self { range, value })
            .collect()
    }

    /// Returns the error texts, one per line.
    pub fn lines(all: &[Self]) -> String {
        let lines: Vec<String> = all.iter().map(Self::to_string).collect();
        lines.join("\n")
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Range {
            flag,
            low,
            closed,
            high,
            unit,
            meaning,
            usual,
        } = self.range;
        let end = if closed {
            String::new()
        } else {
            format!(" ({low} itself excluded)")
        };
        let try_this = if !self.value.is_finite() {
            usual
        } else if self.value > high {
            high
        } else if closed {
            low
        } else {
            usual
        };
        let value = plain(self.value);
        // The name has the form of a key of a scene.
        let key = flag.trim_start_matches('-').replace('-', "_");
        let meant = meant(&key, unit.trim_start(), self.value, (low, high));
        write!(
            f,
            "{flag} {value}: outside {low} to {high}{unit}{end}, {meaning}; try {try_this}{meant}"
        )
    }
}
