//! What can be wrong with a setting.

use core::fmt;

/// A setting that cannot be used: its key, and why.
///
/// Keys are spelled as scene files spell them, in the same units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SettingsError {
    /// The setting, as a scene names it.
    pub key: &'static str,
    /// Which entry of a list of axes or bands, counted from 0.
    pub entry: Option<usize>,
    /// What is wrong, and what would be right.
    pub problem: Problem,
}

/// What is wrong with a setting.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "each variant's message says what it and its numbers mean"
)]
pub enum Problem {
    #[error("{value} is outside {low} to {high}")]
    OutOfRange { value: f64, low: f64, high: f64 },
    #[error("{0} is not a finite number; give one")]
    NotFinite(f64),
    #[error(
        "a tick of 1/{0} s is not a whole number of microseconds; 500, 1000, 2000, 4000, 5000, 8000 and 10000 are among those that are"
    )]
    NotWholeMicroseconds(u32),
    #[error(
        "reaching full speed would take {0:.0} s; with a higher acceleration or jerk it would take 600 s or less"
    )]
    RampTooLong(f64),
    #[error(
        "the band's upper edge ({1} rev/s) is not above its lower edge ({0} rev/s); swap or part them"
    )]
    BandUpsideDown(f64, f64),
    #[error(
        "the band begins at {0} rev/s, inside or below the band before it, which ends at {1} rev/s; list bands from the lowest up, apart from each other, or join them"
    )]
    BandsOverlap(f64, f64),
    #[error(
        "the band begins at {0} rev/s and so covers the creep speed, {1} rev/s, at which the machine aligns and parks; let it begin above that"
    )]
    BandCoversCreep(f64, f64),
    #[error(
        "the band ends at {0} rev/s, not below the speed limit, {1} rev/s, so that nothing above it could be reached; lower its upper edge, or lower limits.speed_hz to its lower edge and leave the band out"
    )]
    BandCoversTop(f64, f64),
    #[error(
        "at {speed_hz} rev/s an axis would need {rate_hz:.0} steps/s; at most {most_hz:.0} steps/s leave the pulse width and {edges} edges a tick; use fewer steps a turn, a lower limits.speed_hz, or a shorter pulse.width_ns"
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
        "the axis would turn {turns_per_tick:.3} turns a tick at full speed; 0.5 is the most that an index pulse a turn can follow; raise control.tick_hz, or lower limits.speed_hz or the ratio"
    )]
    TooFastForTick { turns_per_tick: f64 },
    #[error(
        "the motors of this machine would need more than 30,000 N·m at full speed; lower limits.speed_hz, load_kg or crank_radius_mm"
    )]
    TorqueTooLarge,
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
    pub const fn on_axis(mut self, entry: usize) -> Self {
        self.entry = Some(entry);
        self
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.entry {
            Some(entry) => write!(f, "{} (number {entry}): {}", self.key, self.problem),
            None => write!(f, "{}: {}", self.key, self.problem),
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
    finite(key, value)?;
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(SettingsError::new(
            key,
            Problem::OutOfRange { value, low, high },
        ))
    }
}
