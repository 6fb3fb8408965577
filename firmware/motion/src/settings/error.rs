//! Errors in settings, and their messages.

use core::fmt;

/// A setting that cannot be used: its key, and the reason.
///
/// Keys are spelled as in scene files, and numbers have the same units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SettingsError {
    /// Key of the setting, as in a scene.
    pub key: &'static str,
    /// Index of the entry in a list of axes, bands or program entries, counted from 0.
    pub entry: Option<usize>,
    /// Problem, and how to solve it.
    pub problem: Problem,
}

/// Problem with a setting.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[allow(
    missing_docs,
    reason = "each variant's message says what it and its numbers mean"
)]
pub enum Problem {
    #[error("{}", Range { value: *value, low: *low, high: *high, unit: "" })]
    OutOfRange { value: f64, low: f64, high: f64 },
    #[error(
        "reaching full speed would take {ramp_s:.0} s, or {turns:.0} turns at that speed; with a higher acceleration or \
         jerk it would take 600 s and 30000 turns or less"
    )]
    RampTooLong { ramp_s: f64, turns: f64 },
    #[error(
        "at {speed_hz:.2} rev/s a motor would have {rate_hz:.0} counts/s; at most {max_hz:.0} counts/s can be counted at \
         this tick rate; give at most {max_steps} counts a turn, a lower limits.speed_hz, or a higher control.tick_hz"
    )]
    CountRate {
        speed_hz: f64,
        rate_hz: f64,
        max_hz: f64,
        max_steps: u32,
    },
    #[error(
        "the band's upper edge, {} rev/s, is not above its lower edge, {} rev/s; swap or part them", Number(*.1), Number(*.0)
    )]
    BandUpsideDown(f64, f64),
    #[error(
        "the band begins at {} rev/s, inside or below the band before it, which ends at {} rev/s; list bands from the lowest up, apart from each other, or join them", Number(*.0), Number(*.1)
    )]
    BandsOverlap(f64, f64),
    #[error(
        "the band begins at {} rev/s and so covers the homing speed, limits.homing_speed_hz = {}, at which the machine homes and parks; let it begin above that", Number(*.0), Number(*.1)
    )]
    BandCoversHomingSpeed(f64, f64),
    #[error(
        "the band ends at {} rev/s, not below limits.speed_hz = {}, so that nothing above it could be reached; lower its upper edge, or lower limits.speed_hz to its lower edge and leave the band out", Number(*.0), Number(*.1)
    )]
    BandCoversTop(f64, f64),
    #[error(
        "at {speed_hz:.2} rev/s a motor would need {rate_hz:.0} steps/s; at most {max_hz:.0} steps/s leave the pulse its width and fit the {edges} edges of a tick; give at most {} steps a turn, a lower limits.speed_hz, or a shorter pulse.width_ns", whole_microsteps(*max_hz / *speed_hz)
    )]
    StepRate {
        speed_hz: f64,
        rate_hz: f64,
        max_hz: f64,
        edges: u32,
    },
    #[error(
        "setting up a direction change takes {need_us:.2} µs, over a quarter of a tick ({max_us:.2} µs); shorten dir_setup_ns, dir_hold_ns or width_ns, or lower control.tick_hz"
    )]
    SetupTooLong { need_us: f64, max_us: f64 },
    #[error(
        "a tick of 1/{tick_hz} s must be {min} to {max} whole cycles of the step clock, which has {clock_hz} Hz; set the board's clock, or \
         change control.tick_hz"
    )]
    StepClock {
        clock_hz: u32,
        tick_hz: u32,
        min: u32,
        max: u32,
    },
}

impl Problem {
    /// Message for a setting: the text of the [`Problem`], with the unit of `key` behind its numbers.
    ///
    /// ```
    /// use cophase_motion::settings::Problem;
    /// let problem = Problem::OutOfRange { value: -5.0, low: 0.001, high: 50.0 };
    /// assert_eq!(problem.of("machine.load_kg").to_string(), "-5 kg is outside 0.001 to 50 kg");
    /// ```
    pub fn of(self, key: &str) -> impl fmt::Display + use<> {
        self.with_unit(Self::unit(key))
    }

    /// Message with a given unit behind its numbers.
    pub const fn with_unit(self, unit: &'static str) -> impl fmt::Display + use<> {
        Sentence {
            problem: self,
            unit,
        }
    }

    /// Unit in the suffix of a key, as it is written behind a number; empty if the key has none.
    ///
    /// Speeds of a shaft are in turns: `_hz` means rev/s, except in `tick_hz`.
    pub fn unit(key: &str) -> &'static str {
        UNITS
            .iter()
            .find(|(suffix, _)| key.ends_with(suffix))
            .map_or("", |&(_, unit)| unit)
    }
}

/// Suffixes of keys and their units; the first match counts.
const UNITS: [(&str, &str); 26] = [
    ("_hz_per_s2", "rev/s³"),
    ("_hz_per_s", "rev/s²"),
    ("_deg_per_s", "°/s"),
    ("_n_per_mm", "N/mm"),
    ("_n_per_um", "N/µm"),
    ("_ns_per_m", "N·s/m"),
    ("_mm_per_s", "mm/s"),
    ("_per_s2", "1/s²"),
    ("_per_s", "1/s"),
    ("_percent", "%"),
    ("_kn", "kN"),
    ("_n", "N"),
    ("_nms", "N·m·s"),
    ("_nm", "N·m"),
    ("tick_hz", "Hz"),
    ("_hz", "rev/s"),
    ("_kgm2", "kg·m²"),
    ("_kg", "kg"),
    ("_mps2", "m/s²"),
    ("_g", "g"),
    ("_mrad", "mrad"),
    ("_deg", "°"),
    ("_mm", "mm"),
    ("_ns", "ns"),
    ("_us", "µs"),
    ("_s", "s"),
];

struct Sentence {
    problem: Problem,
    unit: &'static str,
}

impl fmt::Display for Sentence {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.problem {
            Problem::OutOfRange { value, low, high } => Range {
                value,
                low,
                high,
                unit: self.unit,
            }
            .fmt(f),
            other => other.fmt(f),
        }
    }
}

struct Range {
    value: f64,
    low: f64,
    high: f64,
    unit: &'static str,
}

impl fmt::Display for Range {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high, unit) = (Number(self.low), Number(self.high), self.unit);
        // Only degrees follow their number without a space.
        let gap = if unit.is_empty() || unit.starts_with('°') {
            ""
        } else {
            " "
        };
        if self.value.is_finite() {
            let value = Number(self.value);
            write!(
                f,
                "{value}{gap}{unit} is outside {low} to {high}{gap}{unit}"
            )
        } else {
            let value = self.value;
            write!(
                f,
                "{value} is not a finite number; give one from {low} to {high}{gap}{unit}"
            )
        }
    }
}

/// Displays a number as a person would write it.
///
/// It has 12 digits, so that 500 is still 500 after conversion to turns and back. Below 1e-4 and from 1e9 up it has an
/// exponent.
pub struct Number(pub f64);

/// Returns the largest number of steps a turn that is whole microsteps of motors with 200 or 400 full steps.
fn whole_microsteps(max: f64) -> u32 {
    const FULL_STEPS: u32 = 400;
    match max as u32 {
        few @ 0..FULL_STEPS => few,
        max => max / FULL_STEPS * FULL_STEPS,
    }
}

impl fmt::Display for Number {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = rounded_to_12_digits(self.0);
        if rounded != 0.0 && !(1e-4..1e9).contains(&rounded.abs()) {
            write!(f, "{rounded:e}")
        } else {
            write!(f, "{rounded}")
        }
    }
}

/// Rounds to 12 decimal digits, from 1e-11 to 1e33: there the powers of ten are exact, so the result is the number that these digits
/// mean. Parsing the printed digits would do the same, with 18 kB of code.
#[cold]
fn rounded_to_12_digits(value: f64) -> f64 {
    let size = value.abs();
    if !(1e-11..1e33).contains(&size) {
        return value;
    }
    let mut power = 1.0;
    if size < 1e11 {
        while size * power < 1e11 {
            power *= 10.0;
        }
        libm::round(value * power) / power
    } else {
        while size / power >= 1e12 {
            power *= 10.0;
        }
        libm::round(value / power) * power
    }
}

impl SettingsError {
    /// An error about one setting.
    pub const fn new(key: &'static str, problem: Problem) -> Self {
        Self {
            key,
            entry: None,
            problem,
        }
    }

    /// Names the entry of a list to which this error belongs.
    #[must_use]
    pub const fn on_entry(mut self, entry: usize) -> Self {
        self.entry = Some(entry);
        self
    }
}

impl fmt::Display for SettingsError {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.entry {
            Some(entry) => write!(
                f,
                "{} (number {entry}): {}",
                self.key,
                self.problem.of(self.key)
            ),
            None => write!(f, "{}: {}", self.key, self.problem.of(self.key)),
        }
    }
}

impl core::error::Error for SettingsError {}

/// Returns a number that lies within its range, ends included.
///
/// # Errors
/// The number lies outside, or is not a number.
pub fn inside(key: &'static str, value: f64, low: f64, high: f64) -> Result<f64, SettingsError> {
    // This also refuses numbers that are not finite.
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(SettingsError::new(
            key,
            Problem::OutOfRange { value, low, high },
        ))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    fn said(key: &str, value: f64, low: f64, high: f64) -> std::string::String {
        Problem::OutOfRange { value, low, high }.of(key).to_string()
    }

    #[test]
    fn ranges_carry_the_unit_of_their_key() {
        for (key, expected) in [
            ("control.tick_hz", "7 Hz is outside 1 to 2 Hz"),
            ("limits.speed_hz", "7 rev/s is outside 1 to 2 rev/s"),
            (
                "limits.acceleration_hz_per_s",
                "7 rev/s² is outside 1 to 2 rev/s²",
            ),
            ("limits.jerk_hz_per_s2", "7 rev/s³ is outside 1 to 2 rev/s³"),
            ("axes.offset_deg", "7° is outside 1 to 2°"),
            ("axes.trim_rate_deg_per_s", "7°/s is outside 1 to 2°/s"),
            ("late[0].by_us", "7 µs is outside 1 to 2 µs"),
            ("machine.lambda", "7 is outside 1 to 2"),
        ] {
            assert_eq!(said(key, 7.0, 1.0, 2.0), expected);
        }
    }

    #[test]
    fn numbers_are_written_in_a_short_readable_form() {
        for (value, expected) in [
            (500.0 / 360.0 * 360.0, "500 mm is outside 0 to 1 mm"),
            (0.1 + 0.2, "0.3 mm is outside 0 to 1 mm"),
            (1e300, "1e300 mm is outside 0 to 1 mm"),
            (1e-300, "1e-300 mm is outside 0 to 1 mm"),
            (
                f64::NAN,
                "NaN is not a finite number; give one from 0 to 1 mm",
            ),
        ] {
            assert_eq!(said("x_mm", value, 0.0, 1.0), expected);
        }
    }

    /// If this fails, a message shows another number than the one that was set, or digits that nobody wrote.
    #[test]
    fn decimals_of_up_to_twelve_digits_are_shown_as_they_are() {
        let mut digits = 0x2545_F491_4F6C_DD1D_u64;
        for exponent in -22..=20 {
            for _ in 0..200 {
                digits = digits
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let written =
                    std::format!("{}e{exponent}", 100_000_000_000 + digits % 900_000_000_000);
                let value: f64 = written.parse().unwrap();
                let nearby = [
                    value,
                    value * (1.0 + f64::EPSILON),
                    value * (1.0 - f64::EPSILON),
                ];
                for off in nearby {
                    assert_eq!(
                        Number(off).to_string(),
                        Number(value).to_string(),
                        "{written}"
                    );
                    let shown: f64 = Number(off).to_string().parse().unwrap();
                    let expected: f64 = std::format!("{off:.11e}").parse().unwrap();
                    assert_eq!(shown, expected, "{written}");
                }
            }
        }
    }
}
