//! Debounce and glitch rejection of one index input: from changes of the line's level to index pulses.
//!
//! Words: a *stretch* is a time over which the line keeps its level. A stretch of at least *width*
//! counts; a shorter one is a *glitch*, be it high or low. A *pulse* is what the line does from a rise
//! that follows a low stretch that counts, until the next such low stretch; it is *confirmed* as soon
//! as a high stretch in it has lasted for the width. Dropouts after that change nothing.
//!
//! The time of a pulse is that of its first edge, so that a sensor that bounces as its flag comes is
//! detected when it comes, and not when it has calmed down. But noise in front of a pulse looks the same
//! as bouncing. Hence a rise that comes more than [`BRIDGE_WIDTHS`] widths after the first is a first one
//! again. That bridges a dropout wherever it lies, and a pulse's time is never further from the stretch
//! that confirms it than that, whatever noise there is.
//!
//! A pulse that began too shortly before the end of a tick is confirmed in the next, and then has a
//! negative cycle there. From the first edge to the confirmation it is at most three widths, so that
//! with a width of at most a quarter of a tick ([`MOST_OF_TICK`]) that edge lies in the tick before.
//!
//! The filter does not decide whether the crank can have made a pulse at that time.

use super::tick_phase::IndexPulse;

/// How many widths before the confirmed stretch a pulse's first edge may lie.
pub const BRIDGE_WIDTHS: u32 = 2;

/// The greatest width is this part of a tick: one in four.
pub const MOST_OF_TICK: u32 = 4;

/// Earlier times are replaced by this one. It is longer ago than every width, and differences of two times still fit 32 bits.
const LONG_AGO: i32 = -(1 << 29);

/// No pulse was confirmed. It lies before every time.
const NO_PULSE: i32 = i32::MIN;

/// Filter of one line. A change and a tick cost a constant number of operations.
#[derive(Clone, Copy, Debug)]
pub struct IndexFilter {
    /// Cycles that a stretch must last to count.
    width: i32,
    /// Cycles that are bridged: [`BRIDGE_WIDTHS`] widths.
    bridged: i32,
    /// Cycles after which nothing of a change matters: [`MOST_OF_TICK`] widths.
    remembered: i32,
    /// The line's level, and since when: cycles from the beginning of the present tick.
    level: bool,
    since: i32,
    /// The level of the last stretch that counted.
    steady: bool,
    /// First edge of what may become a pulse.
    first: i32,
    /// First edge of the pulse that was confirmed in the present tick, or [`NO_PULSE`].
    pulse: i32,
    glitches: u32,
}

impl IndexFilter {
    /// For stretches of at least `width` cycles, on a line that has been at `level` for long: a crank
    /// that stands before its sensor at power-up makes no pulse.
    #[cold]
    pub fn new(width: u32, level: bool) -> Self {
        let width = at_most_long(width);
        Self {
            width,
            bridged: width.saturating_mul(BRIDGE_WIDTHS as i32),
            remembered: width.saturating_mul(MOST_OF_TICK as i32),
            level,
            since: LONG_AGO,
            steady: level,
            first: LONG_AGO,
            pulse: NO_PULSE,
            glitches: 0,
        }
    }

    /// Takes note that the line has been at `level` from `cycle` of the present tick on, negative for
    /// the time before it. Changes come in the order of their times; one that is reported too late counts
    /// from the change before it on, and a level that the line has already is no change.
    #[inline(never)] // It needs all registers.
    pub fn change(&mut self, cycle: i32, level: bool) {
        if level == self.level {
            return;
        }
        let cycle = cycle.min(-LONG_AGO).max(self.since);
        if cycle - self.since >= self.width {
            if self.level != self.steady {
                self.confirm();
            }
            if level {
                self.first = cycle;
            }
        } else {
            self.glitches = self.glitches.saturating_add(1);
            if level && cycle - self.first > self.bridged {
                self.first = cycle;
            }
        }
        self.level = level;
        self.since = cycle;
    }

    /// Ends a tick of `cycles`; the pulse that was confirmed in it, if one was. Cycles count from the
    /// next tick's beginning then.
    ///
    /// If there were several, the first is returned, and the others count as glitches: no crank turns that fast.
    #[inline(never)] // as `change`
    pub fn end_tick(&mut self, cycles: u32) -> Option<IndexPulse> {
        let cycles = at_most_long(cycles);
        if self.level != self.steady && cycles - self.since >= self.width {
            self.confirm();
        }
        self.since = (self.since - cycles).max(LONG_AGO);
        self.first = (self.first - cycles).max(LONG_AGO);
        let cycle = core::mem::replace(&mut self.pulse, NO_PULSE);
        (cycle != NO_PULSE).then_some(IndexPulse { cycle })
    }

    /// True if nothing is under way, and has been for [`MOST_OF_TICK`] widths, or for a tick of `cycles` if that is less. Then
    /// [`Self::end_tick`] has nothing to report, and need not be called until the next change: that is more than all that a
    /// change looks back for, [`BRIDGE_WIDTHS`] widths and one.
    #[inline(always)]
    pub fn is_quiet(&self, cycles: u32) -> bool {
        // A pulse that was not taken yet ended in this tick.
        self.level == self.steady && self.since <= -(cycles.min(self.remembered as u32) as i32)
    }

    /// Stretches that were too short to count, and pulses too many, since the start; stays at its
    /// greatest.
    pub const fn glitches(&self) -> u32 {
        self.glitches
    }

    /// Takes in the present stretch, which has lasted for the width and is the first to do so at its level.
    #[inline(always)]
    const fn confirm(&mut self) {
        self.steady = self.level;
        if self.level {
            if self.pulse == NO_PULSE {
                self.pulse = self.first;
            } else {
                self.glitches = self.glitches.saturating_add(1);
            }
        }
    }
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
