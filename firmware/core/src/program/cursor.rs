//! Cursor: reads a program tick by tick, from any tick on.

use super::{CAPACITY, Entry, Program, Segment};
use crate::units::Amax;

/// Levels of a program for one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Level at the end of the tick.
    pub level: Amax,
    /// Level at the end of the present segment; until then amax stays between the two.
    pub end_level: Amax,
}

/// Position in a program. It does not borrow the program: the two are kept side by side.
#[derive(Clone, Debug)]
pub struct Cursor {
    /// Index of the entry being played; the number of entries when done.
    index: usize,
    /// Ticks of the present segment that are over.
    tick: u64,
    /// Level from which the present segment started.
    from: Amax,
    /// Finished passes of each repeat.
    passes: [u16; CAPACITY],
    /// Ticks of the program that are over.
    elapsed: u64,
}

impl Cursor {
    /// Cursor before the first tick of a program, at level 0.
    pub const fn new() -> Self {
        Self {
            index: 0,
            tick: 0,
            from: Amax::ZERO,
            passes: [0; CAPACITY],
            elapsed: 0,
        }
    }

    /// Plays one tick. After the end it returns the last level.
    ///
    /// The cost is the same at any time: it reads one segment, and at the end of a segment only the repeats that end
    /// there.
    pub fn next(&mut self, program: &Program) -> Reading {
        let Some(segment) = self.segment(program) else {
            return Reading {
                level: self.from,
                end_level: self.from,
            };
        };
        self.tick += 1;
        self.elapsed += 1;
        let level = segment.level_at(self.tick, self.from);
        if self.tick >= segment.ticks() {
            self.enter(program, self.index + 1, segment.level);
        }
        Reading {
            level,
            end_level: segment.level,
        }
    }

    /// Moves to the position after `elapsed` ticks, or to the end if that is earlier.
    ///
    /// The cost is one access to each entry for each level of nesting, not for each pass.
    pub fn seek(&mut self, program: &Program, elapsed: u64) {
        *self = Self::new();
        self.elapsed = elapsed.min(program.duration());
        // Remaining time, counted from the start of the searched block in its first pass.
        let mut until = self.elapsed;
        let mut index = 0;
        while let (Some(entry), Some(&end)) = (program.entries.get(index), program.ends.get(index))
        {
            if until >= end {
                if let Entry::Segment(segment) = entry {
                    self.from = segment.level;
                }
                index += 1;
                continue;
            }
            let start = program.start(index);
            match *entry {
                Entry::Segment(_) => {
                    self.index = index;
                    self.tick = until - start;
                    return;
                }
                Entry::Repeat { first, .. } => {
                    // The time is inside a later pass; fold it back into the first pass of the block.
                    let block_start = program.start(usize::from(first));
                    let once = start - block_start;
                    let into = until - start;
                    if let Some(passes) = self.passes.get_mut(index) {
                        *passes = (into / once) as u16 + 1;
                    }
                    until = block_start + into % once;
                    index = usize::from(first);
                }
            }
        }
        self.index = index;
    }

    /// Ticks of the program that are over.
    pub const fn elapsed(&self) -> u64 {
        self.elapsed
    }

    /// Remaining ticks, repeats included.
    pub fn remaining(&self, program: &Program) -> u64 {
        program.duration().saturating_sub(self.elapsed)
    }

    /// True when the program is over.
    pub fn is_done(&self, program: &Program) -> bool {
        self.index >= program.entries.len()
    }

    fn segment<'a>(&self, program: &'a Program) -> Option<&'a Segment> {
        match program.entries.get(self.index) {
            Some(Entry::Segment(segment)) => Some(segment),
            _ => None,
        }
    }

    /// Moves to entry `index` and follows repeats up to a segment or the end.
    #[inline(never)] // once a segment
    fn enter(&mut self, program: &Program, mut index: usize, from: Amax) {
        self.from = from;
        self.tick = 0;
        while let Some(&Entry::Repeat { first, times }) = program.entries.get(index) {
            let Some(passes) = self.passes.get_mut(index) else {
                break;
            };
            *passes += 1;
            if *passes < times {
                index = usize::from(first);
            } else {
                *passes = 0; // An outer repeat may play it again.
                index += 1;
            }
        }
        self.index = index;
    }
}

impl Default for Cursor {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ProgramBuilder, SegmentSettings, Shape};
    use super::*;
    use crate::mechanism::{MechanismSettings, ScotchYokeSettings};
    use proptest::prelude::*;
    use std::vec::Vec;

    fn builder(program: &mut Program) -> ProgramBuilder<'_> {
        let yoke = MechanismSettings::ScotchYoke(ScotchYokeSettings {});
        ProgramBuilder::new(1000, yoke.mechanism(0.03, 1000), 100.0, program)
    }

    fn segment(level: u32, ramp_ticks: u32, hold_ticks: u32) -> SegmentSettings {
        SegmentSettings {
            amax_mps2: f64::from(level),
            ramp_s: f64::from(ramp_ticks) / 1000.0,
            hold_s: f64::from(hold_ticks) / 1000.0,
            shape: Shape::Linear,
        }
    }

    /// A program with repeats plays as the same program written out by hand.
    #[test]
    fn repeats_play_as_if_written_out() {
        let (a, b, c) = (segment(10, 3, 2), segment(20, 2, 0), segment(5, 0, 4));
        let (mut short_program, mut long_program) = (Program::new(), Program::new());
        let mut short = builder(&mut short_program);
        short.segment(a).unwrap();
        let outer = short.here();
        short.segment(b).unwrap();
        let inner = short.here();
        short.segment(c).unwrap();
        short.segment(a).unwrap();
        short.repeat(inner, 2).unwrap();
        short.repeat(outer, 3).unwrap();
        short.segment(c).unwrap();
        let mut long = builder(&mut long_program);
        long.segment(a).unwrap();
        for _ in 0..3 {
            long.segment(b).unwrap();
            for _ in 0..2 {
                long.segment(c).unwrap();
                long.segment(a).unwrap();
            }
        }
        long.segment(c).unwrap();
        short.finish().unwrap();
        long.finish().unwrap();
        let (short, long) = (short_program, long_program);
        assert_eq!(short.duration(), long.duration());
        let (mut one, mut other) = (Cursor::new(), Cursor::new());
        while !other.is_done(&long) {
            assert_eq!(
                one.next(&short),
                other.next(&long),
                "tick {}",
                other.elapsed()
            );
            assert_eq!(one.remaining(&short), other.remaining(&long));
        }
        assert!(one.is_done(&short));
    }

    proptest! {
        /// Seeking to a tick is the same as playing up to it, for any nesting of repeats.
        #[test]
        fn seek_agrees_with_playing(
            entries in prop::collection::vec((0_u32..4, 0_u32..100, 0_u32..6, 0_u32..6, any::<u8>()), 1..24),
            at in any::<prop::sample::Index>(),
        ) {
            let mut program = Program::new();
            let mut builder = builder(&mut program);
            let mut open = Vec::new();
            builder.segment(segment(1, 1, 0)).unwrap();
            for (kind, level, ramp, hold, times) in entries {
                match kind {
                    0 => open.push(builder.here()),
                    1 => if let Some(first) = open.pop() && first < builder.here() {
                        builder.repeat(first, u32::from(times) % 4 + 1).unwrap();
                    },
                    _ => builder.segment(segment(level, ramp, hold.max(u32::from(ramp == 0)))).unwrap(),
                }
            }
            builder.finish().unwrap();
            let at = at.index(program.duration() as usize + 1) as u64;
            let mut played = Cursor::new();
            for _ in 0..at {
                played.next(&program);
            }
            let mut sought = Cursor::new();
            sought.seek(&program, at);
            prop_assert_eq!(sought.elapsed(), played.elapsed());
            prop_assert_eq!(sought.is_done(&program), played.is_done(&program));
            while !played.is_done(&program) {
                prop_assert_eq!(sought.next(&program), played.next(&program));
            }
            prop_assert_eq!(played.elapsed(), program.duration());
            prop_assert_eq!(played.remaining(&program), 0);
        }
    }

    /// The documented minimum is 64 segments; 128 entries fit, repeats included.
    #[test]
    fn a_program_holds_its_capacity_and_refuses_more() {
        let mut program = Program::new();
        let mut builder = builder(&mut program);
        for i in 0..CAPACITY {
            builder.segment(segment(i as u32, 1, 1)).unwrap();
        }
        let error = builder.segment(segment(1, 1, 1)).unwrap_err();
        assert_eq!(error.key, "program");
        builder.finish().unwrap();
        assert_eq!(program.duration(), 2 * CAPACITY as u64);
    }
}
