//! Numbers rounded to a count of decimals, for every format alike.

/// The double nearest to `value` rounded to `decimals` decimals, never a negative zero.
///
/// Its shortest decimal form has at most that many decimals. Where doubles are coarser than the resolution, it is `value`.
pub(super) fn rounded(value: f64, decimals: u32) -> f64 {
    const EXACT: f64 = 9_007_199_254_740_992.0; // 2^53
    // Powers of ten up to 1e9 are exact in f64, and a quotient of exact numbers is rounded once.
    let unit = 10_u64.pow(decimals) as f64;
    let scaled = (value * unit).round();
    if scaled.abs() < EXACT {
        scaled / unit + 0.0
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: f64, decimals: u32) -> String {
        rounded(value, decimals).to_string()
    }

    #[test]
    fn numbers_are_short_and_without_a_negative_zero() {
        assert_eq!(text(0.0, 9), "0");
        assert_eq!(text(-0.0, 9), "0");
        assert_eq!(text(-1e-12, 9), "0");
        assert_eq!(text(1e-9, 9), "0.000000001");
        assert_eq!(text(0.1 + 0.2, 9), "0.3");
        assert_eq!(text(-12.5, 4), "-12.5");
        assert_eq!(text(1_234.000_000_001, 9), "1234.000000001");
        assert_eq!(text(100.0, 0), "100");
    }

    #[test]
    fn numbers_coarser_than_the_resolution_stay() {
        assert_eq!(text(f64::NAN, 4), "NaN");
        assert_eq!(text(f64::INFINITY, 4), "inf");
        assert_eq!(text(f64::NEG_INFINITY, 4), "-inf");
        assert_eq!(text(1e15, 9), "1000000000000000");
        assert_eq!(text(123_456_789.5, 9), "123456789.5");
    }

    #[test]
    fn tick_times_are_exact_multiples_after_any_number_of_ticks() {
        // 2 kHz for eleven hours: the time in f64 is off by units in the last place, and the text is exact.
        for tick in [1_u64, 3, 7, 1_999, 7_200_001, 79_999_999] {
            let t_s = tick as f64 * 0.0005;
            let ten_thousandths = tick * 5;
            let expected = format!(
                "{}.{:04}",
                ten_thousandths / 10_000,
                ten_thousandths % 10_000
            );
            assert_eq!(
                text(t_s, 9),
                expected.trim_end_matches('0').trim_end_matches('.')
            );
        }
    }

    proptest! {
        /// Half a unit of the last place, plus one rounding in scaling (2^-53 of the value).
        #[test]
        fn numbers_read_back_within_half_the_last_place(value in -1e7_f64..1e7, decimals in 0_u32..=9) {
            let text = text(value, decimals);
            let back: f64 = text.parse().unwrap();
            let bound = 0.5 * 10_f64.powi(-(decimals as i32)) + value.abs() * f64::EPSILON;
            prop_assert!((back - value).abs() <= bound, "{value} became {back}");
        }

        /// If this fails, a column of turns prints digits without significance.
        #[test]
        fn numbers_have_at_most_the_column_decimals(value in -4e6_f64..4e6, decimals in 0_u32..=9) {
            let text = text(value, decimals);
            let found = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
            prop_assert!(found <= decimals as usize, "{value} became {text}");
        }
    }
}
