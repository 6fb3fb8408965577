//! Checksum of the settings in use: a flipped bit of one shows within a round of ticks.
//!
//! The settings in use are the constants of a controller: what [`Controller::configure`] computed, and no tick changes. They are placed
//! among fields that every tick changes. So the loop checks them itself: each tick hashes one *slice*, of at most six words. A *part* has
//! slices of one kind, one for each axis or entry. A *round* passes all parts, and its sums must be those of the first round.
//!
//! Each type names its constants once. A type with state as well takes all of its fields apart for that, so that a new field does not
//! compile until it is named as one or the other.

use core::hash::{Hash, Hasher};

use super::Controller;
use crate::axes::MAX_CAMS;
use crate::mechanism::Mechanism;
use crate::units::Phase;

/// Sum of words: each is added by an exclusive or to the sum, which is then multiplied by an odd number.
///
/// Both steps can be undone. So a change of one word always changes the sum, and no later word can hide it. A word costs two instructions
/// and a load on the board, where a CRC by a table of 16 entries takes eight steps with a look-up each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Checksum(u32);

impl Checksum {
    const START: Self = Self(0);
    /// 2³² over the golden ratio, made odd: its bits have no pattern.
    const FACTOR: u32 = 0x9e37_79b9;
}

impl Hasher for Checksum {
    #[inline(always)]
    fn write_u32(&mut self, word: u32) {
        self.0 = (self.0 ^ word).wrapping_mul(Self::FACTOR);
    }

    #[inline(always)]
    fn write_u64(&mut self, number: u64) {
        self.write_u32(number as u32);
        self.write_u32((number >> 32) as u32);
    }

    #[inline(always)]
    fn write_u8(&mut self, number: u8) {
        self.write_u32(number.into());
    }

    #[inline(always)]
    fn write_u16(&mut self, number: u16) {
        self.write_u32(number.into());
    }

    #[inline(always)]
    fn write_usize(&mut self, number: usize) {
        if usize::BITS > u32::BITS {
            self.write_u64(number as u64);
        } else {
            self.write_u32(number as u32);
        }
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u8(byte));
    }

    fn finish(&self) -> u64 {
        self.0.into()
    }
}

/// Hashes slice `number` of a part. Returns none for the slice after the last.
type Part = fn(&Controller, usize, Checksum) -> Option<Checksum>;

/// Makes the table of parts. Each is a function with a name, as the board's linker chooses by it what runs from RAM.
macro_rules! parts {
    ($($name:ident: |$controller:ident, $number:ident, $sum:ident| $slice:expr,)*) => {
        $(fn $name($controller: &Controller, $number: usize, $sum: Checksum) -> Option<Checksum> {
            $slice
        })*

        /// Parts in the order in which they are checked: those of the program, and those of the settings.
        static PARTS: [Part; 39] = [$($name),*];
    };
}

parts! {
    levels: |c, i, sum| slice(sum, |sum| c.program.hash_slice(i, 0, sum)),
    holds: |c, i, sum| slice(sum, |sum| c.program.hash_slice(i, 1, sum)),
    ramp_parts: |c, i, sum| slice(sum, |sum| c.program.hash_slice(i, 2, sum)),
    ends: |c, i, sum| slice(sum, |sum| c.program.hash_end(i, sum)),
    lengths: |c, i, sum| single(i, sum, |sum| c.program.lengths().hash(sum)),
    machine: |c, i, sum| single(i, sum, |sum| c.hash_machine(0, sum)),
    mechanism: |c, i, sum| single(i, sum, |sum| c.hash_machine(1, sum)),
    linkage: |c, i, sum| single(i, sum, |sum| c.hash_machine(2, sum)),
    times: |c, i, sum| single(i, sum, |sum| c.hash_machine(3, sum)),
    correction: |c, i, sum| single(i, sum, |sum| c.hash_machine(4, sum)),
    sensed: |c, i, sum| single(i, sum, |sum| c.hash_machine(5, sum)),
    limits: |c, i, sum| single(i, sum, |sum| c.hash_machine(6, sum)),
    readings: |c, i, sum| single(i, sum, |sum| c.hash_machine(7, sum)),
    homing: |c, i, sum| single(i, sum, |sum| c.hash_machine(8, sum)),
    home: |c, i, sum| single(i, sum, |sum| c.hash_machine(9, sum)),
    coupling: |c, i, sum| single(i, sum, |sum| c.hash_machine(10, sum)),
    speeds: |c, i, sum| single(i, sum, |sum| c.shaft.limits().hash_speeds(sum)),
    ramps: |c, i, sum| slice(sum, |sum| c.shaft.limits().hash_ramp(i, 0, sum)),
    ramp_ends: |c, i, sum| slice(sum, |sum| c.shaft.limits().hash_ramp(i, 1, sum)),
    gains: |c, i, sum| slice(sum, |sum| c.shaft.limits().hash_ramp(i, 2, sum)),
    gain_scales: |c, i, sum| slice(sum, |sum| c.shaft.limits().hash_ramp(i, 3, sum)),
    bands: |c, i, sum| entry(c.shaft.limits().bands(), i, sum, |band, sum| band.hash(sum)),
    mount: |c, i, sum| slice(sum, |sum| c.monitor.config().mount.hash_axis(i, sum)),
    timing: |c, i, sum| entry(&c.channels, i, sum, |channel, sum| channel.hash_slice(0, sum)),
    fractions: |c, i, sum| entry(&c.channels, i, sum, |channel, sum| channel.hash_slice(1, sum)),
    followers: |c, i, sum| entry(&c.channels, i, sum, |channel, sum| channel.hash_slice(2, sum)),
    drives: |c, i, sum| entry(&c.channels, i, sum, |channel, sum| channel.hash_slice(3, sum)),
    flags: |c, i, sum| slice(sum, |sum| c.monitor.hash_axis(i, 0, sum)),
    tolerances: |c, i, sum| slice(sum, |sum| c.monitor.hash_axis(i, 1, sum)),
    distances: |c, i, sum| slice(sum, |sum| c.monitor.hash_axis(i, 2, sum)),
    encoders: |c, i, sum| slice(sum, |sum| c.monitor.hash_encoder(i, sum)),
    offset_limits: |c, i, sum| slice(sum, |sum| c.offsets.hash_axis(i, 0, sum)),
    offset_moves: |c, i, sum| slice(sum, |sum| c.offsets.hash_axis(i, 1, sum)),
    offset_slots: |c, i, sum| slice(sum, |sum| c.offsets.hash_axis(i, 2, sum)),
    patterns: |c, i, sum| slice(sum, |sum| c.homing.config().hash_axis(i, sum)),
    curve: |c, i, sum| single(i, sum, |sum| c.cams[0].hash_lengths(sum)),
    other_curve: |c, i, sum| single(i, sum, |sum| c.cams[1].hash_lengths(sum)),
    points: |c, i, sum| slice(sum, |sum| c.cams[0].hash_point(i, sum)),
    other_points: |c, i, sum| slice(sum, |sum| c.cams[1].hash_point(i, sum)),
}
const _: () = assert!(MAX_CAMS == 2, "a cam table has two parts");

/// Number of parts of the program.
const OF_PROGRAM: usize = 5;

/// Sum with a slice, if there is one.
#[inline(always)]
fn slice(mut sum: Checksum, hash: impl FnOnce(&mut Checksum) -> bool) -> Option<Checksum> {
    hash(&mut sum).then_some(sum)
}

/// Sum with the only slice of a part.
#[inline(always)]
fn single(number: usize, mut sum: Checksum, hash: impl FnOnce(&mut Checksum)) -> Option<Checksum> {
    if number != 0 {
        return None;
    }
    hash(&mut sum);
    Some(sum)
}

/// Sum with a slice of an entry. Beyond the capacity there are none, even if the number of entries is wrong.
#[inline(always)]
fn entry<T, const N: usize>(
    entries: &heapless::Vec<T, N>,
    number: usize,
    mut sum: Checksum,
    hash: impl FnOnce(&T, &mut Checksum),
) -> Option<Checksum> {
    let entry = entries.get(number).filter(|_| number < N)?;
    hash(entry, &mut sum);
    Some(sum)
}

/// Place in the round, and the sums.
#[derive(Clone, Debug)]
pub(super) struct SettingsCheck {
    part: usize,
    slice: usize,
    sum: Checksum,
    /// Sums of program and settings in the first round; none before.
    program: Option<Checksum>,
    settings: Option<Checksum>,
}

impl SettingsCheck {
    /// Check at the beginning of its first round.
    pub(super) const fn new() -> Self {
        Self {
            part: 0,
            slice: 0,
            sum: Checksum::START,
            program: None,
            settings: None,
        }
    }

    /// Takes over that the program was replaced.
    pub(super) const fn program_changed(&mut self) {
        self.program = None;
        if self.part < OF_PROGRAM {
            self.part = 0;
            self.slice = 0;
            self.sum = Checksum::START;
        }
    }

    /// Begins the next part. At the end of the program and of the settings, returns false if the sum is not that of the first round.
    #[inline(never)] // seldom
    fn end_part(&mut self) -> bool {
        self.slice = 0;
        self.part += 1;
        let first = if self.part == OF_PROGRAM {
            &mut self.program
        } else if self.part >= PARTS.len() {
            self.part = 0;
            &mut self.settings
        } else {
            return true;
        };
        let sum = core::mem::replace(&mut self.sum, Checksum::START);
        *first.get_or_insert(sum) == sum
    }
}

impl Controller {
    /// Checks the next slice of the settings in use. Returns false once they are not as they were when the controller was configured, or,
    /// for the program, when it was loaded. To be called once a tick.
    #[inline]
    pub fn check_settings(&mut self) -> bool {
        let SettingsCheck {
            part, slice, sum, ..
        } = self.check;
        let sum = PARTS.get(part).and_then(|part| part(self, slice, sum));
        let Some(sum) = sum else {
            return self.check.end_part();
        };
        self.check.slice += 1;
        // So that two changes of the highest bit, which the product leaves in its place, do not cancel each other.
        self.check.sum = Checksum(sum.0.rotate_left(u16::BITS));
        true
    }

    /// Makes the sums of the present settings those that each round must give.
    #[cold]
    pub(super) fn begin_check(&mut self) {
        self.check = SettingsCheck::new();
        while self.check.settings.is_none() {
            self.check_settings();
        }
    }

    /// Hashes a slice of what is common to all axes.
    #[inline(always)]
    fn hash_machine(&self, slice: usize, sum: &mut Checksum) {
        let Self {
            state: _,
            has_servos,
            followers,
            tick_hz,
            park_crank,
            amplitude,
            supervisor,
            shaft: _,
            step_rate,
            program: _,
            mechanism,
            channels,
            monitor,
            offsets,
            homing,
            cams: _,
            coupling,
            output: _,
            check: _,
        } = self;
        match slice {
            0 => (has_servos, followers, tick_hz, park_crank, channels.len()).hash(sum),
            1 | 2 => mechanism.hash_half(slice == 2, sum),
            3 => {
                supervisor.constants().hash(sum);
                (amplitude.step(), step_rate.tick_cycles()).hash(sum);
            }
            4 => offsets.hash_common(sum),
            5 => monitor.config().hash_common(sum),
            6 | 7 => monitor.config().limits.hash_half(slice == 7, sum),
            8 => homing.config().hash_common(sum),
            9 => {
                // Homing moves both by as much in opposite senses.
                let place = monitor.zero().wrapping_add(homing.home_offset());
                Phase::from_turns(place).within_turn().hash(sum);
            }
            _ => {
                if let Some(coupling) = coupling {
                    coupling.constants().hash(sum);
                }
            }
        }
    }
}
