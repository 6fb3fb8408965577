//! The input of a drive that takes pulses: it counts rising edges of STEP, up or down as DIR has it.

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

/// Result of counting the edges of one plan, for the next axes: drives whose lines had the same levels count the same of it.
#[derive(Clone, Copy, Debug)]
pub struct Tally {
    from: Levels,
    to: Levels,
    steps: i64,
}

impl PulseCounter {
    /// At power-up: STEP low, DIR forward, nothing counted.
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

    /// Counts the rising edges of a tick, with the sign of DIR, which only pauses change. Returns the steps of the tick.
    ///
    /// `tally` is the result for another axis that plays the same plan, or none.
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

    /// Cycle of the rising edge in the tick counted last after which `beyond` more came.
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
        // A slip, not an edge, took the crank past its index: it passed at some time in the tick.
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
