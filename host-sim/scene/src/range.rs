//! Sentences about values out of their range: the range with its unit, its reason, and the fix.
//!
//! The fix is the nearer end of the range. A value may be in range in another unit that people use for the same quantity. It was
//! then probably meant in that unit, so the sentence converts it.

use core::f64::consts::TAU;

use cophase_core::problem::Problem;
use cophase_core::settings::key::{Key, Product};

use crate::digits::{hundredths, plain};
use crate::keys;
use crate::units::STANDARD_GRAVITY_MPS2;

/// Unit in which a value may have been meant, and its size in the unit of the key.
type Other = (&'static str, f64);

/// Other units of a quantity, by the end of a key; the first match counts.
const OTHERS: [(&str, &[Other]); 20] = [
    ("_hz_per_s2", &[("rad/s³", 1.0 / TAU)]),
    ("_hz_per_s", &[("rpm/s", 1.0 / 60.0), ("rad/s²", 1.0 / TAU)]),
    ("_deg_per_s", &[("rad/s", 360.0 / TAU), ("rpm", 6.0)]),
    ("_n_per_mm", &[("N/m", 1e-3)]),
    ("_n_per_um", &[("N/mm", 1e-3), ("N/m", 1e-6)]),
    ("tick_hz", &[("kHz", 1e3)]),
    ("_hz", &[("rpm", 1.0 / 60.0), ("rad/s", 1.0 / TAU)]),
    ("_nm", &[("N·mm", 1e-3)]),
    ("_kgm2", &[("kg·cm²", 1e-4), ("g·cm²", 1e-7)]),
    ("_kg", &[("g", 1e-3)]),
    ("_mps2", &[("g", STANDARD_GRAVITY_MPS2)]),
    ("_g", &[("m/s²", 1.0 / STANDARD_GRAVITY_MPS2)]),
    ("_mrad", &[("rad", 1e3), ("°", 1e3 * TAU / 360.0)]),
    ("_mm", &[("m", 1e3), ("µm", 1e-3)]),
    ("_ns", &[("µs", 1e3), ("ms", 1e6)]),
    ("_us", &[("ns", 1e-3), ("ms", 1e3), ("s", 1e6)]),
    ("_s", &[("ms", 1e-3), ("µs", 1e-6)]),
    ("zeta", &[("%", 0.01)]),
    ("feed_forward", &[("%", 0.01)]),
    ("_scale", &[("%", 0.01)]),
];

/// Least factor by which a value in another unit exceeds its range. A value closer to the limit was meant in the right unit.
const FAR: f64 = 2.0;

/// Returns the message for a key: the text of a problem and, for a value out of its range, the reason of the range and the fix.
pub fn sentence(key: &str, problem: Problem, reason: Option<&str>) -> String {
    let unit = Problem::unit(key);
    let Some((value, low, high)) = problem.range() else {
        return problem.of(key).to_string();
    };
    let reason = reason.map_or(String::new(), |reason| format!(", {reason}"));
    let fix = if value.is_finite() {
        format!("; give {}", instead(key, unit, value, (low, high)))
    } else {
        // The message already has the fix.
        String::new()
    };
    format!("{}{reason}{fix}", problem.of(key))
}

/// Returns the message for a number that is out of the range of its key; `number` has those of other keys.
pub(crate) fn outside_of(
    path: &str,
    key: &Key,
    value: f64,
    number: impl Fn(&str) -> Option<f64>,
) -> Option<String> {
    let (low, high) = key.ends(number);
    if key.is_open() || (low..=high).contains(&value) {
        return None;
    }
    // An end that is computed is written in few digits, inside the range so that the advised value is accepted.
    let shown = |end: f64, product: Option<Product>, is_own: bool, round: fn(f64) -> f64| {
        let is_computed = product.is_some_and(|product| product.factor.abs() != 1.0);
        if is_own || !is_computed {
            end
        } else {
            hundredths(end, round)
        }
    };
    let shown_low = shown(low, key.at_least, low == key.low, f64::ceil);
    let shown_high = shown(high, key.at_most, high == key.high, f64::floor);
    let problem = Problem::out_of_range(value, shown_low, shown_high);
    let by_others = match value > high {
        true => key.at_most.filter(|_| high != key.high),
        false => key.at_least.filter(|_| low != key.low),
    };
    let others = by_others.filter(|_| value.is_finite()).map(|product| {
        let wider = if value > high { 1.0 } else { -1.0 };
        [("raise", 1.0), ("lower", -1.0)]
            .map(|(word, sign)| {
                let moves = |power: i32| sign * wider * product.factor * f64::from(power) > 0.0;
                let keys = product.keys.iter().filter(|(_, power)| moves(*power));
                let keys: Vec<_> = keys.map(|&(key, _)| key).collect();
                match keys[..] {
                    [] => String::new(),
                    _ => format!(", or {word} {}", keys.join(" or ")),
                }
            })
            .concat()
    });
    let sentence = sentence(path, problem, key.reason);
    Some(format!("{sentence}{}", others.unwrap_or_default()))
}

/// Returns the fix for a finite value out of its range.
fn instead(key: &str, unit: &str, value: f64, (low, high): (f64, f64)) -> String {
    let with_unit = |value: f64| quantity(value, unit);
    let same_angle = (value - low).rem_euclid(360.0) + low;
    if unit == "°" && high - low == 360.0 {
        return format!("{}, the same angle", with_unit(same_angle));
    }
    let end = if value > high {
        format!("at most {}", with_unit(high))
    } else {
        format!("at least {}", with_unit(low))
    };
    format!("{end}{}", meant(key, unit, value, (low, high)))
}

/// Returns the value in other units in which it would be in range, such as ` (1200 rpm would be 20 rev/s)`; empty if there is none.
pub fn meant(key: &str, unit: &str, value: f64, (low, high): (f64, f64)) -> String {
    let is_far = value >= FAR * high || (0.0 < value && value <= low / FAR);
    let others = OTHERS.iter().find(|(end, _)| key.ends_with(end));
    let mut fitting: Vec<String> = others
        .filter(|_| is_far)
        .into_iter()
        .flat_map(|(_, others)| others.iter())
        .map(|&(other, size)| (other, value * size))
        .filter(|(_, converted)| (low..=high).contains(converted))
        .map(|(other, converted)| {
            format!(
                "{} would be {}",
                quantity(value, other),
                quantity(rounded(converted), unit)
            )
        })
        .collect();
    let is_inverse = key.ends_with("lambda") && (low..=high).contains(&value.recip());
    if is_inverse {
        let ratio = plain(rounded(value.recip()));
        fitting.push(format!(
            "λ is crank radius over rod length: a rod of {value} radii has {ratio}"
        ));
    }
    if fitting.is_empty() {
        return String::new();
    }
    format!(" ({})", fitting.join(", "))
}

/// Formats a number with four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Formats a number with its unit. Only the degree sign follows its number without a space.
fn quantity(value: f64, unit: &str) -> String {
    let gap = if unit.is_empty() || unit.starts_with('°') {
        ""
    } else {
        " "
    };
    // The last digits are rounding errors of conversions.
    let digits: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    format!("{}{gap}{unit}", plain(digits))
}

/// Returns the reason of a range that does not follow from the numbers.
pub(super) fn reason(key: &str) -> Option<&'static str> {
    keys::row(key)?.reason
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(key: &str, value: f64, low: f64, high: f64) -> String {
        sentence(key, Problem::out_of_range(value, low, high), None)
    }

    /// If this fails, a user who obeys the message gives a value that is wrong by that factor.
    #[test]
    fn the_fix_names_another_unit_that_fits() {
        for (key, value, range, fix) in [
            (
                "limits.speed_hz",
                1200.0,
                (0.1, 200.0),
                "at most 200 rev/s (1200 rpm would be 20 rev/s, 1200 rad/s would be 191 rev/s)",
            ),
            (
                "limits.speed_hz",
                3000.0,
                (0.1, 200.0),
                "at most 200 rev/s (3000 rpm would be 50 rev/s)",
            ),
            ("limits.speed_hz", 250.0, (0.1, 200.0), "at most 200 rev/s"),
            (
                "machine.mount_radius_mm",
                0.25,
                (10.0, 5000.0),
                "at least 10 mm (0.25 m would be 250 mm)",
            ),
            (
                "machine.load_kg",
                5000.0,
                (0.001, 50.0),
                "at most 50 kg (5000 g would be 5 kg)",
            ),
            ("machine.load_kg", 51.0, (0.001, 50.0), "at most 50 kg"),
            (
                "control.tick_hz",
                2.0,
                (500.0, 10_000.0),
                "at least 500 Hz (2 kHz would be 2000 Hz)",
            ),
            (
                "pulse.width_ns",
                2.5,
                (100.0, 50_000.0),
                "at least 100 ns (2.5 µs would be 2500 ns)",
            ),
            (
                "frame.suspension_zeta",
                5.0,
                (0.0, 2.0),
                "at most 2 (5 % would be 0.05)",
            ),
            (
                "axis[0].start_deg",
                400.0,
                (-180.0, 180.0),
                "40°, the same angle",
            ),
            (
                "control.park_deg",
                -90.0,
                (0.0, 360.0),
                "270°, the same angle",
            ),
            ("axes.trim_limit_deg", 90.0, (0.0, 36.0), "at most 36°"),
            ("machine.load_kg", -5.0, (0.001, 50.0), "at least 0.001 kg"),
            (
                "machine.lambda",
                4.0,
                (0.1, 0.6),
                "at most 0.6 (λ is crank radius over rod length: a rod of 4 radii has 0.25)",
            ),
        ] {
            let said = said(key, value, range.0, range.1);
            let (_, given) = said.split_once("; give ").unwrap();
            assert_eq!(given, fix, "{key}: {said}");
        }
    }

    #[test]
    fn the_reason_is_between_the_range_and_the_fix() {
        let problem = Problem::out_of_range(600.0, 0.1, 500.0);
        assert_eq!(
            sentence(
                "machine.crank_radius_mm",
                problem,
                reason("machine.crank_radius_mm")
            ),
            "600 mm is outside 0.1 to 500 mm, the cranks that a vibration platform is built with; give at most 500 mm"
        );
        assert_eq!(
            said("machine.load_kg", f64::NAN, 0.001, 50.0),
            "NaN is not a finite number; give one from 0.001 to 50 kg"
        );
    }
}
