//! The input of a drive that takes pulses. It counts rising edges of STEP, up or down depending on DIR.

use cophase_core::pulse::Runs;

/// Levels of STEP and DIR, and the count.
#[derive(Clone, Debug)]
pub struct PulseCounter {
    levels: Levels,
    counted: i64,
}

/// Levels of the lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Levels {
    step_high: bool,
    /// Level of DIR, in the axis's own sense.
    forward: bool,
}

/// Result of counting the edges of one plan, which other axes can reuse: drives whose lines had the same levels count the
/// same.
#[derive(Clone, Copy, Debug)]
pub struct Tally {
    from: Levels,
    to: Levels,
    steps: i64,
}

impl PulseCounter {
    /// Creates a counter at power-up: STEP low, DIR forward, count 0.
    pub const fn new() -> Self {
        Self {
            levels: Levels {
                step_high: false,
                forward: true,
            },
            counted: 0,
        }
    }

    /// Edges counted since power-up, in the axis's own sense.
    pub const fn counted(&self) -> i64 {
        self.counted
    }

    /// Counts the rising edges of a tick, with the sign of DIR, which changes only in pauses. Returns the steps of the tick.
    ///
    /// `tally` is the result of another axis that plays the same plan, or none.
    #[inline]
    pub fn count(&mut self, runs: &Runs, tally: &mut Option<Tally>) -> i64 {
        let tally = match tally {
            Some(tally) if tally.from == self.levels => tally,
            _ => tally.insert(Tally::new(self.levels, runs)),
        };
        self.levels = tally.to;
        self.counted += tally.steps;
        tally.steps
    }

    /// Returns the cycle of the rising edge that was followed by `beyond` more in the tick counted last.
    pub fn cycle_before(&self, runs: &Runs, beyond: i64) -> u32 {
        let mut high = self.levels.step_high;
        let mut end: u32 = runs.iter().map(|run| run.cycles()).sum();
        let mut left = beyond;
        for run in runs.iter().rev() {
            for _ in 0..run.edges() {
                if high {
                    if left == 0 {
                        return end;
                    }
                    left -= 1;
                }
                high = !high;
                end -= run.period();
            }
            if run.is_pause() {
                end -= run.period();
            }
        }
        // A slip, not an edge, moved the crank over its index. The time within the tick is then arbitrary.
        end
    }
}

impl Tally {
    fn new(from: Levels, runs: &Runs) -> Self {
        let (mut to, mut steps) = (from, 0);
        for run in runs {
            if run.is_pause() {
                to.forward = run.forward();
            }
            let rises = i64::from(run.edges() + u32::from(!to.step_high)) / 2;
            to.step_high ^= run.edges() % 2 == 1;
            steps += if to.forward { rises } else { -rises };
        }
        Self { from, to, steps }
    }
}
