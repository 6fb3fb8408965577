//! Checksum of the settings in use: a flipped bit of one shows within a round of ticks.
//!
//! The settings in use are the constants of a controller: what [`Controller::configure`] computed, and no tick changes. They are placed
//! among fields that every tick changes. So the loop checks them itself. Each tick hashes one *slice*, a few words of one *part*. At the
//! end of a part, the sum must be that of its first pass. A *round* passes all parts.
//!
//! Each type names its constants once. A type with state as well takes all of its fields apart for that, so that a new field does not
//! compile until it is named as one or the other.

use core::hash::{Hash, Hasher};

use super::Controller;
use crate::axes::MAX_CAMS;
use crate::units::MAX_AXES;

/// Parts in the order in which they are checked: whole machine, shaft, channels, drift monitor, phase offsets, homing, cam tables,
/// program.
const PARTS: usize = FIRST_CAM + MAX_CAMS + 1;
const FIRST_CAM: usize = 5;
const PROGRAM: usize = PARTS - 1;

/// Sum of words: each is added by an exclusive or to the rotated sum, which is then multiplied by an odd number.
///
/// All three steps can be undone. So a change of one word always changes the sum, and no later word can hide it. Other changes stay hidden
/// once in 2³². A word costs 3 instructions and a load on the board, where a CRC by a table of 16 entries costs some 40.
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
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(Self::FACTOR);
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

/// Place in the round, and the sums.
#[derive(Clone, Debug)]
pub(super) struct SettingsCheck {
    part: usize,
    slice: usize,
    sum: Checksum,
    /// Sum of each part in its first pass; none before.
    references: [Option<Checksum>; PARTS],
}

impl SettingsCheck {
    /// Check at the beginning of its first round.
    pub(super) const fn new() -> Self {
        Self {
            part: 0,
            slice: 0,
            sum: Checksum::START,
            references: [None; PARTS],
        }
    }

    /// Takes over that the program was replaced.
    pub(super) const fn program_changed(&mut self) {
        self.references[PROGRAM] = None;
        if self.part == PROGRAM {
            self.slice = 0;
            self.sum = Checksum::START;
        }
    }
}

impl Controller {
    /// Checks the next slice of the settings in use. Returns false at the end of a part that is not as it was when the controller was
    /// configured, or when the program was loaded.
    ///
    /// To be called once a tick.
    #[inline(never)]
    pub fn check_settings(&mut self) -> bool {
        let mut sum = self.check.sum;
        if self.hash_slice(self.check.part, self.check.slice, &mut sum) {
            self.check.sum = sum;
            self.check.slice += 1;
            return true;
        }
        self.end_part(sum)
    }

    /// Compares the sum of a part, and begins the next one.
    #[inline(never)]
    fn end_part(&mut self, sum: Checksum) -> bool {
        let check = &mut self.check;
        let reference = check.references.get_mut(check.part);
        check.slice = 0;
        check.sum = Checksum::START;
        check.part += 1;
        match reference {
            Some(reference) => *reference.get_or_insert(sum) == sum,
            None => {
                check.part = 0;
                true
            }
        }
    }

    /// Makes the sums of the present settings those that each round must give.
    #[cold]
    pub(super) fn begin_check(&mut self) {
        self.check = SettingsCheck::new();
        while self.check.part < PARTS {
            self.check_settings();
        }
    }

    /// Hashes a slice of a part. Returns false for the slice after the last.
    #[inline(always)]
    fn hash_slice(&self, part: usize, slice: usize, sum: &mut Checksum) -> bool {
        match part {
            0 => self.hash_machine(slice, sum),
            1 => self.shaft.limits().hash_slice(slice, sum),
            2..FIRST_CAM => self.hash_axis(part, slice, sum),
            PROGRAM => self.program.hash_slice(slice, sum),
            _ => {
                let cam = self.cams.get(part.wrapping_sub(FIRST_CAM));
                cam.is_some_and(|cam| cam.hash_slice(slice, sum))
            }
        }
    }

    /// Hashes a slice of a part that has four for each axis.
    #[inline(never)]
    fn hash_axis(&self, part: usize, slice: usize, sum: &mut Checksum) -> bool {
        let (axis, slice) = (slice >> 2, slice & 3);
        // Beyond their capacity there are none, even if their number is wrong.
        if axis >= MAX_AXES {
            return false;
        }
        match (part, slice) {
            (2, _) => {
                if let Some(channel) = self.channels.get(axis) {
                    channel.hash_slice(slice, sum);
                }
            }
            (3, _) => {
                let home_offset = self.homing.home_offset();
                self.drift.hash_axis(axis, slice, home_offset, sum);
            }
            (_, 0 | 1) => self.offsets.hash_half(axis, slice == 1, sum),
            (_, 2) => self.homing.hash_axis(axis, sum),
            _ => {}
        }
        true
    }

    /// Hashes a slice of what is common to all axes.
    #[inline(never)]
    fn hash_machine(&self, slice: usize, sum: &mut Checksum) -> bool {
        let Self {
            is_busy: _,
            busy_ticks: _,
            was_late: _,
            stop_input: _,
            has_servos,
            followers,
            apart: _,
            punctuality: _,
            tick_hz,
            motion: _,
            target: _,
            ticks: _,
            driven: _,
            end: _,
            park_crank,
            park: _,
            amplitude,
            supervisor,
            unpublished: _,
            overrun: _,
            shaft: _,
            step_rate,
            history: _,
            cursor: _,
            program: _,
            mechanism,
            channels,
            drift,
            offsets,
            correction: _,
            homing: _,
            hold: _,
            cams: _,
            coupling,
            output: _,
            check: _,
        } = self;
        match slice {
            0 => {
                (has_servos, followers, tick_hz, park_crank, channels.len()).hash(sum);
                (amplitude.step(), step_rate.tick_cycles()).hash(sum);
            }
            1 => mechanism.hash(sum),
            2 => {
                supervisor.constants().hash(sum);
                offsets.hash_common(sum);
            }
            3 => drift.hash_common(sum),
            4 => drift.limits().hash(sum),
            5 => {
                let coupling = coupling.as_ref().map(|coupling| coupling.constants());
                coupling.hash(sum);
            }
            _ => return false,
        }
        true
    }
}
