//! Numbers for readers: no more digits than are significant, and no long rows of zeros.

/// A number as it was given, in the shortest form that reads back the same. It has an exponent if it
/// would otherwise be longer than a column.
pub fn plain(value: f64) -> String {
    let size = value.abs();
    if value.is_finite() && size > 0.0 && !(1e-4..1e7).contains(&size) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// A computed number to four significant digits. The load, which the user has weighed, has no
/// more.
pub fn four(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() {
        return format!("{value}");
    }
    if !(1e-4..1e7).contains(&size) {
        return format!("{value:.3e}");
    }
    // Rounded first, so that 9.9996 counts as 10.00 and not as 10.000.
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let decimals = (1..=7).rev().find(|d| rounded.abs() < 10_f64.powi(4 - d));
    format!(
        "{rounded:.*}",
        usize::try_from(decimals.unwrap_or(0)).unwrap_or(0)
    )
}

/// An angle in rad, in degrees to a tenth.
pub fn degrees(angle_rad: f64) -> String {
    format!("{:.1}", angle_rad.to_degrees())
}

/// A fraction in percent: to a tenth, or to two significant digits where that is finer.
pub fn percent(fraction: f64) -> String {
    let value = 100.0 * fraction;
    let decimals = match value.abs() {
        size if size < 0.1 => 3,
        size if size < 1.0 => 2,
        _ => 1,
    };
    format!("{value:.decimals$} %")
}

/// Rounds to hundredths, or to three digits if that is finer.
pub(crate) fn hundredths(value: f64, round: impl Fn(f64) -> f64) -> f64 {
    let digits = (2.0 - value.abs().max(1e-12).log10().floor()).max(2.0);
    let scale = 10_f64.powf(digits);
    round(value * scale) / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the report shows digits without significance, or hides significant ones.
    #[test]
    fn numbers_have_four_significant_digits() {
        let cases = [
            (4.605_508, "4.606"),
            (46.055_08, "46.06"),
            (228.724_8, "228.7"),
            (9.999_96, "10.00"),
            (141_731.5, "141700"),
            (-53.51, "-53.51"),
            (0.145_4, "0.1454"),
            (0.0, "0"),
            (1.234_56e-9, "1.235e-9"),
        ];
        for (value, shown) in cases {
            assert_eq!(four(value), shown);
        }
        assert_eq!(percent(0.000_46), "0.046 %");
        assert_eq!(percent(0.051_6), "5.2 %");
        assert_eq!(plain(0.1), "0.1");
        assert_eq!(plain(1e300), "1e300");
        assert_eq!(plain(f64::NAN), "NaN");
    }
}
