//! Ranges of axes, and the unit of the time axis.

use super::envelope::Extent;

/// Time axis: its range and unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeAxis {
    /// Left and right end, in `unit`.
    pub from: f64,
    /// See `from`.
    pub to: f64,
    /// Size of one second in `unit`.
    pub per_second: f64,
    /// `ms`, `s`, `min` or `h`.
    pub unit: &'static str,
}

impl TimeAxis {
    /// Creates the axis of a run between two times in seconds. Without times, it has a default range.
    pub fn new(span: Option<(f64, f64)>) -> Self {
        let (from_s, mut to_s) = span.unwrap_or((0.0, 1.0));
        // A single row, or times that do not increase, still need a width that f64 can represent at that time.
        let min = 1e-3_f64.max(from_s.abs() * 1e-9);
        if to_s - from_s < min {
            to_s = from_s + min;
        }
        let (per_second, unit) = match to_s - from_s {
            length if length < 0.5 => (1e3, "ms"),
            length if length <= 600.0 => (1.0, "s"),
            length if length <= 4.0 * 3600.0 => (1.0 / 60.0, "min"),
            _ => (1.0 / 3600.0, "h"),
        };
        Self {
            from: from_s * per_second,
            to: to_s * per_second,
            per_second,
            unit,
        }
    }

    /// Returns the position of a time between the ends, from 0 (left) to 1 (right).
    pub fn fraction(&self, t_s: f64) -> f64 {
        ((t_s * self.per_second - self.from) / (self.to - self.from)).clamp(0.0, 1.0)
    }
}

/// Returns the range of a value axis: the data with a margin, and at least `min` on both sides of the middle of the data.
///
/// Without data it is `-min..min`. The result is finite, and its low end is below its high end.
pub fn padded(data: Extent, min: f64) -> (f64, f64) {
    let data = if data.is_empty() {
        Extent {
            low: 0.0,
            high: 0.0,
        }
    } else {
        data
    };
    let middle = data.low / 2.0 + data.high / 2.0;
    let half = (data.high / 2.0 - data.low / 2.0)
        .max(min)
        .max(middle.abs() * 1e-9);
    (middle - 1.08 * half, middle + 1.08 * half)
}

/// Returns true if a limit is near enough to the data to be drawn. A distant limit would flatten the curves; the legend states
/// it instead.
pub fn is_in_sight(limit: f64, peak: f64) -> bool {
    peak >= 0.2 * limit
}

/// Formats a number for a legend: three significant digits, without an exponent for usual values.
pub fn short(value: f64) -> String {
    let magnitude = value.abs();
    let decimals = match magnitude {
        m if m >= 100.0 || m == 0.0 => 0,
        m if m >= 10.0 => 1,
        m if m >= 1.0 => 2,
        m if m >= 0.001 => 3,
        _ => return format!("{value:.0e}"),
    };
    format!("{value:.decimals$}")
}

/// Formats a number as it was given, for bands and limits.
pub fn plain(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_always_has_a_width() {
        for span in [
            None,
            Some((0.0, 0.0)),
            Some((5.0, 4.0)),
            Some((1e9, 1e9)),
            Some((0.0, 1e9)),
        ] {
            let axis = TimeAxis::new(span);
            assert!(axis.to > axis.from, "{span:?} gave {axis:?}");
            assert!(axis.fraction(f64::MAX) <= 1.0);
        }
        for (low, high) in [(0.0, 0.0), (1e12, 1e12), (-1.0, 3.0), (-1e308, 1e308)] {
            let (from, to) = padded(Extent { low, high }, 0.1);
            assert!(
                from < low && high < to && from.is_finite() && to.is_finite(),
                "{low}..{high}"
            );
        }
        let (from, to) = padded(Extent::EMPTY, 0.1);
        assert!(
            from <= -0.1 && 0.1 <= to,
            "flat zero needs +-0.1, got {from}..{to}"
        );
    }

    #[test]
    fn the_time_axis_selects_a_unit_by_its_length() {
        let unit = |length| TimeAxis::new(Some((0.0, length))).unit;
        assert_eq!(
            [0.2, 60.0, 3600.0, 86_400.0].map(unit),
            ["ms", "s", "min", "h"]
        );
    }

    #[test]
    fn legend_numbers_are_short() {
        let texts = [0.0, 0.0126, 0.5, 7.2, 21.6, 981.3, 0.0004].map(short);
        assert_eq!(
            texts,
            ["0", "0.013", "0.500", "7.20", "21.6", "981", "4e-4"]
        );
    }
}
