//! What can be wrong with a setting.

use core::fmt;

/// A setting that cannot be used: its key, and why.
///
/// Keys are spelled as scene files spell them, in the same units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SettingsError {
    /// The setting, as a scene names it.
    pub key: &'static str,
    /// Which entry of the list of axes, bands or program entries, counted from 0.
    pub entry: Option<usize>,
    /// What is wrong, and what would be right.
    pub problem: Problem,
}

/// What is wrong with a setting.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[allow(
    missing_docs,
    reason = "each variant's message says what it and its numbers mean"
)]
pub enum Problem {
    #[error("{}", Range { value: *value, low: *low, high: *high, unit: "" })]
    OutOfRange { value: f64, low: f64, high: f64 },
    #[error("{0} is not a finite number; give one")]
    NotFinite(f64),
    #[error(
        "cross-coupling is for servos that are all watched by encoders; give axes.drive = \"servo\" and axes.encoder = true, or leave it at 0"
    )]
    CouplingBlind,
    #[error(
        "proving the wiring moves cranks by up to {deg:.2}°, which a trim limit or the limits on tilt and warp do not allow; raise \
         axes.trim_limit_deg or the limits in [drift], lower drift.reading_deg, or let it be false"
    )]
    WiringPattern { deg: f64 },
    #[error(
        "a tick of 1/{0} s is not a whole number of microseconds; 500, 1000, 2000, 4000, 5000, 8000 and 10000 are among those that are"
    )]
    NotWholeMicroseconds(u32),
    #[error(
        "reaching full speed would take {ramp_s:.0} s, or {turns:.0} turns at that speed; with a higher acceleration or \
         jerk it would take 600 s and 30000 turns or less"
    )]
    RampTooLong { ramp_s: f64, turns: f64 },
    #[error(
        "at {speed_hz:.2} rev/s an axis would have {rate_hz:.0} counts/s; at most {most_hz:.0} counts/s can be counted at \
         this tick rate; give at most {most_steps} counts a turn, a lower limits.speed_hz, or a higher control.tick_hz"
    )]
    CountRate {
        speed_hz: f64,
        rate_hz: f64,
        most_hz: f64,
        most_steps: u32,
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
        "the band begins at {} rev/s and so covers the creep speed, limits.creep_hz = {}, at which the machine aligns and parks; let it begin above that", Number(*.0), Number(*.1)
    )]
    BandCoversCreep(f64, f64),
    #[error(
        "the band ends at {} rev/s, not below limits.speed_hz = {}, so that nothing above it could be reached; lower its upper edge, or lower limits.speed_hz to its lower edge and leave the band out", Number(*.0), Number(*.1)
    )]
    BandCoversTop(f64, f64),
    #[error(
        "at {speed_hz:.2} rev/s an axis would need {rate_hz:.0} steps/s; at most {most_hz:.0} steps/s leave the pulse its width and fit the {edges} edges of a tick; give at most {} steps a turn, a lower limits.speed_hz, or a shorter pulse.width_ns", (*most_hz / *speed_hz) as u32
    )]
    StepRate {
        speed_hz: f64,
        rate_hz: f64,
        most_hz: f64,
        edges: u32,
    },
    #[error(
        "setting up a direction change takes {need_us:.2} µs, over a quarter of a tick ({most_us:.2} µs); shorten dir_setup_ns, dir_hold_ns or width_ns, or lower control.tick_hz"
    )]
    SetupTooLong { need_us: f64, most_us: f64 },
    #[error(
        "{} µs is over a quarter of a tick, {} µs, so that a pulse could be known only two ticks later; shorten it, or lower control.tick_hz", Number(*width_us), Number(*most_us)
    )]
    IndexTooLong { width_us: f64, most_us: f64 },
    #[error(
        "the axis would turn {turns_per_tick:.3} turns a tick at full speed; 0.5 is the most that an index pulse a turn can follow; raise control.tick_hz, or lower limits.speed_hz or the ratio"
    )]
    TooFastForTick { turns_per_tick: f64 },
    #[error(
        "the motors of this machine would need more than 30,000 N·m at full speed; lower limits.speed_hz, load_kg or crank_radius_mm"
    )]
    TorqueTooLarge,
    #[error(
        "{}° is outside -{} to {}°; trim less, or raise axes.trim_limit_deg", Number(*trim_deg), Number(*limit_deg), Number(*limit_deg)
    )]
    TrimPastLimit { trim_deg: f64, limit_deg: f64 },
    #[error("the segment takes no time at all; give it a ramp_s or a hold_s of at least one tick")]
    NoDuration,
    #[error(
        "{asked_mps2:.2} m/s² needs {needed_hz:.3} rev/s, over limits.speed_hz = {limit_hz}; {most_mps2:.2} m/s² is the most this machine reaches within it"
    )]
    LevelOutOfReach {
        asked_mps2: f64,
        needed_hz: f64,
        limit_hz: f64,
        most_mps2: f64,
    },
    #[error(
        "{0} entries, repeats included, are more than the {1} that a program holds; use repeat blocks, or merge segments"
    )]
    ProgramTooLong(usize, usize),
    #[error("the program has no segments; give at least one")]
    ProgramEmpty,
    #[error("the repeat block is empty; put at least one segment before its end")]
    RepeatEmpty,
    #[error("the program would run for more than 10 years; use fewer repeats")]
    ProgramEndless,
}

impl Problem {
    /// The message for a setting: as [`Problem`] alone has it, but numbers carry the unit of `key`.
    ///
    /// ```
    /// use cophase_core::settings::Problem;
    /// let problem = Problem::OutOfRange { value: -5.0, low: 0.001, high: 50.0 };
    /// assert_eq!(problem.of("machine.load_kg").to_string(), "-5 kg is outside 0.001 to 50 kg");
    /// ```
    pub fn of(self, key: &str) -> impl fmt::Display + use<> {
        Sentence {
            problem: self,
            unit: Self::unit(key),
        }
    }

    /// The unit that a key carries in its suffix, as it is written behind a number; empty if it has none.
    ///
    /// Speeds of a shaft are in turns: `_hz` is rev/s, but for `tick_hz`.
    pub fn unit(key: &str) -> &'static str {
        UNITS
            .iter()
            .find(|(suffix, _)| key.ends_with(suffix))
            .map_or("", |&(_, unit)| unit)
    }
}

/// Suffix of a key, and its unit; the first that fits counts.
const UNITS: [(&str, &str); 21] = [
    ("_hz_per_s2", "rev/s³"),
    ("_hz_per_s", "rev/s²"),
    ("_deg_per_s", "°/s"),
    ("_n_per_mm", "N/mm"),
    ("_n_per_um", "N/µm"),
    ("_ns_per_m", "N·s/m"),
    ("_per_s", "1/s"),
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
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high, unit) = (Number(self.low), Number(self.high), self.unit);
        // Degrees alone stand close to their number.
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

/// A number as a person would write it: to 12 digits, so that 500 that went through turns and back is
/// still 500, and with an exponent where it would be a row of zeros.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use fmt::Write;
        let mut digits = heapless::String::<32>::new();
        let rounded = match write!(digits, "{:.11e}", self.0) {
            Ok(()) => digits.parse().unwrap_or(self.0),
            Err(_) => self.0,
        };
        if rounded != 0.0 && !(1e-4..1e9).contains(&rounded.abs()) {
            write!(f, "{rounded:e}")
        } else {
            write!(f, "{rounded}")
        }
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

    /// The same, said of one entry of a list.
    #[must_use]
    pub const fn on_entry(mut self, entry: usize) -> Self {
        self.entry = Some(entry);
        self
    }
}

impl fmt::Display for SettingsError {
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

/// Passes a finite number on.
pub(crate) fn finite(key: &'static str, value: f64) -> Result<f64, SettingsError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(SettingsError::new(key, Problem::NotFinite(value)))
    }
}

/// Passes a number on that lies within its range, ends included.
pub(crate) fn inside(
    key: &'static str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<f64, SettingsError> {
    // Also refuses what is not finite.
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
    fn numbers_are_written_as_a_person_would() {
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
}
