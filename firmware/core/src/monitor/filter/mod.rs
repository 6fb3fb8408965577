//! Debounce and glitch rejection of one index input: from changes of the line's level to index pulses.
//!
//! Terms: a *stretch* is a time over which the line keeps its level. A stretch of at least *width* counts; a shorter one, high or low, is a
//! *glitch*. A *pulse* begins with a rise after a low stretch that counts, and ends at the next such low stretch. It is *confirmed* as soon
//! as a high stretch in it has lasted for the width. Dropouts after that change nothing.
//!
//! The time of a pulse is that of its first edge. So if a sensor bounces at the edge of its flag, the time is that of the flag, not the end
//! of the bouncing. But noise before a pulse looks the same as bouncing. So a rise more than [`BRIDGE_WIDTHS`] widths after the first edge
//! counts as a new first edge. This bridges a dropout at any place, and limits the time from a pulse's edge to the stretch that confirms it
//! to as many widths, whatever the noise.
//!
//! A pulse that begins too shortly before the end of a tick is confirmed in the next tick, and has a negative cycle there. The time from
//! the first edge to the confirmation is at most three widths. As a width is at most a quarter of a tick ([`MAX_TICK_SHARE`]), that edge lies
//! in the tick before.
//!
//! The filter does not decide whether the crank can have made a pulse at that time.

use super::pulses::{IndexPulse, IndexPulses};
use crate::settings::MAX_TICK_SHARE;

use crate::units::MAX_AXES;

/// Largest time from a pulse's first edge to the confirmed stretch, in widths.
pub const BRIDGE_WIDTHS: u32 = 2;

/// Earlier times are replaced by this one. It lies further back than any width, and differences of two times still fit 32 bits.
const LONG_AGO: i32 = -(1 << 29);

/// Filter of one line, or of several lines with the same width, each a bit of a word. A change and a tick take a constant number of
/// operations for each line that changed or is not quiet.
#[derive(Clone, Copy, Debug)]
pub struct IndexFilter<const LINES: usize> {
    /// Cycles that a stretch must last to count.
    width: i32,
    /// Set of all lines.
    all: u32,
    /// Levels of the lines.
    levels: u32,
    /// Levels of the last stretches that counted.
    steady: u32,
    /// Lines whose pulse was confirmed in the present tick.
    confirmed: u32,
    /// Lines that are not quiet.
    pending: u32,
    lines: [Line; LINES],
}

/// Times of one line, in cycles from the beginning of the present tick.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Beginning of the present stretch.
    since: i32,
    /// First edge of a possible pulse.
    first: i32,
    /// First edge of the pulse that was confirmed.
    pulse: i32,
}

impl Line {
    const NEW: Self = Self {
        since: LONG_AGO,
        first: LONG_AGO,
        pulse: LONG_AGO,
    };
}

impl<const LINES: usize> IndexFilter<LINES> {
    /// Creates a filter of width `width` cycles, on the first `lines` lines, which have been at `levels`, a bit each, for long: a crank
    /// that stands before its sensor at power-up makes no pulse.
    #[cold]
    pub fn new(width: u32, lines: usize, levels: u32) -> Self {
        const { assert!(LINES <= MAX_AXES, "`take_lowest` has a table for all axes") };
        let all = (1 << lines.min(LINES)) - 1;
        Self {
            width: at_most_long(width),
            all,
            levels: levels & all,
            steady: levels & all,
            confirmed: 0,
            pending: all,
            lines: [Line::NEW; LINES],
        }
    }

    /// Records that the lines have been at `levels`, a bit each, since `cycle` of the present tick: negative for the time before it, and at
    /// most about 4 s. Changes must be in the order of their times. One that is out of order gets the time of the change before it, and a
    /// level that a line has already is no change.
    #[inline(always)]
    pub fn change(&mut self, cycle: i32, levels: u32) {
        debug_assert!(cycle <= -LONG_AGO, "differences of times fit 32 bits");
        let levels = levels & self.all;
        let mut changed = self.levels ^ levels;
        self.levels = levels;
        self.pending |= changed;
        while let Some((number, bit)) = take_lowest(&mut changed) {
            let Some(line) = self.lines.get_mut(number) else {
                break;
            };
            let since = line.since;
            let cycle = cycle.max(since);
            line.since = cycle;
            let counts = cycle - since >= self.width;
            if levels & bit != 0 {
                if counts {
                    self.steady &= !bit;
                    line.first = cycle;
                } else if cycle - line.first > self.width * BRIDGE_WIDTHS as i32 {
                    line.first = cycle;
                }
            } else if counts && self.steady & bit == 0 {
                self.confirm(number, bit);
            }
        }
    }

    /// True if a line is not quiet: a stretch or pulse has been pending within the last [`MAX_TICK_SHARE`] widths, or within the last tick if
    /// that is less. Then [`Self::end_tick`] must be called. Otherwise it need not be called until the next change. A change looks back
    /// over less time: `BRIDGE_WIDTHS` widths and one.
    #[inline(always)]
    pub const fn is_pending(&self) -> bool {
        self.pending != 0
    }

    /// Ends a tick of `cycles`, and sets the pulses that were confirmed in it. From then on, cycles count from the beginning of the next
    /// tick.
    ///
    /// If a line had several, only the first is set: no crank turns that fast.
    #[inline(never)] // It needs all registers.
    pub fn end_tick(&mut self, cycles: u32, pulses: &mut IndexPulses) {
        // Latest cycle at which the present stretch of a line that is quiet now may have begun.
        let remembered = self.width as u32 * MAX_TICK_SHARE;
        let quiet_since = -(cycles.min(remembered).min(i32::MAX as u32) as i32);
        let cycles = at_most_long(cycles);
        let mut lasting = self.levels ^ self.steady;
        while let Some((number, bit)) = take_lowest(&mut lasting) {
            if let Some(line) = self.lines.get(number)
                && cycles - line.since >= self.width
            {
                if self.levels & bit == 0 {
                    self.steady &= !bit;
                } else {
                    self.confirm(number, bit);
                }
            }
        }
        let confirmed = core::mem::take(&mut self.confirmed);
        let mut pending = self.pending;
        let mut quiet = 0;
        while let Some((number, bit)) = take_lowest(&mut pending) {
            let Some(line) = self.lines.get_mut(number) else {
                break;
            };
            if confirmed & bit != 0 {
                pulses.set(number, Some(IndexPulse { cycle: line.pulse }));
            }
            line.first = (line.first - cycles).max(LONG_AGO);
            line.since = (line.since - cycles).max(LONG_AGO);
            if line.since <= quiet_since {
                quiet |= bit;
            }
        }
        // The present stretch of a quiet line counts already: it is longer than a width, as a tick has at least four widths.
        self.pending &= !quiet;
    }

    /// Confirms a pulse by a high stretch of a line: the present one or the one that just ended. It is the first that has lasted for the
    /// width.
    #[inline(always)]
    fn confirm(&mut self, number: usize, bit: u32) {
        self.steady |= bit;
        if self.confirmed & bit == 0
            && let Some(line) = self.lines.get_mut(number)
        {
            self.confirmed |= bit;
            line.pulse = line.first;
        }
    }
}

/// Removes the lowest line from a set. Returns its number and its bit.
#[inline(always)]
fn take_lowest(lines: &mut u32) -> Option<(usize, u32)> {
    // The board has no instruction that counts zeros.
    static LOWEST: [u8; 1 << MAX_AXES] = {
        let mut lowest = [0; 1 << MAX_AXES];
        let mut lines = 1;
        while lines < lowest.len() {
            lowest[lines] = lines.trailing_zeros() as u8;
            lines += 1;
        }
        lowest
    };
    if *lines == 0 {
        return None;
    }
    let lowest = LOWEST.get(*lines as usize).copied()?;
    let others = *lines & (*lines - 1);
    let bit = *lines ^ others;
    *lines = others;
    Some((lowest.into(), bit))
}

/// Cycles, limited to about 4 s, so that sums of times fit 32 bits.
const fn at_most_long(cycles: u32) -> i32 {
    if cycles < LONG_AGO.unsigned_abs() {
        cycles as i32
    } else {
        -LONG_AGO
    }
}

#[cfg(test)]
mod tests;
