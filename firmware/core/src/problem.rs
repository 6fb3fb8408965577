//! Errors in settings, and their messages.

use core::fmt;

use cophase_motion::settings::{self as motion, Number};

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
    #[error(transparent)]
    Motion(motion::Problem),
    #[error(
        "cross-coupling is for servos that are all watched by encoders; give axes.drive = \"servo\" and axes.encoder = true, or leave it at 0"
    )]
    CouplingBlind,
    #[error(
        "this build of the controller has no setpoints for servo drives and no encoders; give drive = \"stepper\" or \"pulse-servo\" without \
         `encoder`, or build it with the feature `servo`"
    )]
    ServoNotBuilt,
    #[error(
        "proving the wiring moves cranks by up to {deg:.2}°, which a trim limit or the limits on tilt and warp do not allow; raise \
         axes.trim_limit_deg or the limits in [drift], lower drift.reading_error_deg, or let it be false"
    )]
    WiringPattern { deg: f64 },
    #[error(
        "a tick of 1/{0} s is not a whole number of microseconds; 500, 1000, 2000, 4000, 5000, 8000 and 10000 are among those that are"
    )]
    NotWholeMicroseconds(u32),
    #[error(
        "the axis would turn {turns_per_tick:.3} turns a tick at full speed; 0.5 is the most that an index pulse a turn can follow; raise control.tick_hz, or lower limits.speed_hz or the ratio"
    )]
    TooFastForTick { turns_per_tick: f64 },
    #[error(
        "at limits.speed_hz = {} rev/s the table and its trims move the axis at up to {speed_hz:.2} rev/s, and {max_hz:.2} rev/s is the most that \
         it can make; flatten the steepest part of the table, or lower limits.speed_hz or axes.steps_per_turn", Number(*master_hz)
    )]
    CamTooFast {
        master_hz: f64,
        speed_hz: f64,
        max_hz: f64,
    },
    #[error(
        "the table is too steep: up to {slope:.0} turns per turn of the master, and {bend:.0} turns per turn²; 1000 and 30000 are the most; \
         spread its rises over larger angles"
    )]
    CamTooSteep { slope: f64, bend: f64 },
    #[error(
        "makes {} steps per turn of the crank, outside {} to {}; give the turns of motor and crank that belong together, or change \
         axes.steps_per_turn", Number(*steps), Number(*low), Number(*high)
    )]
    StepsPerCrankTurn { steps: f64, low: f64, high: f64 },
    #[error(
        "the table jumps by {step_turns:.3} turns from its last point to the first of the next turn; did you mean net_turns = {meant}? if the axis \
         does come back there, give it more points on its way"
    )]
    CamJump { step_turns: f64, meant: i32 },
    #[error(
        "at limits.speed_hz = {} rev/s the table moves its axes at up to {speed_hz:.2} rev/s, the fastest after {from_deg:.1}° of the master, and \
         {} rev/s is their limit; flatten the table there, lower limits.speed_hz, or raise the limit to what the motors reach",
        Number(*master_hz), Number(*limit_hz)
    )]
    CamSpeed {
        master_hz: f64,
        speed_hz: f64,
        limit_hz: f64,
        from_deg: f64,
    },
    #[error(
        "at limits.speed_hz = {} rev/s the table accelerates its axes by up to {hz_per_s:.0} rev/s², and {} rev/s² is their limit; spread its rises \
         over larger angles, lower limits.speed_hz, or raise the limit to what the motors reach", Number(*master_hz), Number(*limit_hz_per_s)
    )]
    CamAcceleration {
        master_hz: f64,
        hz_per_s: f64,
        limit_hz_per_s: f64,
    },
    #[error("there is no table {table}; {tables} are given")]
    NoSuchCam { table: u8, tables: usize },
    #[error(
        "the axis does not pass its index once in each turn of the master, always in the same sense; give index = false, or a table that \
         rises everywhere, by one turn"
    )]
    IndexOnCam,
    #[error(
        "crank, coupler, ground and rocker (of length 1) are no crank-rocker: the crank with the longest link must be shorter than the other two \
         together; `cophase design crank-rocker` finds lengths"
    )]
    NotACrankRocker,
    #[error(
        "the pressure angle of this crank-rocker exceeds 70°, near which the linkage jams; `cophase design crank-rocker` finds lengths"
    )]
    Jams,
    #[error(
        "the rocker of these lengths accelerates by up to {curvature:.3} of the squared crank speed, outside {min} to {max}; \
         `cophase design crank-rocker` finds lengths"
    )]
    RockerCurvature { curvature: f64, min: f64, max: f64 },
    #[error(
        "the motors of this machine would need more than 30,000 N·m at full speed; lower limits.speed_hz, load_kg or crank_radius_mm"
    )]
    TorqueTooLarge,
    #[error(
        "the cranks of one platform make the master's own turns, or the platform tilts and its amplitude is not the program's; for a belt or \
         gearbox give gear = [motor turns, crank turns], and leave this out"
    )]
    NotInPhase,
    #[error(
        "the commanded phases alone tilt the platform by up to {tilt_mrad:.2} mrad in each turn, and drift.tilt_limit_mrad = {} allows less; give \
         all cranks the same phase and steps per turn, or set machine.allow_commanded_tilt = true if the platform is to tilt", Number(*limit_mrad)
    )]
    CommandedTilt { tilt_mrad: f64, limit_mrad: f64 },
    #[error(
        "the commanded phases alone set this crank {warp_deg:.2}° off the plane of all, and drift.warp_limit_deg = {} allows less; give all \
         cranks the same phase, or set machine.allow_commanded_tilt = true if the platform is to bend", Number(*limit_deg)
    )]
    CommandedWarp { warp_deg: f64, limit_deg: f64 },
    #[error("the segment takes no time at all; give it a ramp_s or a hold_s of at least one tick")]
    NoDuration,
    #[error(
        "{requested_mps2:.2} m/s² needs {needed_hz:.3} rev/s, over limits.speed_hz = {limit_hz}; {max_mps2:.2} m/s² is the most this machine reaches within it"
    )]
    LevelOutOfReach {
        requested_mps2: f64,
        needed_hz: f64,
        limit_hz: f64,
        max_mps2: f64,
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
    /// A value outside its range, ends included.
    pub const fn out_of_range(value: f64, low: f64, high: f64) -> Self {
        Self::Motion(motion::Problem::OutOfRange { value, low, high })
    }

    /// Value and range, if the problem is that the value lies outside.
    pub const fn range(self) -> Option<(f64, f64, f64)> {
        match self {
            Self::Motion(motion::Problem::OutOfRange { value, low, high }) => {
                Some((value, low, high))
            }
            _ => None,
        }
    }

    /// The unit that a key carries in its suffix; empty if it has none.
    pub fn unit(key: &str) -> &'static str {
        motion::Problem::unit(key)
    }

    /// Message for a setting: the text of the [`Problem`], with the unit of `key` after its numbers.
    pub fn of(self, key: &str) -> impl fmt::Display + use<> {
        Sentence {
            problem: self,
            unit: motion::Problem::unit(key),
        }
    }
}

struct Sentence {
    problem: Problem,
    unit: &'static str,
}

impl fmt::Display for Sentence {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.problem {
            Problem::Motion(problem) => problem.with_unit(self.unit).fmt(f),
            other => other.fmt(f),
        }
    }
}

impl From<motion::SettingsError> for SettingsError {
    fn from(error: motion::SettingsError) -> Self {
        Self {
            key: error.key,
            entry: error.entry,
            problem: Problem::Motion(error.problem),
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
        let problem = self.problem.of(self.key);
        match self.entry {
            Some(entry) => write!(f, "{} (number {entry}): {problem}", self.key),
            None => write!(f, "{}: {problem}", self.key),
        }
    }
}

impl core::error::Error for SettingsError {}
