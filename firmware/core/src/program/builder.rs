//! Builder of a checked [`Program`] from segments and repeats in seconds.

use super::{CAPACITY, Entry, Program, Segment, Shape};
use crate::mechanism::{AnyMechanism, Mechanism};
use crate::problem::{Problem, SettingsError};
use crate::units::{Amax, STANDARD_GRAVITY_MPS2, Turns};
use cophase_motion::settings::inside;
use cophase_motion::settings::key::{Key, optional};

/// Greatest level, m/s².
const MAX_AMAX_MPS2: f64 = 10_000.0;

/// `program.amax_g`, in tenths within the greatest level
pub const AMAX_G: Key = optional("3").from(
    0.0,
    (10.0 * MAX_AMAX_MPS2 / STANDARD_GRAVITY_MPS2) as u32 as f64 / 10.0,
);
/// `program.ramp_s`
pub const RAMP_S: Key = optional("4").from(0.0, 100_000.0);
/// `program.hold_s`
pub const HOLD_S: Key = optional("6").from(0.0, 1_000_000.0);
/// `program.repeat`
pub const REPEAT: Key = optional("2")
    .from(1.0, u16::MAX as f64)
    .because("the counts that a program holds");

/// Segment in physical units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct SegmentSettings {
    /// Level, m/s², from 0 up to the amplitude at the greatest speed of the shaft.
    pub amax_mps2: f64,
    /// Length of the ramp, seconds, in the range of [`RAMP_S`].
    pub ramp_s: f64,
    /// Time at the level, seconds, in the range of [`HOLD_S`].
    pub hold_s: f64,
    /// Shape of the ramp.
    pub shape: Shape,
}

/// Entry of a program in physical units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub enum EntrySettings {
    /// Ramp to a level and hold it.
    Segment(SegmentSettings),
    /// Play the entries from `first` up to here `times` times in total.
    Repeat {
        /// Index of the block's first entry, counted from 0; it is an earlier entry.
        first: u8,
        /// Number of passes, 1 to 65,535.
        times: u32,
    },
}

/// Builder of a program; entries are appended in the order of play.
///
/// ```
/// # use cophase_core::mechanism::{MechanismSettings, ScotchYokeSettings};
/// # use cophase_core::program::{Program, ProgramBuilder, SegmentSettings, Shape};
/// let mechanism = MechanismSettings::ScotchYoke(ScotchYokeSettings {}).mechanism(0.03, 2000);
/// let level = |amax_mps2| SegmentSettings { amax_mps2, ramp_s: 1.0, hold_s: 2.0, shape: Shape::Smooth };
/// let mut program = Program::new();
/// let mut builder = ProgramBuilder::new(2000, mechanism, 60.0, &mut program);
/// builder.segment(level(100.0)).unwrap();
/// let block = builder.here();
/// builder.segment(level(200.0)).unwrap();
/// builder.segment(level(50.0)).unwrap();
/// builder.repeat(block, 10).unwrap();
/// builder.finish().unwrap();
/// assert_eq!(program.duration(), (3 + 10 * 6) * 2000);
/// ```
#[derive(Debug)]
pub struct ProgramBuilder<'a> {
    tick_hz: u32,
    mechanism: AnyMechanism,
    speed_limit_hz: f64,
    program: &'a mut Program,
}

/// Length of the longest program: 10 years at 10 kHz, far below 64 bits of ticks.
const MAX_TICKS: u64 = 10_000 * 86_400 * 3_653;

impl<'a> ProgramBuilder<'a> {
    /// Empties a program and rebuilds it, for a machine with this tick rate (Hz), mechanism and greatest speed (rev/s).
    pub fn new(
        tick_hz: u32,
        mechanism: AnyMechanism,
        speed_limit_hz: f64,
        program: &'a mut Program,
    ) -> Self {
        program.clear();
        Self {
            tick_hz,
            mechanism,
            speed_limit_hz,
            program,
        }
    }

    /// Index of the next entry; [`Self::repeat`] takes it as the start of a block.
    pub fn here(&self) -> usize {
        self.program.entries.len()
    }

    /// Appends an entry.
    ///
    /// # Errors
    /// The errors of [`Self::segment`] and [`Self::repeat`].
    #[cold]
    pub fn entry(&mut self, entry: &EntrySettings) -> Result<(), SettingsError> {
        match *entry {
            EntrySettings::Segment(settings) => self.segment(settings),
            EntrySettings::Repeat { first, times } => self.repeat(usize::from(first), times),
        }
    }

    /// Appends a segment.
    ///
    /// # Errors
    /// A number is out of range, the greatest speed does not reach the level, the segment has no duration, or there are
    /// more than [`CAPACITY`] entries. The program is then unchanged.
    #[cold]
    pub fn segment(&mut self, settings: SegmentSettings) -> Result<(), SettingsError> {
        let amax_mps2 = settings.amax_mps2;
        inside("program.amax_mps2", amax_mps2, AMAX_G.low, MAX_AMAX_MPS2)?;
        let ramp_s = RAMP_S.check("program.ramp_s", settings.ramp_s)?;
        let hold_s = HOLD_S.check("program.hold_s", settings.hold_s)?;
        let level = Amax::from_num(amax_mps2);
        let needed = self.mechanism.speed(level);
        let limit_hz = self.speed_limit_hz;
        let limit = Turns::saturating_from_num(limit_hz / f64::from(self.tick_hz));
        if needed > limit {
            return Err(SettingsError::new(
                "program.amax_mps2",
                Problem::LevelOutOfReach {
                    requested_mps2: amax_mps2,
                    needed_hz: needed.to_num::<f64>() * f64::from(self.tick_hz),
                    limit_hz,
                    max_mps2: self.mechanism.amax(limit).to_num(),
                },
            ));
        }
        let ticks = |seconds: f64| libm::round(seconds * f64::from(self.tick_hz));
        let (ramp_ticks, hold_ticks) = (ticks(ramp_s) as u32, ticks(hold_s) as u64);
        let segment = Segment::new(level, ramp_ticks, hold_ticks, settings.shape);
        if segment.ticks() == 0 {
            return Err(SettingsError::new("program.ramp_s", Problem::NoDuration));
        }
        self.push(Entry::Segment(segment), segment.ticks())
    }

    /// Appends a repeat: the entries from `first` (see [`Self::here`]) up to here play `times` times in total.
    ///
    /// # Errors
    /// The block is empty, the count is not 1 to 65,535, the program is longer than ten years, or there are more than
    /// [`CAPACITY`] entries. The program is then unchanged.
    #[cold]
    pub fn repeat(&mut self, first: usize, times: u32) -> Result<(), SettingsError> {
        REPEAT.check("program.repeat", f64::from(times))?;
        if first >= self.here() {
            return Err(SettingsError::new("program.segments", Problem::RepeatEmpty));
        }
        let once = self.program.duration() - self.program.start(first);
        let more = once * u64::from(times - 1);
        self.push(
            Entry::Repeat {
                first: first as u8,
                times: times as u16,
            },
            more,
        )
    }

    #[cold]
    fn push(&mut self, entry: Entry, ticks: u64) -> Result<(), SettingsError> {
        let end = self.program.duration() + ticks;
        if end > MAX_TICKS {
            return Err(SettingsError::new(
                "program.repeat",
                Problem::ProgramEndless,
            ));
        }
        let full = SettingsError::new(
            "program",
            Problem::ProgramTooLong(self.here() + 1, CAPACITY),
        );
        self.program.entries.push(entry).map_err(|_| full)?;
        self.program.ends.push(end).map_err(|_| full)
    }

    /// Finishes the program.
    ///
    /// # Errors
    /// The program has no entries.
    pub fn finish(self) -> Result<(), SettingsError> {
        if self.program.entries.is_empty() {
            return Err(SettingsError::new("program", Problem::ProgramEmpty));
        }
        Ok(())
    }
}
